//! A dialect: everything in which label sets differ, as data.

use occlabel_core::{Fault, GridSpec};
use occlabel_labels::NumberType;
use serde::{Deserialize, Serialize};

use crate::shipped::SHIPPED;
use crate::{Array, ClassTable, Column, Element, Holds, Layout};

/// Everything in which a label set differs from another.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Dialect {
    /// Its name: that of its file.
    #[serde(skip)]
    pub name: String,
    /// Its name for people.
    pub title: String,
    /// The array that says where nothing was observed, or `none`.
    pub unobserved: String,
    /// What it has no words for.
    pub cannot_say: Vec<String>,
    /// The file that lists all keyframes, if it has one: see [`Annotations`](crate::Annotations).
    pub annotations: Option<String>,
    /// Its published grid.
    pub grid: DialectGrid,
    /// Its classes.
    pub classes: ClassTable,
    /// Where a keyframe's files stand, and what is in them.
    pub layout: Layout,
}

/// The grid that a dialect's files were published with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DialectGrid {
    /// `ego` or `lidar`.
    pub frame: String,
    /// Lower corner, metres.
    pub min_m: [f64; 3],
    /// Upper corner, metres.
    pub max_m: [f64; 3],
    /// Voxel size, metres.
    pub voxel_size_m: [f64; 3],
}

impl Dialect {
    /// The dialect of a name.
    ///
    /// # Errors
    /// If no dialect has it; the fault names all that there are.
    pub fn named(name: &str) -> Result<Self, Fault> {
        match SHIPPED.iter().find(|(known, _)| *known == name) {
            Some((_, text)) => Self::parse(name, text),
            None => {
                let expected = format!("one of {}", Self::names().join(", "));
                Err(Fault::new("dialect", "--dialect", expected, format!("`{name}`")))
            }
        }
    }

    /// The names of the dialects.
    pub fn names() -> Vec<&'static str> {
        SHIPPED.iter().map(|(name, _)| *name).collect()
    }

    /// All dialects.
    pub fn all() -> Vec<Self> {
        let parse = |(name, text): &(&str, &str)| Self::parse(name, text).expect("a sound dialect");
        SHIPPED.iter().map(parse).collect()
    }

    /// A dialect from the text of its file.
    ///
    /// # Errors
    /// If the text is no TOML, or the dialect contradicts itself.
    pub fn parse(name: &str, text: &str) -> Result<Self, Fault> {
        let read = toml::from_str(text).map_err(|error: toml::de::Error| {
            Fault::new("dialect", name, "a dialect file", error.message())
        });
        let dialect = Self { name: name.to_owned(), ..read? };
        dialect.grid.spec()?;
        dialect.classes.check(name)?;
        dialect.check_layout()?;
        Ok(dialect)
    }

    /// The array that holds this, if the dialect has one.
    pub fn array_of(&self, holds: &Holds) -> Option<&Array> {
        self.layout.arrays().iter().find(|array| array.holds == *holds)
    }

    /// Whether it can say this.
    pub fn can_say(&self, holds: &Holds) -> bool {
        match (&self.layout, holds) {
            (Layout::Rows(_), Holds::Semantics) => true,
            (Layout::Rows(rows), Holds::Flow) => {
                rows.tables.iter().any(|table| table.column(Column::Vx).is_some())
            }
            _ => self.array_of(holds).is_some(),
        }
    }

    /// In what a grid differs from the one that the dialect was published with.
    pub fn grid_notes(&self, frame: &str, spec: &GridSpec) -> Vec<String> {
        let mut notes = Vec::new();
        if frame != self.grid.frame {
            let theirs = &self.grid.frame;
            notes.push(format!(
                "frame: the grid stands in the {frame} frame, published in the {theirs} frame"
            ));
        }
        if let Ok(published) = self.grid.spec()
            && published != *spec
        {
            let (ours, theirs) = (limits(spec), limits(&published));
            notes.push(format!("grid: {ours}, published as {theirs}; nothing is resampled"));
        }
        notes
    }

    fn check_layout(&self) -> Result<(), Fault> {
        let refused = |expected: &str, found: &str| {
            Err(Fault::new("dialect", &self.name, expected, found).record("layout"))
        };
        if !self.can_say(&Holds::Semantics) {
            return refused("an array of semantics", "none");
        }
        if !self.layout.path().contains("{token}") {
            return refused("a path with {token}", self.layout.path());
        }
        let has_no_files = !matches!(self.layout, Layout::VoxelFiles(_));
        let is_unwritable = |array: &&Array| match array.element {
            Element::Bits(_) => has_no_files,
            Element::Number(number) => number == NumberType::F16,
        };
        match self.layout.arrays().iter().find(is_unwritable) {
            Some(array) => refused("bits in voxel files only, and no f16", &array.name),
            None if self
                .array_of(&Holds::Flow)
                .is_some_and(|it| !(2..=3).contains(&it.components)) =>
            {
                refused("two or three components of flow", "others")
            }
            None if !self.layout.has_all_columns() => refused("columns x, y, z, class", "fewer"),
            None => Ok(()),
        }
    }
}

fn limits(spec: &GridSpec) -> String {
    let [x, y, z] = spec.shape();
    let (min, max): ([f64; 3], [f64; 3]) = (spec.min_m().into(), spec.max_m().into());
    format!("{x} x {y} x {z} voxels from {min:?} to {max:?} m")
}

impl DialectGrid {
    /// The grid itself.
    ///
    /// # Errors
    /// If the limits and sizes make no grid.
    pub fn spec(&self) -> Result<GridSpec, Fault> {
        GridSpec::new(self.min_m, self.max_m, self.voxel_size_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_dialect_is_sound_and_says_what_is_unobserved() {
        let dialects = Dialect::all();
        assert_eq!(dialects.len(), 14);
        for dialect in dialects {
            let mask = dialect.array_of(&Holds::MaskLidar).map_or("none", |array| &array.name);
            assert_eq!(dialect.unobserved, mask, "{}", dialect.name);
            assert!(dialect.cannot_say.len() > 1, "{}", dialect.name);
        }
    }

    #[test]
    fn the_published_grids_have_the_published_shapes() {
        let shape = |name: &str| Dialect::named(name).unwrap().grid.spec().unwrap().shape();
        assert_eq!(shape("occ3d-nuscenes"), [200, 200, 16]);
        assert_eq!(shape("occ3d-waymo-fine"), [1600, 1600, 64]);
        assert_eq!(shape("surroundocc"), [200, 200, 16]);
        assert_eq!(shape("openoccupancy"), [512, 512, 40]);
        assert_eq!(shape("openscene"), [200, 200, 16]);
        assert_eq!(shape("semantickitti"), [256, 256, 32]);
    }

    #[test]
    fn a_dialect_that_contradicts_itself_is_refused() {
        let text = SHIPPED.iter().find(|(name, _)| *name == "semantickitti").unwrap().1;
        let wrong = [
            ("free = 0", "free = 10"),
            ("kind = \"voxel-files\"", "kind = \"npz\""),
            ("holds = \"semantics\"", "holds = \"else\""),
            ("{token}", "token"),
            ("title", "tilte"),
            ("type = \"u16\"", "type = \"u15\""),
        ];
        for (from, to) in wrong {
            let fault = Dialect::parse("x", &text.replace(from, to));
            assert!(fault.is_err(), "{to}");
        }
        assert!(Dialect::named("occ3d").unwrap_err().expected.contains("uniocc"));
    }
}
