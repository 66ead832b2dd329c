//! What is to be said about a scene besides the scene itself.

use std::collections::BTreeSet;

use occlabel_core::{Fault, Loss, Refusal};

/// So many records that were left out explain why nothing is left.
const FIRST_REFUSED: usize = 2;

/// Warnings and refusals, as they come up.
#[derive(Debug, Default)]
pub(crate) struct Notes {
    warnings: Vec<Fault>,
    refused: Vec<Refusal>,
}

impl Notes {
    /// Notes something odd that can be lived with.
    pub(crate) fn warn(&mut self, fault: Fault) {
        self.warnings.push(fault);
    }

    /// The warnings of a rule with this hint.
    pub(crate) fn hint(&mut self, rule: &str, hint: &str) {
        for odd in self.warnings.iter_mut().filter(|odd| odd.rule == rule) {
            odd.hint = Some(hint.to_owned());
        }
    }

    /// Notes a record that is left out.
    pub(crate) fn refuse(&mut self, loss: Loss, fault: Fault) {
        self.refused.push(Refusal { loss, fault });
    }

    /// The value, or a note that it is left out.
    pub(crate) fn accept<T>(&mut self, loss: Loss, result: Result<T, Fault>) -> Option<T> {
        result.map_err(|fault| self.refuse(loss, fault)).ok()
    }

    /// The fault of a scene that has no sweep to go by, with why: how many records were left out,
    /// the first of them, and the warnings that come with a hint.
    pub(crate) fn explain(&self, fault: Fault) -> Fault {
        let costs_sweeps = |refusal: &&Refusal| {
            matches!(refusal.loss, Loss::Sweep | Loss::Keyframe | Loss::Remainder)
        };
        let refused: Vec<&Fault> =
            self.refused.iter().filter(costs_sweeps).map(|refusal| &refusal.fault).collect();
        if refused.is_empty() {
            return fault;
        }
        let hinted = folded(self.warnings.clone()).into_iter().filter(|odd| odd.hint.is_some());
        let hinted: Vec<Fault> = hinted.collect();
        let first = refused.iter().copied().take(FIRST_REFUSED).chain(&hinted);
        let told: Vec<String> = first.map(|fault| unhinted(fault).to_string()).collect();
        let (found, records) = (&fault.found, refused.len());
        let found = format!("{found}: {records} records refused, the first: {}", told.join("; "));
        let hints = refused.into_iter().chain(&hinted).filter_map(|fault| fault.hint.clone());
        // The log is at fault, and not the name of the lidar.
        Fault { rule: "no-sweeps", found, hint: hints.chain(fault.hint).next(), ..fault }
    }

    /// Warnings, those of one rule and place folded into the first, and refusals.
    pub(crate) fn finish(self) -> (Vec<Fault>, Vec<Refusal>) {
        (folded(self.warnings), self.refused)
    }
}

/// A warning that many records cause stands once, with their number.
fn folded(warnings: Vec<Fault>) -> Vec<Fault> {
    let mut kinds: Vec<(Fault, BTreeSet<Option<String>>)> = Vec::new();
    for warning in warnings {
        let same = |(first, _): &&mut (Fault, _)| {
            (first.rule, &first.place) == (warning.rule, &warning.place)
        };
        match kinds.iter_mut().find(same) {
            Some((_, records)) => drop(records.insert(warning.record)),
            None => {
                let records = BTreeSet::from([warning.record.clone()]);
                kinds.push((warning, records));
            }
        }
    }
    kinds.into_iter().map(|(first, records)| counted(first, records.len())).collect()
}

fn unhinted(fault: &Fault) -> Fault {
    Fault { hint: None, ..fault.clone() }
}

fn counted(first: Fault, records: usize) -> Fault {
    match records {
        1 => first,
        _ => Fault {
            found: format!("{}, the first of {records} such records", first.found),
            ..first
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_warning_of_many_records_stands_once_with_their_number() {
        let mut notes = Notes::default();
        let warning = |rule, record: &str| Fault::new(rule, "t", "a", "b").record(record);
        for record in ["x", "y", "x", "z"] {
            notes.warn(warning("many", record));
        }
        notes.warn(warning("one", "x"));
        let (warnings, _) = notes.finish();
        assert_eq!(warnings.len(), 2);
        assert_eq!(
            warnings[0].to_string(),
            "t (x): expected a, found b, the first of 3 such records"
        );
        assert_eq!(warnings[1], warning("one", "x"));
    }

    #[test]
    fn a_scene_without_sweeps_is_explained_by_what_was_refused() {
        let mut notes = Notes::default();
        let fault = Fault::new("reference-lidar", "s", "sweeps", "no sweeps").hint("another");
        assert_eq!(notes.explain(fault.clone()), fault);
        notes.refuse(Loss::Annotation, Fault::new("box", "b", "a box", "none"));
        assert_eq!(notes.explain(fault.clone()), fault);
        for line in 1..=3 {
            let refused = Fault::new("pose", "poses.txt", "12 numbers", "1 lines");
            notes.refuse(Loss::Keyframe, refused.record(format!("line {line}")));
        }
        notes.warn(Fault::new("clock", "s", "one clock", "two").hint("choose"));
        assert_eq!(
            notes.explain(fault).to_string(),
            "s: expected sweeps, found no sweeps: 3 records refused, the first: \
             poses.txt (line 1): expected 12 numbers, found 1 lines; \
             poses.txt (line 2): expected 12 numbers, found 1 lines; \
             s: expected one clock, found two; hint: choose"
        );
    }
}
