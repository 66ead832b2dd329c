//! Every token that is there twice or names nothing, and every sweep's file that lies outside of the
//! log's root, all tables through.
//!
//! Opening a log stops at the first of these; this is for telling them all.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::io::BufReader;
use std::path::Path;

use occlabel_core::Fault;
use serde::Deserialize;

use super::captures::file_fault;
use super::records::Records;
use super::rows::{
    CalibratedSensor, Category, EgoPose, Instance, Sample, SampleAnnotation, SampleData, SceneRow,
    Sensor,
};
use super::table::{Table, parse, repeated};
use super::token::Token;
use crate::files::open_file;

/// Of one kind in one table so many are told one by one; the others are counted.
const MAX_TOLD: usize = 100;

/// A row's token, those by which it names rows of other tables, and what tells a lidar's files.
#[derive(Deserialize)]
struct References {
    token: Token,
    scene_token: Option<Token>,
    sample_token: Option<Token>,
    sensor_token: Option<Token>,
    calibrated_sensor_token: Option<Token>,
    ego_pose_token: Option<Token>,
    category_token: Option<Token>,
    instance_token: Option<Token>,
    modality: Option<String>,
    filename: Option<String>,
}

impl References {
    /// Each with the table that it names a row of.
    fn named(&self) -> [(&'static str, Option<&Token>); 7] {
        [
            (SceneRow::FILE, self.scene_token.as_ref()),
            (Sample::FILE, self.sample_token.as_ref()),
            (Sensor::FILE, self.sensor_token.as_ref()),
            (CalibratedSensor::FILE, self.calibrated_sensor_token.as_ref()),
            (EgoPose::FILE, self.ego_pose_token.as_ref()),
            (Category::FILE, self.category_token.as_ref()),
            (Instance::FILE, self.instance_token.as_ref()),
        ]
    }
}

/// What is wrong with the references of a version folder's tables. A table that cannot be read is
/// told, and nothing is said of what names its rows.
pub(super) fn reference_faults(folder: &Path) -> Vec<Fault> {
    let mut tables = Tokens::default();
    // Each table after those whose rows it names.
    tables.add::<SceneRow>(folder);
    tables.add::<Sample>(folder);
    tables.add::<Sensor>(folder);
    tables.add::<CalibratedSensor>(folder);
    tables.add::<EgoPose>(folder);
    tables.add::<SampleData>(folder);
    tables.add::<Category>(folder);
    tables.add::<Instance>(folder);
    tables.add::<SampleAnnotation>(folder);
    tables.faults
}

/// The tokens of tables, by their files.
#[derive(Default)]
struct Tokens {
    by_file: HashMap<&'static str, HashSet<Token>>,
    /// Lidars, and their calibrations.
    lidars: HashSet<Token>,
    faults: Vec<Fault>,
}

impl Tokens {
    fn add<T: Table>(&mut self, folder: &Path) {
        let mut found = Vec::new();
        match self.read::<T>(folder, &mut found) {
            Ok(tokens) => drop(self.by_file.insert(T::FILE, tokens)),
            Err(fault) => self.faults.push(fault),
        }
        self.faults.extend(shortened(found));
    }

    /// The tokens of a table; what is wrong with them goes to `found`.
    fn read<T: Table>(
        &mut self,
        folder: &Path,
        found: &mut Vec<Fault>,
    ) -> Result<HashSet<Token>, Fault> {
        let path = folder.join(T::FILE);
        let file = open_file(&path, &path.to_string_lossy())?;
        let mut records = Records::new(BufReader::new(file), T::FILE);
        let mut tokens = HashSet::new();
        while let Some(record) = records.next_record()? {
            let row: References = parse::<T, _>(&record, None)?;
            let located = |fault: Fault| fault.record(row.token.to_string()).offset(record.offset);
            found.extend(self.dangling::<T>(&row).map(located));
            found.extend(self.misplaced(&row).map(located));
            if !tokens.insert(row.token.clone()) {
                found.push(located(repeated::<T>()));
            }
        }
        Ok(tokens)
    }

    /// A sweep whose file lies outside of the log's root. Remembers the rows of lidars, whose tables
    /// come before.
    fn misplaced(&mut self, row: &References) -> Option<Fault> {
        let is_of_lidar =
            |token: &Option<Token>| token.as_ref().is_some_and(|token| self.lidars.contains(token));
        let is_sweep = is_of_lidar(&row.calibrated_sensor_token);
        if row.modality.as_deref() == Some("lidar") || is_of_lidar(&row.sensor_token) {
            self.lidars.insert(row.token.clone());
        }
        file_fault(row.filename.as_deref().filter(|_| is_sweep)?)
    }

    /// The tokens of a row that name nothing.
    fn dangling<T: Table>(&self, row: &References) -> impl Iterator<Item = Fault> {
        let is_dangling = |(file, token): &(&str, &Token)| {
            self.by_file.get(file).is_some_and(|tokens| !tokens.contains(token))
        };
        let named = row.named().into_iter().filter_map(|(file, token)| Some((file, token?)));
        named.filter(is_dangling).map(|(file, token)| {
            Fault::new("dangling-token", T::FILE, format!("a row `{token}` in {file}"), "none")
        })
    }
}

/// The first faults of each rule, the last of these with how many there are.
fn shortened(faults: Vec<Fault>) -> Vec<Fault> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let mut kept: Vec<Fault> = Vec::new();
    for fault in faults {
        let count = counts.entry(fault.rule).or_default();
        *count += 1;
        if *count <= MAX_TOLD {
            kept.push(fault);
        }
    }
    for (rule, count) in counts.into_iter().filter(|(_, count)| *count > MAX_TOLD) {
        if let Some(last) = kept.iter_mut().rfind(|fault| fault.rule == rule) {
            last.found += &format!(", one of {count} in this table");
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_faults_the_first_are_told_and_all_are_counted() {
        let fault = |place: usize| Fault::new("dangling-token", "t", "a row", place.to_string());
        assert_eq!(shortened((0..100).map(fault).collect()).len(), 100);
        let kept = shortened((0..250).map(fault).collect());
        assert_eq!(kept.len(), 100);
        assert_eq!(kept[99].found, "99, one of 250 in this table");
        assert_eq!(kept[98], fault(98));
    }
}
