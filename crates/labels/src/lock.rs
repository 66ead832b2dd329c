//! One writer at a time: a scene's `.lock` and a run's hold the writer's process.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use occlabel_core::Fault;
use occlabel_disk as disk;

use crate::atomic::{create_dir, create_exclusive, remove_file, remove_leftovers, replace};
use crate::files::read_fault;
use crate::{LabelTree, TreePath};

/// How often a lock that vanishes under our eyes is tried again.
const TRIES: usize = 3;

/// The right to write a scene's folder, or a run's records, until dropped.
#[derive(Debug)]
pub struct WriterLock {
    path: PathBuf,
    owner: Owner,
}

impl WriterLock {
    /// Locks a scene, whose folder is created. A lock whose process is gone is taken over.
    ///
    /// # Errors
    /// If another process holds it: the fault names the process. If it cannot be written.
    pub fn of_scene(tree: &LabelTree, scene: &str) -> Result<Self, Fault> {
        let path = tree.place(&TreePath::lock(scene)?);
        create_dir(path.parent().unwrap_or(tree.root()))?;
        Self::acquire(path)
    }

    /// Locks by a file in a folder that is there.
    pub(crate) fn acquire(path: PathBuf) -> Result<Self, Fault> {
        let owner = Owner::this_process();
        for _ in 0..TRIES {
            if create_exclusive(&path, owner.text().as_bytes())? || take_over(&path, &owner)? {
                let lock = Self { path, owner };
                remove_leftovers(&lock.path).map_err(|error| read_fault(&lock.path, &error))?;
                return Ok(lock);
            }
        }
        let place = path.display().to_string();
        Err(Fault::new("lock", place, "a lock that stays", "one that comes and goes"))
    }
}

impl Drop for WriterLock {
    fn drop(&mut self) {
        if disk::read_to_string(&self.path).is_ok_and(|text| text == self.owner.text()) {
            let _ = remove_file(&self.path);
        }
    }
}

/// A process by its id and, where the system tells it, the moment it began: ids are used again,
/// and in containers they are the same each time.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Owner {
    process: u32,
    began: Option<u64>,
}

impl Owner {
    fn this_process() -> Self {
        let process = std::process::id();
        Self { process, began: began(process) }
    }

    fn text(&self) -> String {
        match self.began {
            Some(began) => format!("{} {began}\n", self.process),
            None => format!("{}\n", self.process),
        }
    }

    fn parse(text: &str) -> Option<Self> {
        let mut words = text.split_whitespace();
        let process = words.next()?.parse().ok()?;
        Some(Self { process, began: words.next().and_then(|word| word.parse().ok()) })
    }

    /// Whether the process still runs. Where that cannot be told, it does.
    fn runs(&self) -> bool {
        if !Path::new("/proc/self").exists() {
            return true;
        }
        match began(self.process) {
            None => false,
            now => self.began.is_none() || self.began == now,
        }
    }
}

/// When a process that is not dead began, in clock ticks since the system did: field 22 of
/// `/proc/<pid>/stat`, see proc_pid_stat(5). Field 2 is the program's name in brackets, which may hold
/// anything; field 3 tells of a dead one that nobody has waited for.
fn began(process: u32) -> Option<u64> {
    let stat = fs::read(format!("/proc/{process}/stat")).ok()?;
    let stat = String::from_utf8_lossy(&stat);
    let (_, after_name) = stat.rsplit_once(')')?;
    let mut fields = after_name.split_whitespace();
    let is_dead = matches!(fields.next()?, "Z" | "X");
    fields.nth(18)?.parse().ok().filter(|_| !is_dead)
}

/// Puts us in place of a lock whose process is gone. `false` if it is another's lock by now, or none.
///
/// The lock's file is itself locked meanwhile, so that one at a time replaces it; who comes next finds
/// another file in its place.
fn take_over(path: &Path, us: &Owner) -> Result<bool, Fault> {
    let opened = disk::open_to_lock(path);
    let mut file = match opened {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(false),
        opened => opened.map_err(|error| read_fault(path, &error))?,
    };
    let unreadable = |error: io::Error| read_fault(path, &error);
    file.lock().map_err(unreadable)?;
    let text = io::read_to_string(&mut file).map_err(unreadable)?;
    refuse_if_held(path, &text)?;
    match disk::read_to_string(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(error) => Err(unreadable(error)),
        Ok(now) if now != text => Ok(false),
        Ok(_) => replace(path, &file, us.text().as_bytes()),
    }
}

