//! The four cameras of a log.

use occlabel_core::{Fault, Keyframe, Scene};
use occlabel_logs::SceneSource;

use crate::polarization::picture::Grey;

/// The numbers of the cameras behind polarizers at 0, 45, 90 and 135 degrees.
pub(crate) struct Cameras([usize; 4]);

/// The pictures of a keyframe.
pub(crate) enum Pictures {
    All(Vec<Grey>),
    /// A camera was not exposed there, or the log does not have its file.
    Absent,
}

impl Cameras {
    /// The cameras of these names.
    ///
    /// # Errors
    /// If these are not four different ones of the scene.
    pub(crate) fn of(scene: &Scene, names: &[String]) -> Result<Self, Fault> {
        let fault =
            |expected: String, found: String| Fault::new("cameras", "--cameras", expected, found);
        let number = |name: &String| {
            let known = scene.cameras.iter().position(|camera| camera.name == *name);
            known.ok_or_else(|| {
                let names: Vec<&str> =
                    scene.cameras.iter().map(|camera| &camera.name[..]).collect();
                let expected = format!("cameras of scene {}: {}", scene.name, names.join(", "));
                fault(expected, format!("`{name}`"))
            })
        };
        let numbers: Vec<usize> = names.iter().map(number).collect::<Result<_, _>>()?;
        let four = || fault("four different cameras".into(), names.join(", "));
        let numbers = <[usize; 4]>::try_from(numbers).map_err(|_| four())?;
        let is_new = |at: usize| !numbers[..at].contains(&numbers[at]);
        (0..4).all(is_new).then_some(Self(numbers)).ok_or_else(four)
    }

    /// The pictures of a keyframe.
    ///
    /// # Errors
    /// If one is there and cannot be read, or is no grey picture.
    pub(crate) fn read(
        &self,
        source: &dyn SceneSource,
        scene: &Scene,
        keyframe: &Keyframe,
    ) -> Result<Pictures, Fault> {
        let mut pictures = Vec::new();
        for camera in self.0 {
            let exposure = keyframe.exposures.iter().find(|exposure| exposure.camera == camera);
            let Some(exposure) = exposure else { return Ok(Pictures::Absent) };
            let Some(bytes) = source.read_image(scene, exposure)? else {
                return Ok(Pictures::Absent);
            };
            let place = exposure.image.as_deref().unwrap_or(&scene.cameras[camera].name);
            pictures.push(Grey::decode(&bytes, place)?);
        }
        Ok(Pictures::All(pictures))
    }
}
