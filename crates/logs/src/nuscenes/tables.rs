//! The tables of a version folder, as far as the wanted scenes need them.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::path::Path;

use occlabel_core::Fault;

use super::label_files::{LabelFiles, read_label_files};
use super::rows::{
    CalibratedSensor, Category, EgoPose, Instance, Sample, SampleAnnotation, SampleData, SceneRow,
    Sensor,
};
use super::table::{Head, Row, Table, dangling, read_keyed, read_table, repeated};
use super::token::Token;
use crate::files::is_folder_name;
use crate::names::{nearest_names, quoted};

/// The rows that belong to one scene.
#[derive(Debug)]
pub(super) struct SceneRows {
    /// The scene's name.
    pub(super) name: String,
    /// Why the name cannot be that of a folder, if so.
    pub(super) name_fault: Option<Fault>,
    /// Its annotated moments.
    pub(super) samples: Vec<Row<Sample>>,
    /// Its sweeps and images.
    pub(super) captures: Vec<Row<SampleData>>,
    /// Its boxes.
    pub(super) annotations: Vec<Row<SampleAnnotation>>,
}

impl SceneRows {
    fn named(name: &str, name_fault: Option<Fault>) -> Self {
        let (samples, captures, annotations) = (Vec::new(), Vec::new(), Vec::new());
        Self { name: name.to_owned(), name_fault, samples, captures, annotations }
    }
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

    /// The name of the scene that a sweep belongs to.
    pub(super) fn scene_of(&self, sweep: &Token) -> Option<&str> {
        let holds = |scene: &&SceneRows| scene.captures.iter().any(|row| row.token == *sweep);
        self.scenes.iter().find(holds).map(|scene| scene.name.as_str())
    }
}

fn read_scenes(
    folder: &Path,
    wanted: Option<&BTreeSet<String>>,
) -> Result<(Vec<SceneRows>, SceneOf), Fault> {
    let mut rows: Vec<Row<SceneRow>> = Vec::new();
    read_table(
        folder,
        |_| Ok(true),
        |row| {
            rows.push(row);
            Ok(())
        },
    )?;
    check_wanted(&rows, wanted)?;
    let is_wanted = |name: &String| wanted.is_none_or(|wanted| wanted.contains(name));
    let (mut scenes, mut scene_of, mut names) = (Vec::new(), SceneOf::new(), HashSet::new());
    for row in rows {
        let place = is_wanted(&row.name).then_some(scenes.len());
        if place.is_some() {
            if !names.insert(row.name.clone()) {
                return Err(name_fault(&row, "a name of its own"));
            }
            let name_fault = (!is_folder_name(&row.name)).then(|| name_fault(&row, PLAIN_NAME));
            scenes.push(SceneRows::named(&row.name, name_fault));
        }
        if scene_of.insert(row.token.clone(), place).is_some() {
            return Err(row.located(repeated::<SceneRow>()));
        }
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

/// What the name of an output folder is made of.
const PLAIN_NAME: &str = "a name of A-Z, a-z, 0-9, `.`, `_` and `-`, the first no dot";

fn name_fault(row: &Row<SceneRow>, expected: &str) -> Fault {
    row.fault("scene-name", expected, format!("`{}`", row.name))
}

/// Gives the wanted scenes their samples; tells of every sample which scene it belongs to.
fn read_samples(
    folder: &Path,
    scene_of: &SceneOf,
    scenes: &mut [SceneRows],
) -> Result<SceneOf, Fault> {
    let mut scene_of_sample = SceneOf::new();
    let wanted = |head: &Head| {
        let scene = place::<Sample, SceneRow>(scene_of, head.scene_token.as_ref())?;
        match scene_of_sample.insert(head.token.clone(), scene) {
            Some(_) => Err(repeated::<Sample>()),
            None => Ok(scene.is_some()),
        }
    };
    read_table(folder, wanted, |row: Row<Sample>| {
        if let Some(&Some(scene)) = scene_of.get(&row.scene_token) {
            scenes[scene].samples.push(row);
        }
        Ok(())
    })?;
    Ok(scene_of_sample)
}

/// Gives the wanted scenes their sweeps and images, but nothing of the `unused` calibrations.
fn read_captures(
    folder: &Path,
    scene_of: &SceneOf,
    unused: &HashSet<Token>,
    scenes: &mut [SceneRows],
) -> Result<(), Fault> {
    let is_used = |head: &Head| {
        head.calibrated_sensor_token.as_ref().is_none_or(|token| !unused.contains(token))
    };
    let wanted = |head: &Head| {
        let scene = place::<SampleData, Sample>(scene_of, head.sample_token.as_ref())?;
        Ok(scene.is_some() && is_used(head))
    };
    read_table(folder, wanted, |row: Row<SampleData>| {
        if let Some(&Some(scene)) = scene_of.get(&row.sample_token) {
            scenes[scene].captures.push(row);
        }
        Ok(())
    })
}

/// Gives the wanted scenes their boxes.
fn read_annotations(
    folder: &Path,
    scene_of: &SceneOf,
    scenes: &mut [SceneRows],
) -> Result<(), Fault> {
    let wanted = |head: &Head| {
        let scene = place::<SampleAnnotation, Sample>(scene_of, head.sample_token.as_ref())?;
        Ok(scene.is_some())
    };
    read_table(folder, wanted, |row: Row<SampleAnnotation>| {
        if let Some(&Some(scene)) = scene_of.get(&row.sample_token) {
            scenes[scene].annotations.push(row);
        }
        Ok(())
    })
}

/// The scene that a row of table `T` belongs to by the row of table `U` that it names.
fn place<T: Table, U: Table>(
    scene_of: &SceneOf,
    token: Option<&Token>,
) -> Result<Option<usize>, Fault> {
    let named = |token| scene_of.get(token).copied().ok_or_else(|| dangling::<T, U>(token));
    match token {
        Some(token) => named(token),
        None => Err(Fault::new("table-record", T::FILE, format!("a token of {}", U::FILE), "none")),
    }
}

/// Calibrations of sensors that are neither lidars nor cameras.
fn other_sensors(
    sensors: &HashMap<Token, Row<Sensor>>,
    calibrations: &HashMap<Token, Row<CalibratedSensor>>,
) -> HashSet<Token> {
    let is_other = |calibration: &&Row<CalibratedSensor>| {
        let sensor = sensors.get(&calibration.sensor_token);
        sensor.is_some_and(|sensor| !matches!(sensor.modality.as_str(), "lidar" | "camera"))
    };
    #[expect(clippy::disallowed_methods, reason = "a set comes of it")]
    let calibrations = calibrations.values();
    calibrations.filter(is_other).map(|row| row.token.clone()).collect()
}

/// The ego poses that sweeps and images of the wanted scenes name.
fn read_poses(folder: &Path, scenes: &[SceneRows]) -> Result<HashMap<Token, Row<EgoPose>>, Fault> {
    let captures = scenes.iter().flat_map(|scene| &scene.captures);
    let named: HashSet<&Token> = captures.map(|capture| &capture.ego_pose_token).collect();
    read_keyed(folder, |token| named.contains(token))
}

/// The tracks that boxes of the wanted scenes name.
fn read_instances(
    folder: &Path,
    scenes: &[SceneRows],
) -> Result<HashMap<Token, Row<Instance>>, Fault> {
    let annotations = scenes.iter().flat_map(|scene| &scene.annotations);
    let named: HashSet<&Token> = annotations.map(|boxed| &boxed.instance_token).collect();
    read_keyed(folder, |token| named.contains(token))
}
