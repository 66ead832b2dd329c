//! What was counted before, and whether what is counted now may be.

use std::collections::BTreeMap;
use std::fmt;
use std::process::Command;

use serde::{Deserialize, Serialize};

/// Where the counts stand that the guard holds to.
const EXPECTED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/expected.json");
/// A count may differ by so many hundredths.
const SLACK_PERCENT: u64 = 2;

/// Instructions a stage, and with what they were counted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Counts {
    /// The first line of `rustc --version`.
    compiler: String,
    /// The processor's architecture, and `avx2` if it has that.
    processor: String,
    /// By stage.
    instructions: BTreeMap<String, u64>,
}

/// What became of a stage.
pub(crate) struct Verdict {
    stage: String,
    expected: Option<u64>,
    counted: u64,
}

impl Counts {
    /// What was counted with this compiler on this processor.
    ///
    /// # Errors
    /// If the compiler's version is unknown.
    pub(crate) fn here(instructions: BTreeMap<String, u64>) -> Result<Self, String> {
        Ok(Self { compiler: compiler()?, processor: processor(), instructions })
    }

    /// # Errors
    /// If the file is absent or broken.
    pub(crate) fn read() -> Result<Self, String> {
        let text = std::fs::read_to_string(EXPECTED).map_err(|e| format!("{EXPECTED}: {e}"))?;
        serde_json::from_str(&text).map_err(|error| format!("{EXPECTED}: {error}"))
    }

    /// # Errors
    /// If the file cannot be written.
    pub(crate) fn write(&self) -> Result<(), String> {
        let text = serde_json::to_string_pretty(self).map_err(|error| error.to_string())?;
        std::fs::write(EXPECTED, text + "\n").map_err(|e| format!("{EXPECTED}: {e}"))
    }

    /// # Errors
    /// If counts made here are not to be compared with these.
    pub(crate) fn fits_here(&self) -> Result<(), String> {
        let here = Self::here(BTreeMap::new())?;
        if (&here.compiler, &here.processor) == (&self.compiler, &self.processor) {
            return Ok(());
        }
        let Self { compiler, processor, .. } = self;
        Err(format!(
            "expected.json is of {compiler} on {processor}, here is {} on {}; \
             `benches/guard/run --pin` counts anew",
            here.compiler, here.processor
        ))
    }

    /// One verdict a counted stage.
    pub(crate) fn judge(&self, counted: &Self) -> Vec<Verdict> {
        let verdict = |(stage, &counted): (&String, &u64)| Verdict {
            stage: stage.clone(),
            expected: self.instructions.get(stage).copied(),
            counted,
        };
        counted.instructions.iter().map(verdict).collect()
    }
}

impl Verdict {
    /// How much more than expected, as a share; `None` if nothing was expected.
    fn excess(&self) -> Option<f64> {
        self.expected.map(|expected| self.counted as f64 / expected as f64 - 1.0)
    }

    /// Whether the stage costs more than it may, or nobody said what it may.
    pub(crate) fn is_too_much(&self) -> bool {
        let most = |expected: u64| expected * (100 + SLACK_PERCENT);
        self.expected.is_none_or(|expected| self.counted * 100 > most(expected))
    }

    /// Whether it costs so much less that a stage could lose again what was won.
    fn is_better(&self) -> bool {
        let least = |expected: u64| expected * (100 - SLACK_PERCENT);
        self.expected.is_some_and(|expected| self.counted * 100 < least(expected))
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { stage, counted, .. } = self;
        let Some(excess) = self.excess() else {
            return write!(f, "{stage:<22} {counted:>13}  FAILED: not in expected.json; --pin");
        };
        let word = match self {
            _ if self.is_too_much() => "  FAILED: more than 2 % above",
            _ if self.is_better() => "  better: pin it with benches/guard/run --pin",
            _ => "",
        };
        write!(f, "{stage:<22} {counted:>13} instructions {:>+7.2} %{word}", 100.0 * excess)
    }
}

fn compiler() -> Result<String, String> {
    let ran = Command::new("rustc").arg("--version").output().map_err(|e| format!("rustc: {e}"))?;
    let text = String::from_utf8_lossy(&ran.stdout);
    text.lines().next().map(str::to_owned).ok_or_else(|| "rustc tells no version".into())
}

fn processor() -> String {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        return "x86_64 with avx2".into();
    }
    std::env::consts::ARCH.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(instructions: &[(&str, u64)]) -> Counts {
        let instructions = instructions.iter().map(|&(stage, n)| (stage.into(), n)).collect();
        Counts { compiler: "rustc".into(), processor: "x86_64".into(), instructions }
    }

    #[test]
    fn two_percent_more_pass_and_three_fail() {
        let expected = counts(&[("rays", 1000), ("split", 1000), ("vote", 1000)]);
        let verdicts = expected.judge(&counts(&[("rays", 1020), ("split", 1030), ("vote", 900)]));
        let fails: Vec<bool> = verdicts.iter().map(Verdict::is_too_much).collect();
        assert_eq!(fails, [false, true, false]);
        assert!(verdicts[2].to_string().contains("better"));
    }

    #[test]
    fn a_stage_that_nobody_pinned_fails() {
        let verdicts = counts(&[]).judge(&counts(&[("rays", 1)]));
        assert!(verdicts[0].is_too_much());
    }

    #[test]
    fn counts_of_another_compiler_are_not_compared() {
        let reason = counts(&[]).fits_here().unwrap_err();
        assert!(reason.contains("--pin"), "{reason}");
    }
}
