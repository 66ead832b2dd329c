//! SIGINT, SIGTERM and SIGHUP: finish the current files, then stop. A second one ends at once.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use signal_hook::flag::{register, register_conditional_shutdown};

#[cfg(unix)]
use signal_hook::consts::SIGHUP;
use signal_hook::consts::{SIGINT, SIGTERM};

const SIGNALS: &[i32] = &[
    SIGINT,
    SIGTERM,
    #[cfg(unix)]
    SIGHUP,
];

/// The exit code of who was told to stop.
const INTERRUPTED: i32 = 130;

/// A flag that a signal raises. Once dropped, the next signal ends the process.
#[derive(Debug)]
pub(crate) struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Listens for signals from now on. Where that is impossible, they end the process; those that
    /// whoever started it wants ignored, as `nohup` does, stay ignored.
    pub(crate) fn listen() -> Self {
        static RAISED: OnceLock<Arc<AtomicBool>> = OnceLock::new();
        let raised = RAISED.get_or_init(|| {
            let (raised, ignored) = (Arc::default(), ignored_signals());
            let heard = SIGNALS.iter().filter(|signal| (ignored >> (*signal - 1)) & 1 == 0);
            heard.for_each(|signal| catch(*signal, &raised));
            raised
        });
        raised.store(false, Ordering::SeqCst);
        Self(raised.clone())
    }

    pub(crate) fn is_raised(&self) -> bool {
        self.0.load(Ordering::SeqCst)
    }
}

impl Drop for Interrupt {
    fn drop(&mut self) {
        self.0.store(true, Ordering::SeqCst);
    }
}

/// In this order: the first signal finds the flag down, and raises it.
fn catch(signal: i32, raised: &Arc<AtomicBool>) {
    let _ = register_conditional_shutdown(signal, INTERRUPTED, raised.clone())
        .and_then(|_| register(signal, raised.clone()));
}

/// A bit for each signal, from 1 on, where the system tells it.
fn ignored_signals() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}
