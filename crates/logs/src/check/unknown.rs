//! Raw labels that no taxonomy names, summed over sweeps.

use occlabel_core::Fault;

use crate::UnknownLabels;
use crate::raw_labels::UNKNOWN_LABEL;

/// The unknown labels of a scene, gathered from its sweeps.
#[derive(Clone, Debug, Default)]
pub struct UnknownSum {
    /// What was said of the first sweep that has some.
    first: Option<Fault>,
    labels: UnknownLabels,
    sweeps: usize,
}

impl UnknownSum {
    /// Adds a sweep's unknown labels; gives back what else was odd about it.
    pub fn add(&mut self, unknown: UnknownLabels, warnings: Vec<Fault>) -> Vec<Fault> {
        self.sweeps += usize::from(!unknown.is_empty());
        self.labels.add(unknown);
        let is_unknown = |fault: &Fault| fault.rule == UNKNOWN_LABEL;
        let (told, others): (Vec<_>, _) = warnings.into_iter().partition(is_unknown);
        self.first = self.first.take().or(told.into_iter().next());
        others
    }

    /// One fault that tells each label with all its points, at the first sweep that has some.
    pub fn fault(self) -> Option<Fault> {
        let found = format!("{}, in {} sweeps", self.labels, self.sweeps);
        self.first.map(|first| Fault { found, ..first })
    }
}

#[cfg(test)]
mod tests {
    use occlabel_core::ClassId;

    use super::*;
    use crate::ReadOptions;
    use crate::raw_labels::{RawLabels, tests::options};

    /// What reading a sweep of these labels gives; 18 is known.
    fn read(file: &str, raw: &[i64]) -> (UnknownLabels, Vec<Fault>) {
        let name =
            |raw| Some(if raw == 18 { "ROAD".into() } else { format!("a, of {raw} points") });
        let options = ReadOptions { unknown_as: Some(ClassId(0)), ..options() };
        let mut labels = RawLabels::new(&options, name);
        labels.labels(raw.to_vec());
        let mut warnings = vec![Fault::new("sweep-empty", file, "points", "none")];
        let unknown = labels.finish(file, &mut warnings).unwrap();
        (unknown, warnings)
    }

    #[test]
    fn fault_26_labels_are_summed_over_sweeps() {
        let mut sum = UnknownSum::default();
        let sweeps = [("a", &[18][..]), ("b", &[10, 18, 9, 10]), ("c", &[18, 9, 18]), ("d", &[])];
        for (file, raw) in sweeps {
            let (unknown, warnings) = read(file, raw);
            let others = sum.add(unknown, warnings);
            assert_eq!(others, [Fault::new("sweep-empty", file, "points", "none")]);
        }
        let fault = sum.fault().unwrap();
        assert_eq!((fault.rule, fault.place.as_str()), (UNKNOWN_LABEL, "b"));
        let found = "9 (a, of 9 points) of 2 points, 10 (a, of 10 points) of 2 points, in 2 sweeps";
        assert_eq!(fault.found, found);
    }

    #[test]
    fn nothing_is_said_where_all_labels_are_known() {
        let mut sum = UnknownSum::default();
        let (unknown, warnings) = read("a", &[18]);
        sum.add(unknown, warnings);
        assert_eq!(sum.fault(), None);
    }
}