fn refuse_if_held(path: &Path, text: &str) -> Result<(), Fault> {
    let place = path.display().to_string();
    match Owner::parse(text) {
        Some(owner) if !owner.runs() => Ok(()),
        Some(owner) => {
            let found = format!("process {} at work there", owner.process);
            Err(Fault::new("lock", place, "no other writer", found)
                .hint("wait for it, or end it; the lock goes with the process"))
        }
        None => Err(Fault::new("lock", place, "the id of a process", format!("`{text}`"))
            .hint("remove this file if no other occlabel is at work")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tree() -> (tempfile::TempDir, LabelTree, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let tree = LabelTree::new(folder.path());
        let path = folder.path().join("gts/s/.lock");
        (folder, tree, path)
    }

    #[test]
    fn fault_39_a_second_writer_is_refused_by_the_first_ones_process() {
        let (_folder, tree, path) = tree();
        let lock = WriterLock::of_scene(&tree, "s").unwrap();
        let fault = WriterLock::of_scene(&tree, "s").unwrap_err();
        assert!(fault.found.contains(&format!("process {}", std::process::id())), "{fault}");
        let _other_scene = WriterLock::of_scene(&tree, "t").unwrap();
        drop(lock);
        assert!(!path.exists());
        drop(WriterLock::of_scene(&tree, "s").unwrap());
    }

    #[test]
    fn fault_39_a_bare_process_id_that_runs_holds_the_lock() {
        let (_folder, tree, path) = tree();
        create_dir(path.parent().unwrap()).unwrap();
        fs::write(&path, std::process::id().to_string()).unwrap();
        assert_eq!(WriterLock::of_scene(&tree, "s").unwrap_err().rule, "lock");
    }

    /// Who started it may never ask how it ended.
    #[cfg(target_os = "linux")]
    #[test]
    fn fault_39_the_lock_of_a_dead_process_that_nobody_waited_for_is_taken_over() {
        let (_folder, tree, path) = tree();
        let mut dead = std::process::Command::new("true").spawn().unwrap();
        while began(dead.id()).is_some() {
            std::thread::yield_now();
        }
        create_dir(path.parent().unwrap()).unwrap();
        fs::write(&path, format!("{}\n", dead.id())).unwrap();
        assert!(WriterLock::of_scene(&tree, "s").is_ok());
        dead.wait().unwrap();
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn fault_39_the_lock_of_a_process_that_is_gone_is_taken_over() {
        let (_folder, tree, path) = tree();
        let mut gone = std::process::Command::new("true").spawn().unwrap();
        gone.wait().unwrap();
        let restarted = Owner { began: Some(1), ..Owner::this_process() };
        for stale in [format!("{}\n", gone.id()), restarted.text()] {
            create_dir(path.parent().unwrap()).unwrap();
            fs::write(&path, &stale).unwrap();
            let lock = WriterLock::of_scene(&tree, "s").unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), lock.owner.text());
            assert!(WriterLock::of_scene(&tree, "s").is_err());
        }
        assert!(!path.exists());
    }

    #[test]
    fn fault_39_of_many_who_find_a_stale_lock_one_gets_it() {
        let (_folder, tree, path) = tree();
        create_dir(path.parent().unwrap()).unwrap();
        fs::write(&path, format!("{}\n", u32::MAX)).unwrap();
        let locks: Vec<_> = std::thread::scope(|scope| {
            let threads: Vec<_> =
                (0..8).map(|_| scope.spawn(|| WriterLock::of_scene(&tree, "s"))).collect();
            threads.into_iter().filter_map(|thread| thread.join().unwrap().ok()).collect()
        });
        assert_eq!(locks.len(), 1);
    }

    #[test]
    fn a_lock_that_is_none_of_ours_is_left_alone() {
        let (_folder, tree, path) = tree();
        create_dir(path.parent().unwrap()).unwrap();
        fs::write(&path, "a note").unwrap();
        let fault = WriterLock::of_scene(&tree, "s").unwrap_err();
        assert!(fault.hint.is_some());
        assert_eq!(fs::read_to_string(&path).unwrap(), "a note");
    }
}
