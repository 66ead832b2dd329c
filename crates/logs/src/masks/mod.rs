//! Class masks beside the images of a log, whatever its format.
//!
//! Below the folder of masks, that of an exposure is `<scene>/<camera>/<time in ns>.png`, to the
//! millisecond; else, where the log has images as files, the image's own path with the ending `.png`,
//! else the same without its first folder. Beside it, `.instances.png` in place of `.png` may tell
//! instances apart.

mod of_scene;
mod picture;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use occlabel_core::{Camera, ClassId, ClassMask, Fault, MaskTable, Scene};
use occlabel_disk as disk;

pub use of_scene::{MaskFile, SceneMasks};
use picture::Picture;

use crate::files::read_file;

/// A folder of masks.
#[derive(Clone, Debug)]
pub struct Masks {
    folder: PathBuf,
    table: MaskTable,
    unknown_as: Option<ClassId>,
    borders_px: u32,
}

impl Masks {
    /// The masks below a folder, read by a table; `unknown_as` stands in for what the table does not
    /// name.
    ///
    /// # Errors
    /// If there is no such folder.
    pub fn open(
        folder: &Path,
        table: MaskTable,
        unknown_as: Option<ClassId>,
    ) -> Result<Self, Fault> {
        if !disk::is_dir(folder) {
            let place = folder.display().to_string();
            return Err(Fault::new("masks-folder", place, "a folder of masks", "none"));
        }
        Ok(Self { folder: folder.to_owned(), table, unknown_as, borders_px: 0 })
    }

    /// The same, but that pixels within so many of a border between classes show nothing.
    pub fn without_borders(self, borders_px: u32) -> Self {
        Self { borders_px, ..self }
    }

    /// Where the masks are.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The masks of a scene's exposures.
    ///
    /// # Errors
    /// If a folder cannot be listed.
    pub fn of_scene(&self, scene: &Scene) -> Result<SceneMasks, Fault> {
        SceneMasks::find(&self.folder, scene)
    }

    /// What a camera's pixels show by a mask. Instances are numbered on from the scene's `tracks`.
    ///
    /// # Errors
    /// If a file is no PNG of the camera's size, has pixels that the table does not name, or instances
    /// beyond 65535.
    pub fn read(
        &self,
        mask: &MaskFile,
        camera: &Camera,
        tracks: usize,
    ) -> Result<ClassMask, Fault> {
        let picture = self.picture(&mask.file, camera)?;
        let classes = self.classes(&mask.file, &picture)?;
        let classes = ClassMask::new(camera.width, camera.height, classes.into_iter());
        let classes = classes.without_borders(self.borders_px);
        let Some(beside) = &mask.instances else { return Ok(classes) };
        let numbers = self.picture(beside, camera)?.into_numbers().ok_or_else(|| {
            Fault::new("mask-format", beside, "a grey PNG of 8 or 16 bits", "colours")
        })?;
        let after_tracks = |number: &u16| match number {
            0 => Some(0),
            number => u16::try_from(tracks + usize::from(*number)).ok(),
        };
        let instances =
            numbers.iter().map(after_tracks).collect::<Option<_>>().ok_or_else(|| {
                let expected = format!("instances up to {}, after {tracks} tracks", 65535 - tracks);
                let largest = numbers.iter().max().map_or(0, |number| *number);
                Fault::new("mask-instance", beside, expected, largest.to_string())
            })?;
        Ok(classes.with_instances(instances))
    }

    fn picture(&self, file: &str, camera: &Camera) -> Result<Picture, Fault> {
        let bytes = read_file(&self.folder, file)?;
        let size = [camera.width, camera.height];
        Picture::decode(&bytes, size).map_err(|found| {
            let expected = format!("a PNG of {} x {} pixels", size[0], size[1]);
            Fault::new("mask-format", file, expected, found)
        })
    }

    /// The class of each pixel.
    fn classes(&self, file: &str, picture: &Picture) -> Result<Vec<Option<ClassId>>, Fault> {
        let mut unknown: BTreeMap<String, u64> = BTreeMap::new();
        let mut stand_in = |name: String, pixels: usize| {
            *unknown.entry(name).or_default() += pixels as u64;
            self.unknown_as
        };
        let classes = match picture {
            Picture::Numbers(numbers) => by_runs(numbers, |id, pixels| {
                let known = self.table.ids.get(id).copied();
                known.unwrap_or_else(|| stand_in(id.to_string(), pixels))
            }),
            Picture::Colours(colours) => by_runs(colours, |colour, pixels| {
                let known = self.table.colours.get(colour).copied();
                known.unwrap_or_else(|| stand_in(hexadecimal(colour), pixels))
            }),
        };
        if unknown.is_empty() || self.unknown_as.is_some() {
            return Ok(classes);
        }
        let found: Vec<_> =
            unknown.iter().map(|(name, n)| format!("{name} of {n} pixels")).collect();
        let expected = "ids or colours that `paint.classes` names";
        let fault = Fault::new("unknown-label", file, expected, found.join(", "));
        Err(fault.hint("`--unknown-as CLASS` gives them a class"))
    }
}

/// The class of each pixel, asked once for each run of equal ones.
fn by_runs<P: PartialEq>(
    pixels: &[P],
    mut class: impl FnMut(&P, usize) -> Option<ClassId>,
) -> Vec<Option<ClassId>> {
    let mut classes = Vec::with_capacity(pixels.len());
    for run in pixels.chunk_by(|a, b| a == b) {
        classes.resize(classes.len() + run.len(), class(&run[0], run.len()));
    }
    classes
}

fn hexadecimal([red, green, blue]: &[u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}
