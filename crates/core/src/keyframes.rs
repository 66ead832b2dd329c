//! Which moments get a grid: the `[keyframes]` table.

use serde::{Deserialize, Serialize};

/// Which moments become keyframes (labels.md section 2).
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KeyframeSettings {
    /// Where keyframes come from.
    pub source: KeyframeSource,
    /// Every how many-th of them is taken, at least 1.
    pub stride: usize,
    /// The lidar whose sweeps keyframes refer to; `"auto"`: LIDAR_TOP or TOP, else the first by name.
    pub reference_lidar: String,
}

/// Where keyframes come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum KeyframeSource {
    /// The format's own keyframes.
    Annotated,
    /// Every sweep of the reference lidar.
    Sweeps,
}

impl KeyframeSettings {
    /// All of the format's own keyframes, of the lidar that `"auto"` takes.
    pub fn annotated() -> Self {
        Self { source: KeyframeSource::Annotated, stride: 1, reference_lidar: "auto".into() }
    }

    /// The reference lidar among the lidars of a log; `None` if the named one is not there.
    pub fn choose_lidar(&self, lidars: &[String]) -> Option<String> {
        let chosen = match self.reference_lidar.as_str() {
            "auto" => reference_lidar(lidars),
            name => lidars.iter().find(|lidar| *lidar == name),
        };
        chosen.cloned()
    }
}

/// The lidar that keyframes refer to unless told: LIDAR_TOP or TOP, else the first by name
/// (labels.md section 2).
pub fn reference_lidar(lidars: &[String]) -> Option<&String> {
    let named = |name: &str| lidars.iter().find(|lidar| *lidar == name);
    named("LIDAR_TOP").or_else(|| named("TOP")).or_else(|| lidars.iter().min())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn choose(wanted: &str, lidars: &[&str]) -> Option<String> {
        let lidars: Vec<String> = lidars.iter().map(|name| name.to_string()).collect();
        let reference_lidar = wanted.into();
        let settings = KeyframeSettings { reference_lidar, ..KeyframeSettings::annotated() };
        settings.choose_lidar(&lidars)
    }

    #[test]
    fn section_2_the_reference_lidar_is_the_named_one_else_the_top_one_else_the_first() {
        assert_eq!(choose("B", &["A", "B", "LIDAR_TOP"]).as_deref(), Some("B"));
        assert_eq!(choose("auto", &["A", "LIDAR_TOP", "TOP"]).as_deref(), Some("LIDAR_TOP"));
        assert_eq!(choose("auto", &["A", "TOP"]).as_deref(), Some("TOP"));
        assert_eq!(choose("auto", &["C", "A", "B"]).as_deref(), Some("A"));
        assert_eq!(choose("missing", &["A"]), None);
        assert_eq!(choose("auto", &[]), None);
    }
}
