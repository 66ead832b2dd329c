//! The fields that a page describes in its tables, and whether an object has them.

use std::fs;
use std::path::Path;

use serde_json::Value;

/// Fields with their types, in the order of the page.
#[derive(Clone, Debug)]
pub(crate) struct Documented(Vec<(String, String)>);

impl Documented {
    /// What the tables under a heading of a page of `docs/` say.
    pub(crate) fn in_page(page: &str, heading: &str) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs").join(page);
        let text = fs::read_to_string(path).expect("a page");
        let (_, section) = text.split_once(&format!("\n## {heading}\n")).expect("the heading");
        let section = section.split("\n## ").next().expect("a section");
        let fields: Vec<_> = section.lines().filter_map(row).collect();
        assert!(!fields.is_empty(), "no table under {heading}");
        Self(fields)
    }

    /// These fields, then those.
    pub(crate) fn and(mut self, more: &Self) -> Self {
        self.0.extend_from_slice(&more.0);
        self
    }

    /// These but some.
    pub(crate) fn without(mut self, names: &[&str]) -> Self {
        self.0.retain(|(name, _)| !names.contains(&name.as_str()));
        self
    }

    /// Asserts that an object has all these fields with their types, and no other.
    #[track_caller]
    pub(crate) fn describes(&self, object: &Value) {
        for (name, kind) in &self.0 {
            let value = name.split('.').try_fold(object, |object, key| object.get(key));
            let value = value.unwrap_or_else(|| panic!("no {name} in {object}"));
            let fits = kind.split(" or ").any(|kind| is_of(value, kind));
            assert!(fits, "{name} is {value}, and no {kind}, in {object}");
        }
        self.names_all_of("", object);
    }

    #[track_caller]
    fn names_all_of(&self, above: &str, object: &Value) {
        for (key, value) in object.as_object().into_iter().flatten() {
            let path = format!("{above}{key}");
            if !self.0.iter().any(|(name, _)| *name == path) {
                let below = format!("{path}.");
                let is_table = self.0.iter().any(|(name, _)| name.starts_with(&below));
                assert!(is_table, "{path} is not described");
                self.names_all_of(&below, value);
            }
        }
    }
}

/// Name and type of a row of a table: | `name` | type | what |.
fn row(line: &str) -> Option<(String, String)> {
    let mut cells = line.strip_prefix("| `")?.split('|');
    let name = cells.next()?.trim().trim_end_matches('`');
    Some((name.to_owned(), cells.next()?.trim().to_owned()))
}

fn is_of(value: &Value, kind: &str) -> bool {
    let all = |kind| value.as_object().is_some_and(|all| all.values().all(|v| is_of(v, kind)));
    match kind {
        "text" => value.is_string(),
        "integer" => value.is_u64(),
        "number" => value.is_number(),
        "null" => value.is_null(),
        "list" => value.is_array(),
        "object" => value.is_object(),
        "object of integers" => all("integer"),
        "object of numbers" => all("number"),
        kind => panic!("an unknown type: {kind}"),
    }
}
