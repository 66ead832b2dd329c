//! How bad a finding is.

use occlabel_core::Fault;

/// What a finding means for labels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Nothing is lost.
    Remark,
    /// The log can be labelled, but the labels are worse for it.
    Warning,
    /// The log cannot be labelled, unless told to leave something out; or its labels would be wrong
    /// throughout.
    Error,
}

/// Something wrong with a log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The scene that it concerns; none: the log as a whole.
    pub scene: Option<String>,
    /// How bad it is.
    pub severity: Severity,
    /// What it is.
    pub fault: Fault,
}

/// Rules of warnings by which nothing is lost: what is absent without being missed, and what a log
/// holds twice.
const REMARKS: [&str; 10] = [
    "boxes-absent",
    "boxes-at-one-time",
    "camera-absent",
    "component-absent",
    "image-absent",
    "key-sweep-repeated",
    "no-boxes",
    "no-cameras",
    "no-labels",
    "sweep-copied",
];

impl Severity {
    /// Of something that a reader takes, by its rule.
    pub fn of_warning(rule: &str) -> Self {
        if REMARKS.contains(&rule) { Self::Remark } else { Self::Warning }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Remark => "remark",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}
