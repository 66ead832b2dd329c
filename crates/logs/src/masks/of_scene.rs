//! Which exposures of a scene have a mask.

use std::collections::BTreeSet;
use std::io::ErrorKind;
use std::path::Path;

use occlabel_core::{Exposure, Fault, Scene, Timestamp, nearest_exposure_within};
use occlabel_disk as disk;

use crate::files::{name_defect, unreadable};

/// How a mask's file ends, and that of the instances beside it.
const ENDING: &str = ".png";
const INSTANCES: &str = ".instances.png";

/// The time in a mask's name may be off by so much, seconds: some formats round times to microseconds
/// or keep them as seconds in floating point.
const WITHIN_S: f64 = 1e-3;

/// The mask of an exposure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MaskFile {
    /// Its path below the folder of masks.
    pub file: String,
    /// That of the instances beside it, if there is one.
    pub instances: Option<String>,
}

/// The masks of a scene.
#[derive(Clone, Debug, Default)]
pub struct SceneMasks {
    /// Of each camera the exposures that have a mask, in order of time, with their files.
    of_cameras: Vec<Vec<(Exposure, MaskFile)>>,
}

impl SceneMasks {
    /// Looks for the masks of all exposures.
    ///
    /// # Errors
    /// If a folder is there and cannot be listed.
    pub(super) fn find(folder: &Path, scene: &Scene) -> Result<Self, Fault> {
        let of_camera = |(camera, exposures): (usize, &Vec<Exposure>)| {
            let named = NamedByTime::list(folder, &scene.name, &scene.cameras[camera].name)?;
            let find = |exposure: &Exposure| {
                let mask = named.mask_at(exposure.time);
                Some((exposure.clone(), mask.or_else(|| named_as_image(folder, exposure))?))
            };
            Ok(exposures.iter().filter_map(find).collect())
        };
        let of_cameras = scene.exposures.iter().enumerate().map(of_camera);
        Ok(Self { of_cameras: of_cameras.collect::<Result<_, Fault>>()? })
    }

    /// Of each camera the exposures that have a mask, in order of time.
    pub fn exposures(&self) -> Vec<Vec<Exposure>> {
        let of_camera = |masks: &Vec<(Exposure, MaskFile)>| {
            masks.iter().map(|(exposure, _)| exposure.clone()).collect()
        };
        self.of_cameras.iter().map(of_camera).collect()
    }

    /// The mask of an exposure; none if it has none.
    pub fn mask_of(&self, exposure: &Exposure) -> Option<&MaskFile> {
        let of_camera = self.of_cameras.get(exposure.camera)?;
        of_camera.iter().find(|(known, _)| known.time == exposure.time).map(|(_, mask)| mask)
    }

    /// All files, relative to the folder of masks.
    pub fn files(&self) -> impl Iterator<Item = &String> {
        let masks = self.of_cameras.iter().flatten().map(|(_, mask)| mask);
        masks.flat_map(|mask| [&mask.file].into_iter().chain(&mask.instances))
    }
}

/// The masks of a camera that are named by their times.
struct NamedByTime {
    /// Relative to the folder of masks, with a `/` at the end.
    place: String,
    /// In order; each with its file's stem.
    times: Vec<(Timestamp, String)>,
    names: BTreeSet<String>,
}

impl NamedByTime {
    fn list(folder: &Path, scene: &str, camera: &str) -> Result<Self, Fault> {
        let place = format!("{scene}/{camera}/");
        let entries = match name_defect(&place) {
            Some(_) => Vec::new(),
            None => match disk::list(&folder.join(&place)) {
                Err(error) if error.kind() == ErrorKind::NotFound => Vec::new(),
                listed => listed.map_err(|error| unreadable(&place, &error))?,
            },
        };
        let name = |entry: disk::Entry| Some(entry.path().file_name()?.to_str()?.to_owned());
        let names: BTreeSet<String> = entries.into_iter().filter_map(name).collect();
        let timed = |name: &String| {
            let stem = name.strip_suffix(ENDING)?;
            Some((Timestamp(stem.parse().ok()?), stem.to_owned()))
        };
        let mut times: Vec<_> = names.iter().filter_map(timed).collect();
        times.sort();
        Ok(Self { place, times, names })
    }

    fn mask_at(&self, time: Timestamp) -> Option<MaskFile> {
        let (_, stem) = nearest_exposure_within(&self.times, |(known, _)| *known, time, WITHIN_S)?;
        let beside = format!("{stem}{INSTANCES}");
        let instances = self.names.contains(&beside).then(|| format!("{}{beside}", self.place));
        Some(MaskFile { file: format!("{}{stem}{ENDING}", self.place), instances })
    }
}

/// The mask that is named as the image.
fn named_as_image(folder: &Path, exposure: &Exposure) -> Option<MaskFile> {
    let image = exposure.image.as_deref().filter(|image| name_defect(image).is_none())?;
    let stem = image.rsplit_once('.').map_or(image, |(stem, _)| stem);
    let below = stem.split_once('/').map(|(_, below)| below);
    let is_there = |file: &String| disk::is_file(&folder.join(file));
    let mask = |stem: &str| {
        let file = Some(format!("{stem}{ENDING}")).filter(is_there)?;
        let instances = Some(format!("{stem}{INSTANCES}")).filter(is_there);
        Some(MaskFile { file, instances })
    };
    mask(stem).or_else(|| mask(below?))
}
