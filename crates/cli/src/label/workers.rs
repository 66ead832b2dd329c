//! So many keyframes at a time, and no more; writing one keeps no other waiting.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex};

/// Makes something of every item, `at_once` at a time, and writes it, in any order, until a writing
/// fails or `is_over` says so. What was made is written in any case.
///
/// `make` is for processors and `write` for disks: while one thing is written, the next is made. At
/// most twice `at_once` items are in hand. The workers are threads of their own: what runs parallel
/// inside an item shares the thread pool.
///
/// # Errors
/// The error of the first item, in the order of items, among those that failed.
pub(crate) fn for_each<T: Sync, M, E: Send>(
    items: &[T],
    at_once: usize,
    is_over: impl Fn() -> bool + Sync,
    make: impl Fn(&T) -> M + Sync,
    write: impl Fn(&T, M) -> Result<(), E> + Sync,
) -> Result<(), E> {
    let (next, turns) = (AtomicUsize::new(0), Turns::new(at_once));
    let take = || {
        let at = next.fetch_add(1, Ordering::Relaxed);
        let item = items.get(at).filter(|_| !is_over())?;
        Some((at, item, make(item)))
    };
    let worker = || {
        while let Some((at, item, made)) = turns.take_one(take) {
            if let Err(error) = write(item, made) {
                next.store(items.len(), Ordering::Relaxed);
                return Some((at, error));
            }
        }
        None
    };
    let failures: Vec<(usize, E)> = std::thread::scope(|scope| {
        let count = (2 * at_once).min(items.len());
        let workers: Vec<_> = (0..count).map(|_| scope.spawn(worker)).collect();
        workers.into_iter().filter_map(|worker| worker.join().expect("a worker panicked")).collect()
    });
    failures.into_iter().min_by_key(|(at, _)| *at).map_or(Ok(()), |(_, error)| Err(error))
}

/// So many may work; the others wait for their turn.
struct Turns {
    free: Mutex<usize>,
    freed: Condvar,
}

impl Turns {
    fn new(count: usize) -> Self {
        Self { free: Mutex::new(count), freed: Condvar::new() }
    }

    /// Waits for a turn, and works until it is done.
    fn take_one<R>(&self, work: impl FnOnce() -> R) -> R {
        let free = self.free.lock().expect("nothing panics under the lock");
        let mut free = self.freed.wait_while(free, |free| *free == 0).expect("the same");
        *free -= 1;
        drop(free);
        let _turn = Turn(self);
        work()
    }
}

/// Given back when it goes, by a panic too: nobody would wait for ever.
struct Turn<'a>(&'a Turns);

impl Drop for Turn<'_> {
    fn drop(&mut self) {
        *self.0.free.lock().expect("nothing panics under the lock") += 1;
        self.0.freed.notify_one();
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Barrier;
    use std::time::Duration;

    use super::*;

    /// How many are at it, and how many were at most.
    #[derive(Default)]
    struct Count {
        now: AtomicUsize,
        most: AtomicUsize,
    }

    impl Count {
        fn during<R>(&self, work: impl FnOnce() -> R) -> R {
            self.most.fetch_max(self.now.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
            std::thread::sleep(Duration::from_millis(1));
            let result = work();
            self.now.fetch_sub(1, Ordering::SeqCst);
            result
        }

        fn most(&self) -> usize {
            self.most.load(Ordering::SeqCst)
        }
    }

    #[test]
    fn every_item_is_made_and_written_once_and_no_more_than_so_many_at_a_time() {
        let (making, open) = (Count::default(), Count::default());
        let written = Mutex::new(Vec::new());
        let items: Vec<usize> = (0..50).collect();
        let make = |item: &usize| making.during(|| item * 10);
        let write = |item: &usize, made| -> Result<(), ()> {
            open.during(|| written.lock().unwrap().push((*item, made)));
            Ok(())
        };
        assert_eq!(for_each(&items, 3, || false, make, write), Ok(()));
        let mut written = written.into_inner().unwrap();
        written.sort_unstable();
        assert_eq!(written, items.iter().map(|item| (*item, item * 10)).collect::<Vec<_>>());
        assert!((2..=3).contains(&making.most()), "{} made at once", making.most());
        assert!((1..=6).contains(&open.most()), "{} written at once", open.most());
    }

    /// Without that, this test would not end: each writing waits for the making of the next item.
    #[test]
    fn while_one_item_is_written_the_next_is_made() {
        let meeting = Barrier::new(2);
        let make = |item: &usize| {
            if *item % 2 == 1 {
                meeting.wait();
            }
        };
        let write = |item: &usize, ()| -> Result<(), ()> {
            if item.is_multiple_of(2) {
                meeting.wait();
            }
            Ok(())
        };
        assert_eq!(for_each(&[0, 1, 2, 3, 4, 5], 1, || false, make, write), Ok(()));
    }

    #[test]
    fn an_error_stops_the_rest_and_the_first_is_told() {
        let items: Vec<usize> = (0..1000).collect();
        let made = AtomicUsize::new(0);
        let make = |_: &usize| made.fetch_add(1, Ordering::SeqCst);
        let write = |item: &usize, _| if *item >= 10 { Err(*item) } else { Ok(()) };
        assert_eq!(for_each(&items, 2, || false, make, write), Err(10));
        assert!(made.into_inner() < 1000);
    }

    #[test]
    fn fault_39_an_interrupt_begins_nothing_and_writes_what_was_made() {
        let (made, written) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let is_over = || made.load(Ordering::SeqCst) >= 7;
        let make = |_: &usize| made.fetch_add(1, Ordering::SeqCst);
        let write = |_: &usize, _| -> Result<(), ()> {
            written.fetch_add(1, Ordering::SeqCst);
            Ok(())
        };
        assert_eq!(for_each(&[0; 100], 2, is_over, make, write), Ok(()));
        let made = made.into_inner();
        assert!((7..=8).contains(&made), "{made}");
        assert_eq!(written.into_inner(), made);
    }
}
