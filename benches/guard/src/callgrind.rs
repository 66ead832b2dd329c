//! How many instructions a stage takes.

use std::path::PathBuf;
use std::process::Command;

use crate::stages::Stage;

/// Instructions between entering and leaving the watched function, of the thread that enters it.
///
/// # Errors
/// If valgrind is absent, or did not count.
pub(crate) fn instructions(stage: &Stage) -> Result<u64, String> {
    let program = std::env::current_exe().map_err(|error| error.to_string())?;
    let counts = counts_file(stage.name);
    let ran = Command::new("valgrind")
        .arg("--tool=callgrind")
        .arg(format!("--toggle-collect=occlabel_guard::watched::{}*", stage.watched))
        .arg(format!("--callgrind-out-file={}", counts.display()))
        .arg(program)
        .args(["stage", stage.name])
        // One memcpy on every processor: glibc picks by what it finds, and these differ.
        .env("GLIBC_TUNABLES", "glibc.cpu.hwcaps=-ERMS,-FSRM,-AVX512F,-AVX512VL")
        .output()
        .map_err(|error| format!("valgrind did not start: {error}"))?;
    if !ran.status.success() {
        return Err(format!("valgrind: {}", String::from_utf8_lossy(&ran.stderr)));
    }
    let text = std::fs::read_to_string(&counts).map_err(|error| error.to_string())?;
    let _ = std::fs::remove_file(counts);
    total(&text)
        .filter(|&total| total > 0)
        .ok_or_else(|| format!("{}: nothing was counted", stage.name))
}

fn counts_file(stage: &str) -> PathBuf {
    std::env::temp_dir().join(format!("occlabel-guard-{}-{stage}.out", std::process::id()))
}

/// The sum of a callgrind file: its line `summary:` or `totals:`.
fn total(text: &str) -> Option<u64> {
    let sum = |line: &str| {
        let number = line.strip_prefix("totals:").or_else(|| line.strip_prefix("summary:"))?;
        number.trim().parse().ok()
    };
    text.lines().filter_map(sum).max()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sum_stands_in_the_summary() {
        assert_eq!(total("events: Ir\nsummary: 12345\nfn=(1)\n"), Some(12345));
        assert_eq!(total("events: Ir\n"), None);
    }
}
