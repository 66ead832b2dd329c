//! The names of point classes: `classes.json`.

use std::collections::BTreeMap;
use std::path::Path;

use occlabel_core::Fault;

use super::json::read_json;

/// What the numbers of points' classes are called; without a file there are no classes.
#[derive(Clone, Debug, Default)]
pub(super) struct Classes {
    names: Option<BTreeMap<i64, Option<String>>>,
}

impl Classes {
    /// Reads an object of names by number; `null` is what nobody labelled.
    ///
    /// # Errors
    /// If the file is no such object.
    pub(super) fn read(root: &Path, file: &str) -> Result<Self, Fault> {
        let names: BTreeMap<String, Option<String>> = read_json(root, file)?;
        let number = |(number, name): (String, _)| match number.parse() {
            Ok(number) => Ok((number, name)),
            Err(_) => {
                let found = format!("`{number}`");
                Err(Fault::new("cloud-classes", file, "names by whole numbers", found))
            }
        };
        Ok(Self { names: Some(names.into_iter().map(number).collect::<Result<_, _>>()?) })
    }

    pub(super) fn exist(&self) -> bool {
        self.names.is_some()
    }

    /// The class of a point as a whole number; none if it has none.
    pub(super) fn raw(&self, class: f64) -> Option<i64> {
        (self.exist() && class.is_finite()).then_some(class as i64)
    }

    /// What a number is called: itself where no name is given; none if nobody labelled such a point.
    pub(super) fn name(&self, raw: i64) -> Option<String> {
        let named = self.names.as_ref().and_then(|names| names.get(&raw));
        named.cloned().unwrap_or_else(|| Some(raw.to_string()))
    }
}
