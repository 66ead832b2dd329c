//! What every reader is asked for.

use std::collections::BTreeSet;
use std::sync::Arc;

use occlabel_core::{ClassId, Fault, KeyframeSettings, Meaning, PointLabel, Taxonomy};

/// What stands between unknown names and the class that stands in for them.
const TAKEN_AS: &str = ", taken as ";

/// What to read of a log, and by which classes.
#[derive(Clone, Debug)]
pub struct ReadOptions {
    /// Names of the wanted scenes; `None`: all.
    pub scenes: Option<BTreeSet<String>>,
    /// What point labels and box categories mean.
    pub taxonomy: Arc<Taxonomy>,
    /// Which moments become keyframes.
    pub keyframes: KeyframeSettings,
    /// The class of labels and categories that the taxonomy does not name; `None` refuses them.
    pub unknown_as: Option<ClassId>,
}

impl ReadOptions {
    /// All scenes at the format's own keyframes; what the taxonomy does not name is refused.
    pub fn of(taxonomy: Taxonomy) -> Self {
        let (taxonomy, keyframes) = (Arc::new(taxonomy), KeyframeSettings::annotated());
        Self { scenes: None, taxonomy, keyframes, unknown_as: None }
    }

    /// Whether a scene is wanted.
    pub(crate) fn wants(&self, scene: &str) -> bool {
        self.scenes.as_ref().is_none_or(|wanted| wanted.contains(scene))
    }

    /// What a box category means; `None` if it is unknown and no class stands in for it.
    pub(crate) fn box_meaning(&self, category: &str) -> Option<Meaning> {
        let known = self.taxonomy.boxes.get(category).copied();
        known.or(self.unknown_as.map(Meaning::Class))
    }

    /// What a raw point label means; `None` if it is unknown and no class stands in for it.
    pub(crate) fn point_label(&self, raw: &str) -> Option<PointLabel> {
        match self.taxonomy.points.get(raw) {
            Some(Meaning::Class(class)) => Some(PointLabel::Class(*class)),
            Some(Meaning::Ignore) => Some(PointLabel::Ignored),
            None => self.unknown_as.map(PointLabel::Class),
        }
    }

    /// The fault of something that the taxonomy does not name: a warning if a class stands in for
    /// it.
    pub(crate) fn unknown(&self, fault: Fault) -> Result<Fault, Fault> {
        let Some(class) = self.unknown_as else { return Err(unknown_hint(fault)) };
        let name = self.taxonomy.names.get(class.index());
        let taken_as = name.map_or_else(|| class.0.to_string(), |name| format!("`{name}`"));
        Ok(Fault { found: format!("{}{TAKEN_AS}{taken_as}", fault.found), ..fault })
    }
}

/// A fault of unknown names with what can be done; a format's own hint stays.
pub fn unknown_hint(fault: Fault) -> Fault {
    let hint = "`--unknown-as CLASS` gives it a class".to_owned();
    Fault { hint: fault.hint.clone().or(Some(hint)), ..fault }
}

/// A warning of unknown names without what is said about the class that stands in for them.
pub fn without_stand_in(fault: Fault) -> Fault {
    let found = fault.found.rsplit_once(TAKEN_AS).map(|(found, _)| found.to_owned());
    Fault { found: found.unwrap_or(fault.found), ..fault }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raw_labels::tests::options;

    #[test]
    fn what_stands_in_is_left_out_of_a_warning() {
        let options = ReadOptions { unknown_as: Some(ClassId(1)), ..options() };
        let told = Fault::new("unknown-category", "a", "known ones", "`ufo` of 3 boxes");
        let taken = options.unknown(told.clone()).unwrap();
        assert_eq!(taken.found, "`ufo` of 3 boxes, taken as `vehicle`");
        assert_eq!(without_stand_in(taken), told);
        assert_eq!(without_stand_in(told.clone()), told);
    }
}
