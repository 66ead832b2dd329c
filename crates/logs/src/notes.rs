//! What is to be said about a scene besides the scene itself.

use std::collections::BTreeSet;

use occlabel_core::{Fault, Loss, Refusal};

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

    /// Notes a record that is left out.
    pub(crate) fn refuse(&mut self, loss: Loss, fault: Fault) {
        self.refused.push(Refusal { loss, fault });
    }

    /// The value, or a note that it is left out.
    pub(crate) fn accept<T>(&mut self, loss: Loss, result: Result<T, Fault>) -> Option<T> {
        result.map_err(|fault| self.refuse(loss, fault)).ok()
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
}
