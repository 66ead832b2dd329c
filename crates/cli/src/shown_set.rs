//! A folder of labels, as it is shown.

use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use occlabel_core::{ColorSet, Fault, Palette, Pose, Timestamp};
use occlabel_dialects::{KeyframeKey, LabelSet, Wanted};
use occlabel_disk as disk;
use occlabel_labels::{Manifest, PoseRecord, SceneRecord, read_evidence};
use occlabel_view::{ShownEvidence, ShownKeyframe, ShownScene, ShownTrack};

/// Labels in any dialect, with what their manifest tells, if they have one.
pub(crate) struct ShownSet {
    pub(crate) set: LabelSet,
    pub(crate) manifest: Option<Manifest>,
    folder: PathBuf,
    colors: ColorSet,
}

impl ShownSet {
    /// Opens a folder, in the dialect that it is said to be in or that it tells.
    ///
    /// # Errors
    /// If there are no labels, or of no one dialect.
    pub(crate) fn open(folder: &Path, dialect: Option<&str>) -> Result<Self, Fault> {
        if disk::is_file(folder) {
            let place = folder.display().to_string();
            let fault = Fault::new("label-set", place, "a folder of labels", "a file");
            return Err(fault.hint("give the folder that it belongs to"));
        }
        let set = LabelSet::open(folder, dialect).map_err(|fault| with_run(fault, folder))?;
        let manifest = Manifest::load_tree(folder)?;
        Ok(Self { set, manifest, folder: folder.to_owned(), colors: ColorSet::Standard })
    }

    /// The same in other colours.
    pub(crate) fn colored(self, colors: ColorSet) -> Self {
        Self { colors, ..self }
    }

    /// The scenes by name.
    pub(crate) fn scene_names(&self) -> Vec<&str> {
        let mut names: Vec<_> = self.set.keyframes().iter().map(|key| key.scene.as_str()).collect();
        names.dedup();
        names
    }

    /// A scene by its name, or the first one.
    ///
    /// # Errors
    /// If there is none of this name.
    pub(crate) fn scene(&self, name: Option<&str>) -> Result<ShownScene, Fault> {
        let names = self.scene_names();
        let name = match name {
            None => names.first().copied().unwrap_or_default(),
            Some(name) if names.contains(&name) => name,
            Some(name) => return Err(self.unknown("scene", &names, name)),
        };
        let record = self.record(name);
        Ok(ShownScene {
            name: name.to_owned(),
            frame: self.set.frame().to_owned(),
            palette: Palette::with(&self.set.classes().names(), self.colors),
            free: self.set.classes().free_index(),
            cameras: record.map_or_else(Vec::new, |record| record.cameras.clone()),
            tracks: record.map_or_else(Vec::new, tracks),
        })
    }

    /// The keyframes of a scene in order of time, as far as the manifest or their tokens tell it, or
    /// these of them.
    ///
    /// # Errors
    /// If the scene does not have one of them, or has none at all.
    pub(crate) fn keyframes(
        &self,
        scene: &str,
        tokens: &[String],
    ) -> Result<Vec<KeyframeKey>, Fault> {
        let of_scene = self.set.keyframes().iter().filter(|key| key.scene == scene);
        let mut keys: Vec<_> = of_scene.cloned().collect();
        let number = |key: &KeyframeKey| key.token.rsplit(['-', '_']).next()?.parse::<u64>().ok();
        keys.sort_by_key(|key| (self.pose(key).map(|pose| pose.time_ns), number(key)));
        let has = |token: &&String| keys.iter().any(|key| &key.token == *token);
        if let Some(absent) = tokens.iter().find(|token| !has(token)) {
            let names: Vec<_> = keys.iter().map(|key| key.token.as_str()).collect();
            return Err(self.unknown("keyframe", &names, absent));
        }
        keys.retain(|key| tokens.is_empty() || tokens.contains(&key.token));
        if keys.is_empty() {
            let place = self.folder.display().to_string();
            return Err(Fault::new("no-keyframes", place, "labelled keyframes", "none"));
        }
        Ok(keys)
    }

