//! Reading the masks of a scene's exposures, each once while it is wanted.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex};

use occlabel_core::{ClassMask, Exposure, Fault, Scene, Timestamp};
use occlabel_logs::{Masks, SceneMasks};
use occlabel_pipeline::MaskedExposures;

use crate::interrupt::Interrupt;

/// So many masks are kept for the next sweeps: neighbours are painted by the same ones.
const KEPT: usize = 32;

/// An exposure, by its camera and time.
type Key = (usize, Timestamp);

/// Reads masks, from any thread.
pub(crate) struct MaskReader<'a> {
    masks: &'a Masks,
    scene: &'a Scene,
    of_scene: SceneMasks,
    /// How many numbers tracks, and bodies known by their meshes, have: instances come after them.
    numbered: usize,
    /// Whether a mask that cannot be read is left out.
    skips: bool,
    /// Whether the scene will not be labelled any more.
    interrupt: Option<&'a Interrupt>,
    kept: Mutex<VecDeque<(Key, Arc<ClassMask>)>>,
    lost: Mutex<BTreeMap<Key, Fault>>,
}

impl<'a> MaskReader<'a> {
    /// A reader of the masks of a scene; none if there is no folder of masks.
    ///
    /// # Errors
    /// If a folder cannot be listed.
    pub(crate) fn new(masks: Option<&'a Masks>, scene: &'a Scene) -> Result<Option<Self>, Fault> {
        let Some(masks) = masks else { return Ok(None) };
        let of_scene = masks.of_scene(scene)?;
        let (numbered, skips, interrupt) = (scene.tracks.len(), false, None);
        let (kept, lost) = Default::default();
        Ok(Some(Self { masks, scene, of_scene, numbered, skips, interrupt, kept, lost }))
    }

    /// The same for a scene in which so many numbers are taken.
    pub(crate) fn after(self, numbered: usize) -> Self {
        Self { numbered, ..self }
    }

    /// The same for a run that may leave out masks that cannot be read, and may be interrupted.
    pub(crate) fn of_run(self, skips: bool, interrupt: &'a Interrupt) -> Self {
        Self { skips, interrupt: Some(interrupt), ..self }
    }

    /// The exposures that have a mask.
    pub(crate) fn exposures(&self) -> MaskedExposures<'_, Fault> {
        let exposures = self.of_scene.exposures();
        MaskedExposures { exposures, read: Box::new(|exposure| self.read(exposure)) }
    }

    fn read(&self, exposure: &Exposure) -> Result<Option<Arc<ClassMask>>, Fault> {
        let key = (exposure.camera, exposure.time);
        if self.interrupt.is_some_and(Interrupt::is_raised) {
            return Ok(None);
        }
        if let Some(mask) = self.find(key) {
            return Ok(Some(mask));
        }
        let Some(file) = self.of_scene.mask_of(exposure) else { return Ok(None) };
        let camera = &self.scene.cameras[exposure.camera];
        match self.masks.read(file, &camera.camera, self.numbered) {
            Ok(mask) => Ok(Some(self.keep(key, mask))),
            Err(fault) if self.skips => {
                self.lost.lock().expect("no reader panicked").insert(key, fault);
                Ok(None)
            }
            Err(fault) => Err(fault),
        }
    }

    fn find(&self, key: Key) -> Option<Arc<ClassMask>> {
        let kept = self.kept.lock().expect("no reader panicked");
        kept.iter().find(|(known, _)| *known == key).map(|(_, mask)| mask.clone())
    }

    fn keep(&self, key: Key, mask: ClassMask) -> Arc<ClassMask> {
        let mut kept = self.kept.lock().expect("no reader panicked");
        if kept.len() == KEPT {
            kept.pop_front();
        }
        let mask = Arc::new(mask);
        kept.push_back((key, mask.clone()));
        mask
    }

    /// The masks that were left out, and why, in order of cameras and times.
    pub(crate) fn lost(self) -> Vec<Fault> {
        self.lost.into_inner().expect("no reader panicked").into_values().collect()
    }
}
