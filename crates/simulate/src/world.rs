//! A world: everything that is true about a drive.

use std::collections::BTreeSet;
use std::sync::Arc;

use nalgebra::Point3;
use occlabel_core::{Fault, Pose, Timestamp};
use toml::Table;

use crate::annotator::Annotator;
use crate::bodies::Bodies;
use crate::camera::WorldCamera;
use crate::check::{each, in_file, inside, need, within};
use crate::ego::Ego;
use crate::ground::Ground;
use crate::instant::{Instant, What};
use crate::lidar::Lidar;
use crate::model::with_models;
use crate::mover::Mover;
use crate::reconstruction::Reconstruction;
use crate::shape::Shape;
use crate::standing::standing;
use crate::world_file::{WorldFile, ego_body};

/// A trailer's way is known so long beyond the drive's end, for sweeps that begin in it, seconds.
const BEYOND_S: f64 = 101.0;

/// A world, read from its file and checked: nothing in it can fail.
#[derive(Clone, Debug)]
pub struct World {
    /// The file that it is from, for faults.
    pub place: String,
    /// BLAKE3 of what the file says, in hexadecimal; comments and layout do not count.
    pub hash: String,
    /// Its name, fit for a file.
    pub name: String,
    /// How long the drive lasts from time zero, seconds.
    pub duration_s: f64,
    /// What noise and dropout are drawn from.
    pub seed: u64,
    /// The name of the taxonomy whose raw names it uses.
    pub taxonomy: String,
    /// How many keyframes a second has.
    pub keyframe_hz: f64,
    /// The ground.
    pub ground: Ground,
    /// The raw point label of each static shape.
    pub static_classes: Vec<String>,
    /// The annotated things in byte order of their names.
    pub movers: Vec<Mover>,
    /// The recording vehicle.
    pub ego: Ego,
    /// The lidars in byte order of their names.
    pub lidars: Vec<Lidar>,
    /// The cameras in byte order of their names.
    pub cameras: Vec<WorldCamera>,
    /// What becomes of the drive on its way into a log.
    pub annotator: Annotator,
    /// How a cloud is made of what its cameras see.
    pub reconstruction: Reconstruction,
    pub(crate) standing: Bodies,
    pub(crate) ego_body: Option<(Arc<Shape>, Pose)>,
}

impl World {
    /// A world from the text of its file; `place` is the file's name, for faults.
    ///
    /// # Errors
    /// If the text is no TOML, a key is unknown or missing, or a value impossible: the fault's
    /// record is the key.
    pub fn parse(text: &str, place: &str) -> Result<Self, Fault> {
        let told = |fault| in_file(place, fault);
        let table = table(text).map_err(told)?;
        let hash = blake3::hash(table.to_string().as_bytes()).to_string();
        let world = read(table).and_then(build).map_err(told)?;
        Ok(Self { place: place.into(), hash, ..world })
    }

    /// The world at a time, seconds.
    pub fn at(&self, time_s: f64) -> Instant<'_> {
        Instant::new(self, time_s, |_| time_s)
    }

    /// The world at a time of its clock.
    pub fn at_time(&self, time: Timestamp) -> Instant<'_> {
        self.at(time.seconds_since(Timestamp(0)))
    }

    /// The ego's pose at a time, seconds.
    pub fn world_from_ego(&self, time_s: f64) -> Pose {
        self.ego.world_from_ego(time_s, &self.ground)
    }

    /// The raw point label of a part of the world.
    pub fn class_of(&self, what: What) -> &str {
        match what {
            What::Ground(at) => &self.ground.bands[at].class,
            What::Static(at) => &self.static_classes[at],
            What::Mover(at) => &self.movers[at].category,
            What::Ego => self.ego.body.as_ref().map_or("", |body| &body.class),
        }
    }

    /// Deviation of the noisiest lidar's ranges, metres.
    pub fn range_noise_m(&self) -> f64 {
        self.lidars.iter().map(|lidar| lidar.range_noise_m).fold(0.0, f64::max)
    }

    /// A lidar's place in the list; how many there are if it is none of them.
    pub(crate) fn lidar_number(&self, name: &str) -> usize {
        self.lidars.partition_point(|lidar| lidar.name.as_str() < name)
    }
}

fn table(text: &str) -> Result<Table, Fault> {
    text.parse()
        .map_err(|error: toml::de::Error| Fault::new("world", "the file", "TOML", error.message()))
}

fn read(table: Table) -> Result<WorldFile, Fault> {
    let table = with_models(table)?;
    serde_path_to_error::deserialize(table).map_err(|error| {
        let (expected, found) = told(error.inner().message());
        Fault::new("world", error.path().to_string(), expected, found)
    })
}

