//! So many keyframes at a time, and no more.

use std::sync::atomic::{AtomicUsize, Ordering};

/// Does every item, `at_once` at a time, in any order, until one fails or `is_over` says so.
///
/// The workers are threads of their own: what runs parallel inside an item shares the thread pool.
///
/// # Errors
/// The error of the first item, in the order of items, among those that failed.
pub(crate) fn for_each<T: Sync, E: Send>(
    items: &[T],
    at_once: usize,
    is_over: impl Fn() -> bool + Sync,
    work: impl Fn(&T) -> Result<(), E> + Sync,
) -> Result<(), E> {
    let next = AtomicUsize::new(0);
    let worker = || loop {
        let at = next.fetch_add(1, Ordering::Relaxed);
        if at >= items.len() || is_over() {
            return None;
        }
        if let Err(error) = work(&items[at]) {
            next.store(items.len(), Ordering::Relaxed);
            return Some((at, error));
        }
    };
    let failures: Vec<(usize, E)> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..at_once.min(items.len())).map(|_| scope.spawn(worker)).collect();
        workers.into_iter().filter_map(|worker| worker.join().expect("a worker panicked")).collect()
    });
    match failures.into_iter().min_by_key(|(at, _)| *at) {
        Some((_, error)) => Err(error),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_item_is_done_once_and_no_more_than_so_many_at_a_time() {
        let (done, running, most) = (AtomicUsize::new(0), AtomicUsize::new(0), AtomicUsize::new(0));
        let items: Vec<usize> = (0..50).collect();
        let result: Result<(), ()> = for_each(
            &items,
            3,
            || false,
            |_| {
                most.fetch_max(running.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
                std::thread::sleep(std::time::Duration::from_millis(1));
                running.fetch_sub(1, Ordering::SeqCst);
                done.fetch_add(1, Ordering::SeqCst);
                Ok(())
            },
        );
        assert_eq!((result, done.into_inner()), (Ok(()), 50));
        assert!((2..=3).contains(&most.into_inner()));
    }

    #[test]
    fn an_error_stops_the_rest_and_the_first_is_told() {
        let items: Vec<usize> = (0..1000).collect();
        let done = AtomicUsize::new(0);
        let result = for_each(
            &items,
            2,
            || false,
            |&item| {
                done.fetch_add(1, Ordering::SeqCst);
                if item >= 10 { Err(item) } else { Ok(()) }
            },
        );
        assert_eq!(result, Err(10));
        assert!(done.into_inner() < 1000);
    }
}
