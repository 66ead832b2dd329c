//! The tables of a version folder, as far as the wanted scenes need them.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::path::Path;

use occlabel_core::Fault;

use super::label_files::{LabelFiles, read_label_files};
use super::names::{nearest_names, quoted};
use super::files::is_folder_name;
use super::rows::{
    CalibratedSensor, Category, EgoPose, Instance, Sample, SampleAnnotation, SampleData, SceneRow,
    Sensor,
};
use super::table::{Row, Table, dangling, duplicate, read_keyed, read_table};
use super::token::Token;

/// The rows that belong to one scene.
#[derive(Debug)]
pub(super) struct SceneRows {
    /// The scene's name.
    pub(super) name: String,
    /// Its annotated moments.
    pub(super) samples: Vec<Row<Sample>>,
    /// Its sweeps and images.
    pub(super) captures: Vec<Row<SampleData>>,
    /// Its boxes.
    pub(super) annotations: Vec<Row<SampleAnnotation>>,
}

/// The wanted scenes' rows, and the rows that these name.
#[derive(Debug)]
pub(super) struct Tables {
    /// Wanted scenes, in the order of their table.
    pub(super) scenes: Vec<SceneRows>,
    pub(super) sensors: HashMap<Token, Row<Sensor>>,
    pub(super) calibrations: HashMap<Token, Row<CalibratedSensor>>,
    pub(super) poses: HashMap<Token, Row<EgoPose>>,
    pub(super) instances: HashMap<Token, Row<Instance>>,
    pub(super) categories: HashMap<Token, Row<Category>>,
    pub(super) labels: LabelFiles,
}

/// For each row of a table, the place of its scene among the wanted ones, if that is wanted.
type SceneOf = HashMap<Token, Option<usize>>;

impl Tables {
    /// Reads each table once, keeping what the wanted scenes need; all scenes if none are named.
    ///
    /// # Errors
    /// If a table cannot be read, a wanted scene is not there, a scene's name cannot be a folder's,
    /// a sample, sweep or box names a row that is not there, or a token is there twice.
    pub(super) fn read(folder: &Path, wanted: Option<&BTreeSet<String>>) -> Result<Self, Fault> {
        let (mut scenes, scene_of) = read_scenes(folder, wanted)?;
        let scene_of = read_samples(folder, &scene_of, &mut scenes)?;
        let sensors = read_keyed(folder, |_| true)?;
        let calibrations = read_keyed(folder, |_| true)?;
        let unused = other_sensors(&sensors, &calibrations);
        read_captures(folder, &scene_of, &unused, &mut scenes)?;
        read_annotations(folder, &scene_of, &mut scenes)?;
        let poses = read_poses(folder, &scenes)?;
        let instances = read_instances(folder, &scenes)?;
        let categories = read_keyed(folder, |_| true)?;
        let labels = read_label_files(folder)?;
        Ok(Self { scenes, sensors, calibrations, poses, instances, categories, labels })
    }

    /// The rows of a wanted scene.
    pub(super) fn scene(&self, name: &str) -> Option<&SceneRows> {
        self.scenes.iter().find(|scene| scene.name == name)
    }
}

fn read_scenes(
    folder: &Path,
    wanted: Option<&BTreeSet<String>>,
) -> Result<(Vec<SceneRows>, SceneOf), Fault> {
    let mut rows: Vec<Row<SceneRow>> = Vec::new();
    read_table(folder, |_| Ok(true), |row| rows.push(row))?;
    check_wanted(&rows, wanted)?;
    let is_wanted = |name: &String| wanted.is_none_or(|wanted| wanted.contains(name));
    let (mut scenes, mut scene_of, mut names) = (Vec::new(), SceneOf::new(), HashSet::new());
    for row in rows {
        let place = is_wanted(&row.name).then_some(scenes.len());
        if place.is_some() {
            check_name(&row, names.insert(row.name.clone()))?;
            scenes.push(SceneRows::named(&row.name));
        }
        if scene_of.contains_key(&row.token) {
            return Err(row.fault("duplicate-token", "one row a token", "another one"));
        }
        scene_of.insert(row.token, place);
    }
    Ok((scenes, scene_of))
}

/// Whether every scene that is asked for by name is there.
fn check_wanted(rows: &[Row<SceneRow>], wanted: Option<&BTreeSet<String>>) -> Result<(), Fault> {
    let known: Vec<&str> = rows.iter().map(|row| row.name.as_str()).collect();
    let absent = |name: &&String| !known.contains(&name.as_str());
    let Some(name) = wanted.into_iter().flatten().find(absent) else { return Ok(()) };
    let near = quoted(&nearest_names(name, &known));
    let fault = Fault::new("scene-unknown", SceneRow::FILE, format!("a scene `{name}`"), "none");
    Err(if near.is_empty() { fault } else { fault.hint(format!("there is {near}")) })
}

fn check_name(row: &Row<SceneRow>, is_first: bool) -> Result<(), Fault> {
    let fault = |expected: &str| Err(row.fault("scene-name", expected, format!("`{}`", row.name)));
    match (is_folder_name(&row.name), is_first) {
        (false, _) => fault("a name of letters, digits, `.`, `_` and `-`"),
        (true, false) => fault("a name of its own"),
        (true, true) => Ok(()),
    }
}

/// Gives the wanted scenes their samples; tells of every sample which scene it belongs to.
fn read_samples(
    folder: &Path,
    scene_of: &SceneOf,
    scenes: &mut [SceneRows],
) -> Result<SceneOf, Fault> {
    let mut scene_of_sample = SceneOf::new();
    let mut repeated = None;
    read_table::<Sample>(
        folder,
        |_| Ok(true),
        |row| {
            let _ = (&row, &mut repeated, scene_of, &mut *scenes, &mut scene_of_sample);
            repeated = Some(());
        },
    )?;
    Ok(scene_of_sample)
}
