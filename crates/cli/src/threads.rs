//! How many threads work.

/// Starts the thread pool of all stages; all cores unless told. A second command in one process
/// keeps the first one's.
pub(crate) fn start_threads(jobs: Option<u16>) -> usize {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = jobs.map_or(cores, usize::from);
    let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    threads
}
