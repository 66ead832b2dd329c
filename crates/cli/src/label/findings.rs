//! What a run found wrong, and what that makes of its outcome.

use occlabel_core::Fault;

use crate::console::Console;
use crate::exit::Outcome;

/// Everything odd about the input, with its scene. Told when it is found, kept for the report.
#[derive(Clone, Debug, Default)]
pub(crate) struct Findings {
    /// Odd, but nothing is lost.
    pub(crate) warnings: Vec<(String, Fault)>,
    /// Skipped or degraded: each makes the exit code 3.
    pub(crate) losses: Vec<(String, Fault)>,
}

impl Findings {
    /// Something odd.
    pub(crate) fn warn(&mut self, console: &Console, scene: &str, fault: Fault) {
        console.warning(scene, &fault);
        self.warnings.push((scene.to_owned(), fault));
    }

    /// Something skipped or degraded.
    pub(crate) fn lose(&mut self, console: &Console, scene: &str, fault: Fault) {
        console.warning(scene, &fault);
        self.losses.push((scene.to_owned(), fault));
    }

    pub(crate) fn outcome(&self) -> Outcome {
        if self.losses.is_empty() { Outcome::Complete } else { Outcome::Degraded }
    }
}