    /// The keyframe of a scene that is shown where one is: the named one, or that in the middle.
    ///
    /// # Errors
    /// As for [`ShownSet::keyframes`], or if several are named.
    pub(crate) fn keyframe(&self, scene: &str, tokens: &[String]) -> Result<KeyframeKey, Fault> {
        if tokens.len() > 1 {
            let found = format!("{} of them", tokens.len());
            return Err(Fault::new("keyframes", "--keyframes", "one keyframe", found));
        }
        let keys = self.keyframes(scene, tokens)?;
        Ok(keys[keys.len() / 2].clone())
    }

    /// When a keyframe was, if the manifest tells.
    pub(crate) fn time(&self, key: &KeyframeKey) -> Option<Timestamp> {
        self.pose(key).map(PoseRecord::time)
    }

    /// All that the files tell of a keyframe.
    ///
    /// # Errors
    /// If a file cannot be read, or holds what the dialect does not know.
    pub(crate) fn read(&self, key: &KeyframeKey) -> Result<ShownKeyframe, Fault> {
        let wanted = Wanted { instances: true, flow: true, extras: false };
        let labels = self.set.read_with(key, &wanted)?;
        let pose = self.pose(key);
        Ok(ShownKeyframe {
            token: key.token.clone(),
            time: self.time(key),
            world_from_grid: pose.map(|pose| pose.world_from_grid(self.in_lidar_frame())),
            heading_rad: self.heading_rad(pose),
            evidence: self.evidence(key)?,
            spec: labels.spec,
            semantics: labels.semantics,
            mask_lidar: labels.mask_lidar,
            mask_camera: labels.mask_camera,
            instances: labels.instances,
            flow: labels.flow,
        })
    }

    fn evidence(&self, key: &KeyframeKey) -> Result<Option<ShownEvidence>, Fault> {
        if !self.set.has_evidence(key) {
            return Ok(None);
        }
        let read = read_evidence(&self.set.evidence(key), self.set.spec())?;
        let (hits, crossings, camera_bits) = (read.hits, read.crossings, read.camera_bits);
        Ok(Some(ShownEvidence { hits, crossings, camera_bits }))
    }

    fn record(&self, scene: &str) -> Option<&SceneRecord> {
        self.manifest.as_ref()?.scenes.get(scene)
    }

    fn pose(&self, key: &KeyframeKey) -> Option<&PoseRecord> {
        self.record(&key.scene)?.poses.iter().find(|pose| pose.token == key.token)
    }

    fn in_lidar_frame(&self) -> bool {
        self.set.frame() == "lidar"
    }

    /// Where the ego's forward points in the grid frame.
    fn heading_rad(&self, pose: Option<&PoseRecord>) -> Option<f64> {
        if !self.in_lidar_frame() {
            return Some(0.0);
        }
        let forward = Pose::from(&pose?.ego_from_lidar).inverse() * Vector3::x();
        Some(libm::atan2(forward.y, forward.x))
    }

    fn unknown(&self, what: &'static str, names: &[&str], found: &str) -> Fault {
        let some = names.iter().take(5).copied().collect::<Vec<_>>().join(", ");
        let rest =
            if names.len() > 5 { format!(", … ({} in all)", names.len()) } else { "".into() };
        let place = self.folder.display().to_string();
        Fault::new(what, place, format!("a {what} of {some}{rest}"), format!("`{found}`"))
    }
}

/// What is said of a folder that a run has begun to write, and has finished no keyframe in.
fn with_run(fault: Fault, folder: &Path) -> Fault {
    if !["dialect", "label-set"].contains(&fault.rule) || !disk::is_file(&folder.join("run.json")) {
        return fault;
    }
    let found = "a run that has finished none yet";
    Fault::new("no-keyframes", folder.display().to_string(), "labelled keyframes", found)
        .hint("the `label` command that began it goes on from there")
}

fn tracks(record: &SceneRecord) -> Vec<ShownTrack> {
    let shown = |track: &occlabel_labels::TrackRecord| ShownTrack {
        index: track.index,
        id: track.id.clone(),
        category: track.category.clone(),
    };
    record.tracks.iter().map(shown).collect()
}
