//! What a check found, told.

use std::collections::BTreeMap;

use occlabel_core::{Fault, printable};
use occlabel_logs::{Finding, Severity};
use serde_json::{Value, json};

use crate::check::error;
use crate::check::scene::SceneFigures;
use crate::console::{Console, escape, fault_json};
use crate::exit::{Outcome, Stop};

/// Grows scene by scene.
#[derive(Default)]
pub(super) struct Report {
    findings: Vec<Finding>,
    scenes: BTreeMap<String, SceneFigures>,
}

impl Report {
    /// Adds an error of the log as a whole, unless a scene has it already.
    pub(super) fn add_error(&mut self, fault: Fault) {
        let same = |known: &Finding| {
            let key = |fault: &Fault| (fault.rule, fault.place.clone(), fault.record.clone());
            key(&known.fault) == key(&fault)
        };
        if !self.findings.iter().any(same) {
            self.findings.push(error(fault));
        }
    }

    /// Adds what was found in a scene, the worst first.
    pub(super) fn add_scene(&mut self, name: &str, found: Vec<Finding>, figures: SceneFigures) {
        let mut found = found;
        found.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
        self.findings.extend(found);
        self.scenes.insert(name.to_owned(), figures);
    }

    pub(super) fn has_errors(&self) -> bool {
        self.count(Severity::Error) > 0
    }

    /// 0: none or remarks; 3: warnings; 1: errors.
    pub(super) fn outcome(&self) -> Result<Outcome, Stop> {
        match self.findings.iter().map(|finding| finding.severity).max() {
            None | Some(Severity::Remark) => Ok(Outcome::Complete),
            Some(Severity::Warning) => Ok(Outcome::Degraded),
            // All of them are told already.
            Some(Severity::Error) => Err(Stop::Failed(Vec::new())),
        }
    }

    pub(super) fn print(&self, as_json: bool, console: &Console) {
        if as_json {
            return console.result(&self.json().to_string());
        }
        self.findings.iter().for_each(|finding| console.result(&line(finding)));
        for (name, figures) in &self.scenes {
            console.result(&format!("{}: {}", printable(name), figures.line()));
        }
        let [errors, warnings, remarks] = self.counts();
        console.result(&format!("errors: {errors}, warnings: {warnings}, remarks: {remarks}"));
    }

    fn json(&self) -> Value {
        let [errors, warnings, remarks] = self.counts();
        let scenes = self.scenes.iter().map(|(name, figures)| (printable(name), json!(figures)));
        json!({
            "version": 1,
            "errors": errors,
            "warnings": warnings,
            "remarks": remarks,
            "findings": self.findings.iter().map(finding_json).collect::<Vec<_>>(),
            "scenes": Value::Object(scenes.collect()),
        })
    }

    fn counts(&self) -> [usize; 3] {
        [Severity::Error, Severity::Warning, Severity::Remark].map(|severity| self.count(severity))
    }

    fn count(&self, severity: Severity) -> usize {
        self.findings.iter().filter(|finding| finding.severity == severity).count()
    }
}

/// `severity [rule] scene: fault`.
fn line(finding: &Finding) -> String {
    let scene = finding.scene.as_ref().map(|scene| format!("{}: ", printable(scene)));
    let (severity, rule) = (finding.severity.name(), finding.fault.rule);
    format!("{severity} [{rule}] {}{}", scene.unwrap_or_default(), finding.fault)
}

fn finding_json(finding: &Finding) -> Value {
    let mut fields = fault_json(&finding.fault);
    if let Some(place) = fields.as_object_mut().and_then(|fields| fields.remove("place")) {
        fields["file"] = place;
    }
    fields["severity"] = json!(finding.severity.name());
    fields["scene"] = json!(finding.scene);
    escape(&mut fields);
    fields
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(severities: &[Severity]) -> Report {
        let fault = Fault::new("a-rule", "a\u{1b}", "this", "that").record("r");
        let finding = |severity: &Severity| Finding {
            scene: Some("s".into()),
            severity: *severity,
            fault: fault.clone(),
        };
        let mut report = Report::default();
        report.add_scene("s", severities.iter().map(finding).collect(), SceneFigures::default());
        report
    }

    #[test]
    fn the_worst_finding_decides_the_outcome() {
        let outcome = |severities: &[Severity]| report(severities).outcome();
        assert!(matches!(outcome(&[]), Ok(Outcome::Complete)));
        assert!(matches!(outcome(&[Severity::Remark]), Ok(Outcome::Complete)));
        let both = [Severity::Remark, Severity::Warning];
        assert!(matches!(outcome(&both), Ok(Outcome::Degraded)));
        let failed = outcome(&[Severity::Warning, Severity::Error, Severity::Remark]);
        assert_eq!(failed.expect_err("an error").code(), 1);
    }

    #[test]
    fn fault_36_names_are_escaped_in_json_and_in_lines() {
        let report = report(&[Severity::Error]);
        let json = report.json();
        assert_eq!(json["findings"][0]["file"], "a\\u{1b}");
        assert_eq!(json["findings"][0]["severity"], "error");
        let line = line(&report.findings[0]);
        assert_eq!(line, "error [a-rule] s: a\\u{1b} (r): expected this, found that");
    }

    #[test]
    fn what_a_scene_told_is_not_told_again() {
        let mut report = report(&[Severity::Error]);
        report.add_error(Fault::new("a-rule", "a\u{1b}", "other", "words").record("r"));
        assert_eq!(report.counts(), [1, 0, 0]);
        report.add_error(Fault::new("a-rule", "a\u{1b}", "this", "that").record("another"));
        assert_eq!(report.counts(), [2, 0, 0]);
    }
}
