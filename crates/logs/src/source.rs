//! What a reader of any log format gives.

use occlabel_core::{Exposure, Fault, PointCloud, PointLabel, Scene, SweepHeader};

use crate::{ImageFile, UnknownLabels};

/// A log on disk, as a source of scenes.
pub trait SceneSource: Sync {
    /// The names of the wanted scenes, in the log's own order.
    fn scene_names(&self) -> Vec<String>;

    /// The files of tables that were read, relative to the log's root.
    fn tables(&self) -> Vec<String>;

    /// The files of a sweep, its points first, relative to the log's root.
    fn sweep_files(&self, sweep: &SweepHeader) -> Vec<String>;

    /// What a scene's file holds and how it is read, a line each, for people who have to tell the
    /// reader; nothing where the format leaves nothing open.
    ///
    /// # Errors
    /// If the file cannot be read.
    fn describe(&self, _scene: &str) -> Result<Vec<String>, Fault> {
        Ok(Vec::new())
    }

    /// The files of a scene's images, where a format has any that nothing else reads.
    fn image_files(&self, _scene: &str) -> Vec<ImageFile> {
        Vec::new()
    }

    /// The bytes of an exposure's image, JPEG or PNG as the log has it; `None` where the log does not
    /// have it.
    ///
    /// # Errors
    /// If it is there and cannot be read.
    fn read_image(&self, _scene: &Scene, _exposure: &Exposure) -> Result<Option<Vec<u8>>, Fault> {
        Ok(None)
    }

    /// Everything of a scene but its points.
    ///
    /// # Errors
    /// If the scene cannot be labelled at all. What costs less stands in `refused` of the scene.
    fn load(&self, scene: &str) -> Result<Scene, Fault>;

    /// How many points the sweeps of a scene hold, at most, without reading them all: counted where
    /// files tell, else estimated with room to spare. A sweep that cannot be looked at counts as
    /// empty: reading it will tell what is wrong.
    fn scene_points(&self, scene: &Scene) -> u64;

    /// The points of a sweep, in the frame of its lidar.
    ///
    /// # Errors
    /// If the sweep's points or labels cannot be read, or do not fit each other.
    fn read_sweep(&self, sweep: &SweepHeader) -> Result<SweepPoints, Fault>;

    /// What the format itself says where the configuration says `"auto"`.
    fn defaults(&self) -> ReaderDefaults;
}

/// The points of a sweep, and what was odd about them.
#[derive(Clone, Debug)]
pub struct SweepPoints {
    /// The points as logged: nothing dropped.
    pub cloud: PointCloud<PointLabel>,
    /// What is odd but can be lived with.
    pub warnings: Vec<Fault>,
    /// Raw labels that the taxonomy does not name, of which a warning tells.
    pub unknown: UnknownLabels,
}

impl SweepPoints {
    /// The same with every warning located.
    pub(crate) fn located(mut self, locate: impl Fn(Fault) -> Fault) -> Self {
        self.warnings = self.warnings.into_iter().map(locate).collect();
        self
    }
}

/// A format's own settings.
#[derive(Clone, Debug, PartialEq)]
pub struct ReaderDefaults {
    /// Lower and upper corner of the ego vehicle's body, ego frame, metres.
    pub ego_box_m: Option<([f64; 3], [f64; 3])>,
    /// The shipped taxonomy that fits.
    pub taxonomy: &'static str,
    /// The lidar that keyframes refer to.
    pub reference_lidar: String,
}
