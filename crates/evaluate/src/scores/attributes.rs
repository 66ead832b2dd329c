//! What is known of scenes, from a table: weather, time of day, kind of place.

use std::collections::BTreeMap;

use occlabel_core::Fault;

/// The attributes of scenes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SceneAttributes {
    names: Vec<String>,
    scenes: BTreeMap<String, Vec<String>>,
}

impl SceneAttributes {
    /// Reads a table of tab-separated values: a heading `scene` and the attributes' names, then a
    /// line for each scene. Empty lines, and lines that begin with `#`, are passed over; an empty
    /// value says that the scene has none.
    ///
    /// # Errors
    /// If the heading is absent or does not begin with `scene`, names no attribute or one twice, a
    /// line has another number of values, or a scene comes twice.
    pub fn parse(text: &str, place: &str) -> Result<Self, Fault> {
        let lines = (1..).zip(text.lines().map(|line| line.trim_end_matches('\r')));
        let mut lines = lines.filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
        let fault = |line: usize, expected: String, found: String| {
            Fault::new("attributes", place, expected, found).record(format!("line {line}"))
        };
        let heading = lines.next().ok_or_else(|| fault(1, HEADING.into(), "nothing".into()))?;
        let names = names(heading.1)
            .ok_or_else(|| fault(heading.0, HEADING.into(), format!("`{}`", heading.1)))?;
        let mut scenes = BTreeMap::new();
        for (number, line) in lines {
            let mut values = line.split('\t').map(|value| value.trim().to_owned());
            let scene = values.next().unwrap_or_default();
            let values: Vec<String> = values.collect();
            if values.len() != names.len() || scene.is_empty() {
                let expected = format!("a scene and {} values", names.len());
                return Err(fault(number, expected, format!("`{line}`")));
            }
            if scenes.insert(scene.clone(), values).is_some() {
                return Err(fault(number, "a scene not named before".into(), scene));
            }
        }
        Ok(Self { names, scenes })
    }

    /// The attributes that a scene has a value of: their names and values.
    pub fn of<'a>(&'a self, scene: &str) -> impl Iterator<Item = (&'a str, &'a str)> + use<'a> {
        let values = self.scenes.get(scene).into_iter().flatten();
        let pairs = self.names.iter().zip(values);
        pairs
            .map(|(name, value)| (name.as_str(), value.as_str()))
            .filter(|(_, value)| !value.is_empty())
    }

    /// Whether the table has a line for a scene.
    pub fn knows(&self, scene: &str) -> bool {
        self.scenes.contains_key(scene)
    }
}

const HEADING: &str = "a heading: `scene`, and different names of attributes, between tabs";

fn names(heading: &str) -> Option<Vec<String>> {
    let mut names = heading.split('\t').map(|name| name.trim().to_owned());
    let is_scene = names.next().as_deref() == Some("scene");
    let names: Vec<String> = names.collect();
    let is_new = |at: usize| !names[at].is_empty() && !names[..at].contains(&names[at]);
    (is_scene && !names.is_empty() && (0..names.len()).all(is_new)).then_some(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_has_the_values_of_its_line() {
        let table = "# PanoMMOcc\nscene\ttype\tlight\r\ns1\tcampus\tday\n\ns2\tforest\t\n";
        let attributes = SceneAttributes::parse(table, "a.tsv").unwrap();
        assert_eq!(attributes.of("s1").collect::<Vec<_>>(), [("type", "campus"), ("light", "day")]);
        assert_eq!(attributes.of("s2").collect::<Vec<_>>(), [("type", "forest")]);
        assert!(attributes.of("s3").next().is_none() && !attributes.knows("s3"));
    }

    #[test]
    fn a_table_that_is_none_is_refused_with_its_line() {
        let refusal = |table| SceneAttributes::parse(table, "a.tsv").unwrap_err().to_string();
        for table in ["", "scene\n", "scene\ta\ta\n", "token\ta\n", "scene\t\n"] {
            assert!(refusal(table).contains("heading"), "{table:?}");
        }
        assert!(refusal("scene\ta\ns1\n").contains("line 2"));
        assert!(refusal("scene\ta\ns1\tx\ns1\ty\n").contains("line 3"));
    }
}