/// What a reader of TOML expected, as far as it says so, and what it found.
fn told(message: &str) -> (&str, &str) {
    match message.split_once(", expected ") {
        Some((found, expected)) if expected.starts_with("struct ") => ("a table", found),
        Some((found, expected)) => (expected, found),
        None => ("a world file's key and value", message),
    }
}

fn build(file: WorldFile) -> Result<World, Fault> {
    named("name", &file.name)?;
    within("duration_s", file.duration_s, 1e-3, 3600.0)?;
    within("keyframe_hz", file.keyframe_hz, 0.01, 1000.0)?;
    inside("ground", file.ground.check())?;
    inside("ego", file.ego.check())?;
    let (standing, static_classes) = standing(&file.statics, &file.ground)?;
    let world = World {
        place: String::new(),
        hash: String::new(),
        movers: movers(&file)?,
        lidars: lidars(&file)?,
        cameras: cameras(&file)?,
        standing,
        ego_body: inside("ego.body", ego_body(&file.ego))?,
        name: file.name,
        duration_s: file.duration_s,
        seed: file.seed,
        taxonomy: file.taxonomy,
        keyframe_hz: file.keyframe_hz,
        ground: file.ground,
        static_classes,
        ego: file.ego,
        annotator: file.annotator,
        reconstruction: file.reconstruction,
    };
    inside("annotator", world.annotator.check(&world.movers))?;
    inside("reconstruction", world.reconstruction.check())?;
    check_sight(&world).map(|()| world)
}

fn movers(file: &WorldFile) -> Result<Vec<Mover>, Fault> {
    let mut movers: Vec<Mover> = Vec::new();
    for (at, mover) in file.movers.iter().cloned().enumerate() {
        let key = format!("mover[{at}]");
        for copy in inside(&key, mover.copies())? {
            movers.push(inside(&key, copy.build(&movers, file.duration_s + BEYOND_S))?);
        }
    }
    let count = movers.len();
    need("mover", count <= usize::from(u16::MAX), "at most 65535", count)?;
    in_order("mover", movers, |mover| &mover.name)
}

fn lidars(file: &WorldFile) -> Result<Vec<Lidar>, Fault> {
    let lidars = each("lidar", file.lidars.iter().cloned(), |lidar| {
        begins_within(file.duration_s, lidar.offset_s).and_then(|()| Lidar::try_from(lidar))
    })?;
    need("lidar", !lidars.is_empty(), "at least one", 0)?;
    in_order("lidar", lidars, |lidar| &lidar.name)
}

fn cameras(file: &WorldFile) -> Result<Vec<WorldCamera>, Fault> {
    let cameras = each("camera", file.cameras.iter().cloned(), |camera| {
        begins_within(file.duration_s, camera.offset_s).and_then(|()| WorldCamera::try_from(camera))
    })?;
    need("camera", cameras.len() <= 16, "at most 16", cameras.len())?;
    in_order("camera", cameras, |camera| &camera.named.name)
}

/// Refuses a sensor that would never work during the drive.
fn begins_within(duration_s: f64, offset_s: f64) -> Result<(), Fault> {
    let expected = format!("less than the drive's duration_s, {duration_s}");
    need("offset_s", offset_s < duration_s, &expected, offset_s)
}

/// A list in byte order of names, each fit for a file and there once.
fn in_order<T>(
    list: &str,
    mut items: Vec<T>,
    name: impl Fn(&T) -> &String,
) -> Result<Vec<T>, Fault> {
    let mut known = BTreeSet::new();
    for (at, item) in items.iter().enumerate() {
        let key = format!("{list}[{at}].name");
        named(&key, name(item))?;
        need(&key, known.insert(name(item)), "a name of its own", name(item))?;
    }
    items.sort_by(|a, b| name(a).cmp(name(b)));
    Ok(items)
}

fn named(key: &str, name: &str) -> Result<(), Fault> {
    let fit = |c: char| c.is_ascii_alphanumeric() || "._-".contains(c);
    let fits = !name.is_empty() && !name.starts_with('.') && name.chars().all(fit);
    need(key, fits, "letters, digits, `.`, `_` and `-`", format!("`{name}`"))
}

/// Refuses a lidar that sits in the ego's own body.
fn check_sight(world: &World) -> Result<(), Fault> {
    let Some((shape, ego_from_body)) = &world.ego_body else { return Ok(()) };
    let body_from_ego = ego_from_body.inverse();
    let buried = |lidar: &&Lidar| {
        shape.contains(&(body_from_ego * (lidar.ego_from_lidar * Point3::origin())))
    };
    let found = world.lidars.iter().find(buried).map_or("", |lidar| &lidar.name);
    need("ego.body", found.is_empty(), "a body that holds no lidar", found)
}
