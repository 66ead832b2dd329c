//! What the process takes of the machine.

use std::time::{Duration, Instant};

/// A look at the clocks and the memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Usage {
    pub(crate) at: Instant,
    /// Of the whole process, where the system tells it.
    pub(crate) cpu: Option<Duration>,
    /// The same.
    pub(crate) memory: Option<Memory>,
}

/// Sizes of the resident set, bytes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Memory {
    pub(crate) now: u64,
    /// The largest since the process began.
    pub(crate) highest: u64,
}

impl Usage {
    pub(crate) fn now() -> Self {
        Self { at: Instant::now(), cpu: cpu(), memory: Memory::now() }
    }
}

impl Memory {
    pub(crate) fn now() -> Option<Self> {
        let status = std::fs::read_to_string("/proc/self/status").ok()?;
        let bytes = |name: &str| {
            let line = status.lines().find_map(|line| line.strip_prefix(name))?;
            Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
        };
        Some(Self { now: bytes("VmRSS:")?, highest: bytes("VmHWM:")? })
    }

    /// The most that was resident between an earlier look and this one, as far as both can tell: exact
    /// if it was a record, else at least this.
    pub(crate) fn peak_since(&self, earlier: &Self) -> u64 {
        if self.highest > earlier.highest { self.highest } else { self.now.max(earlier.now) }
    }
}

#[cfg(unix)]
fn cpu() -> Option<Duration> {
    use rustix::time::{ClockId, clock_gettime};
    clock_gettime(ClockId::ProcessCPUTime).try_into().ok()
}

#[cfg(not(unix))]
fn cpu() -> Option<Duration> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_is_the_peak_and_without_one_the_larger_end() {
        let look = |now, highest| Memory { now, highest };
        assert_eq!(look(3, 9).peak_since(&look(2, 8)), 9);
        assert_eq!(look(3, 9).peak_since(&look(5, 9)), 5);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn cpu_time_grows_and_memory_is_told() {
        let before = Usage::now();
        let work: f64 = (0..2_000_000).map(|i| f64::from(std::hint::black_box(i)).sqrt()).sum();
        let after = Usage::now();
        assert!(work > 0.0 && after.cpu > before.cpu);
        let memory = after.memory.expect("Linux tells it");
        assert!(memory.highest >= memory.now && memory.now > 100_000, "{memory:?}");
    }
}
