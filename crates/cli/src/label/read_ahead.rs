//! The next scene's files, read while the current scene is worked on.

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use occlabel_disk as disk;

/// What is read ahead of a scene is at most this: it has to stay in memory until it is wanted.
const MAX_BYTES: u64 = 2 << 30;

/// Read at once.
const PIECE_BYTES: usize = 1 << 20;

/// Works on a scene's files, and has the system read the next scene's meanwhile: it keeps them where they
/// are quickly found again, and gives that room away if anyone needs it. Nothing is kept here. What is
/// wrong with a file will be told by who wants what is in it. From a store, some files of both are fetched
/// before they are asked for.
pub(crate) fn while_reading<'f, R>(
    root: &Path,
    files: &'f [(String, u64)],
    next: impl Iterator<Item = &'f (String, u64)> + Clone + Send,
    work: impl FnOnce() -> R,
) -> R {
    disk::expect(root, files.iter().chain(next.clone()));
    let is_over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| read(root, next, &is_over));
        let result = work();
        is_over.store(true, Ordering::Relaxed);
        result
    })
}

/// Reads the first of the files that fit, as long as it is not over; gives how many bytes there were.
fn read<'f>(
    root: &Path,
    files: impl Iterator<Item = &'f (String, u64)>,
    is_over: &AtomicBool,
) -> u64 {
    let (mut piece, mut planned, mut sum) = (vec![0; PIECE_BYTES], 0, 0);
    for (name, bytes) in files {
        planned += bytes;
        if planned > MAX_BYTES {
            break;
        }
        let path = root.join(name);
        // Opening a pipe would wait for who writes to it.
        let Some(mut file) = path.is_file().then(|| File::open(path).ok()).flatten() else {
            continue;
        };
        while !is_over.load(Ordering::Relaxed)
            && let Ok(count @ 1..) = file.read(&mut piece)
        {
            sum += count as u64;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files(root: &Path) -> [(String, u64); 3] {
        std::fs::write(root.join("a"), vec![1; 3 * PIECE_BYTES + 5]).unwrap();
        std::fs::write(root.join("b"), [1; 7]).unwrap();
        [("a".into(), 3 * PIECE_BYTES as u64 + 5), ("absent".into(), 9), ("b".into(), 7)]
    }

    #[test]
    fn all_files_are_read_and_absent_ones_passed_over() {
        let folder = tempfile::tempdir().unwrap();
        let files = files(folder.path());
        let sum = read(folder.path(), files.iter(), &AtomicBool::new(false));
        assert_eq!(sum, 3 * PIECE_BYTES as u64 + 12);
        assert_eq!(while_reading(folder.path(), &files[..1], files[1..].iter(), || 5), 5);
    }

    #[test]
    fn what_is_too_much_or_too_late_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let [_, _, small] = files(folder.path());
        let large = ("a".to_owned(), MAX_BYTES - 6);
        let run =
            |files: &[_], is_over| read(folder.path(), files.iter(), &AtomicBool::new(is_over));
        assert_eq!(run(&[small.clone(), large], false), 7);
        assert_eq!(run(&[small], true), 0);
    }
}
