//! What work costs.

use std::time::Instant;

use rustix::time::{ClockId, clock_gettime};

/// What some work took.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cost {
    /// CPU time of all threads of this process, seconds.
    pub(crate) cpu_s: f64,
    /// Seconds on the wall.
    pub(crate) wall_s: f64,
}

impl Cost {
    /// What is left of it without a part.
    pub(crate) fn without(self, part: Self) -> Self {
        Self { cpu_s: self.cpu_s - part.cpu_s, wall_s: self.wall_s - part.wall_s }
    }
}

/// Does the work; what it cost. Its result is dropped off the clock.
pub(crate) fn cost_of<T>(work: impl FnOnce() -> T) -> Cost {
    let (wall, begun_s) = (Instant::now(), cpu_s());
    let result = std::hint::black_box(work());
    let cost = Cost { cpu_s: cpu_s() - begun_s, wall_s: wall.elapsed().as_secs_f64() };
    drop(result);
    cost
}

/// CPU time of all threads of this process so far, seconds.
pub(crate) fn cpu_s() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 / 1e9
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sleep_costs_no_cpu() {
        let cost = cost_of(|| std::thread::sleep(std::time::Duration::from_millis(30)));
        assert!(cost.wall_s >= 0.03);
        assert!(cost.cpu_s < 0.02, "{} s", cost.cpu_s);
    }
}
