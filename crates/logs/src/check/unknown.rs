//! Raw labels that no taxonomy names, summed over sweeps.

use std::collections::BTreeMap;

use occlabel_core::Fault;

/// The rule by which readers tell of them, as `LABEL of COUNT points, …`.
pub(super) const UNKNOWN_LABEL: &str = "unknown-label";
/// What readers add where a class stands in.
const TAKEN_AS: &str = ", taken as ";

/// The fault without what is said about the class that stands in.
pub fn without_stand_in(fault: Fault) -> Fault {
    let found = fault.found.rsplit_once(TAKEN_AS).map(|(found, _)| found.to_owned());
    Fault { found: found.unwrap_or(fault.found), ..fault }
}

/// In place of the faults of single sweeps' unknown labels one that tells each label with all its
/// points, at the first such sweep. Other faults stay as they are, before it.
pub fn sum_unknown_labels(faults: Vec<Fault>) -> Vec<Fault> {
    let is_unknown = |fault: &Fault| fault.rule == UNKNOWN_LABEL;
    let (unknown, mut others): (Vec<Fault>, Vec<Fault>) = faults.into_iter().partition(is_unknown);
    let sweeps = unknown.len();
    let mut counts: BTreeMap<String, u64> = BTreeMap::new();
    let mut first = None;
    for fault in unknown.into_iter().map(without_stand_in) {
        for (label, count) in fault.found.split(", ").map(label_and_count) {
            *counts.entry(label.to_owned()).or_default() += count;
        }
        first.get_or_insert(fault);
    }
    let told = counts.iter().map(|(label, count)| format!("{label} of {count} points"));
    let found = format!("{}, in {sweeps} sweeps", told.collect::<Vec<_>>().join(", "));
    others.extend(first.map(|first| Fault { found, ..first }));
    others
}

/// `LABEL of COUNT points`; 0 for what is told otherwise.
fn label_and_count(told: &str) -> (&str, u64) {
    let (label, count) = told.rsplit_once(" of ").unwrap_or((told, ""));
    (label, count.strip_suffix(" points").and_then(|count| count.parse().ok()).unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fault_26_labels_are_summed_over_sweeps() {
        let fault = |file: &str, found: &str| Fault::new(UNKNOWN_LABEL, file, "known ones", found);
        let other = Fault::new("sweep-empty", "c", "points", "none");
        let faults = vec![
            fault("a", "7 (ufo) of 3 points, 9 (elk) of 1 points"),
            other.clone(),
            fault("b", "9 (elk) of 40 points, taken as `car`"),
        ];
        let summed = sum_unknown_labels(faults);
        let found = "7 (ufo) of 3 points, 9 (elk) of 41 points, in 2 sweeps";
        assert_eq!(summed, [other, fault("a", found)]);
        assert!(sum_unknown_labels(Vec::new()).is_empty());
    }

    #[test]
    fn what_stands_in_is_left_out() {
        let fault = |found: &str| Fault::new(UNKNOWN_LABEL, "a", "known ones", found);
        let taken = without_stand_in(fault("7 of 3 points, taken as `car`"));
        assert_eq!(taken, fault("7 of 3 points"));
        assert_eq!(without_stand_in(taken.clone()), taken);
    }
}
