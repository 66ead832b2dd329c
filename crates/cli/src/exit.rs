//! How a command ends.

use occlabel_core::Fault;

/// How a command that ran ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Outcome {
    /// All of it is done.
    Complete,
    /// It is done, but something was skipped or degraded; the report lists it.
    Degraded,
    /// It was interrupted; the same command goes on from there.
    Interrupted,
}

/// Why a command stopped.
#[derive(Debug)]
pub(crate) enum Stop {
    /// The input or the machine would not have it: exit 1.
    Failed(Vec<Fault>),
    /// The command line or the configuration is wrong: exit 2.
    Usage(Vec<Fault>),
}

impl Stop {
    /// A single fault of the command line or the configuration.
    pub(crate) fn usage(fault: Fault) -> Self {
        Self::Usage(vec![fault])
    }

    pub(crate) fn faults(&self) -> &[Fault] {
        match self {
            Self::Failed(faults) | Self::Usage(faults) => faults,
        }
    }

    pub(crate) fn code(&self) -> u8 {
        match self {
            Self::Failed(_) => 1,
            Self::Usage(_) => 2,
        }
    }
}

impl From<Fault> for Stop {
    fn from(fault: Fault) -> Self {
        Self::Failed(vec![fault])
    }
}

impl Outcome {
    pub(crate) fn code(self) -> u8 {
        match self {
            Self::Complete => 0,
            Self::Degraded => 3,
            Self::Interrupted => 130,
        }
    }

    /// As reports name it.
    pub(crate) fn name(self) -> &'static str {
        outcome_name(self.code())
    }
}

/// How a command with this exit code ended, in a word.
pub(crate) fn outcome_name(code: u8) -> &'static str {
    match code {
        0 => "complete",
        2 => "usage",
        3 => "degraded",
        130 => "interrupted",
        _ => "failed",
    }
}
