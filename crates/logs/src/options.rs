//! What every reader is asked for.

use std::collections::BTreeSet;
use std::sync::Arc;

use occlabel_core::{ClassId, Fault, KeyframeSettings, Meaning, PointLabel, Taxonomy};

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
        let Some(class) = self.unknown_as else {
            return Err(fault.hint("`--unknown-as CLASS` gives it a class"));
        };
        let name = self.taxonomy.names.get(class.index());
        let taken_as = name.map_or_else(|| class.0.to_string(), |name| format!("`{name}`"));
        Ok(Fault { found: format!("{}, taken as {taken_as}", fault.found), ..fault })
    }
}
