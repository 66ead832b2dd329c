//! A scene from its folder: the reader's conductor.

use std::path::Path;

use occlabel_core::{
    BoxTrack, Fault, Loss, PointsOf, Pose, Scene, SweepHeader, Timestamp, TrackId,
};
use occlabel_disk as disk;

use super::cameras::read_cameras;
use super::classes::Classes;
use super::columns::Column;
use super::folders::Folder;
use super::point_file::PointFile;
use super::poses::{A_POSE, pose};
use super::tracks::{SceneTracks, id_of};
use super::{OBJECTS, POSES, WORLD};
use crate::ReadOptions;
use crate::files::is_folder_name;
use crate::keyframes::keyframes;
use crate::notes::Notes;
use crate::number_rows::read_lines;

/// A scene, and what reading its points takes.
#[derive(Debug)]
pub(super) struct Loaded {
    pub(super) scene: Scene,
    pub(super) classes: Classes,
    /// By their numbers in files of points.
    pub(super) tracks: Vec<Option<TrackId>>,
}

impl Loaded {
    /// Reads everything of a scene but its points (labels.md section 2).
    ///
    /// # Errors
    /// If the folder's name cannot be that of an output folder, or a file that it cannot do without is
    /// absent or broken.
    pub(super) fn read(root: &Path, options: &ReadOptions, folder: &Folder) -> Result<Self, Fault> {
        let name = &folder.name;
        if !is_folder_name(name) {
            let expected = "a folder's name of A-Z, a-z, 0-9, `.`, `_` and `-`";
            return Err(Fault::new("scene-name", name, expected, format!("`{name}`")));
        }
        let mut notes = Notes::default();
        let parts = Parts { root, folder };
        let poses = parts.poses(&mut notes)?;
        let classes = parts.classes()?;
        let SceneTracks { tracks, by_row } = parts.tracks(options, &mut notes)?;
        let (cameras, exposures) = match parts.has("cameras.json") {
            true => read_cameras(root, &folder.path, &poses, &mut notes)?,
            false => Default::default(),
        };
        let mut sweeps = parts.clouds(&poses, &tracks, classes.exist(), &mut notes)?;
        sweeps.extend(poses);
        sweeps.sort_by(|a, b| (a.time, &a.lidar, &a.file).cmp(&(b.time, &b.lidar, &b.file)));
        let keyframes =
            keyframes(&options.keyframes, name, &sweeps, |_| false, &exposures, &notes)?;
        let (warnings, refused) = notes.finish();
        let name = name.clone();
        let scene =
            Scene { name, sweeps, tracks, cameras, keyframes, exposures, warnings, refused };
        Ok(Self { scene, classes, tracks: by_row })
    }
}

/// A scene's folder.
struct Parts<'a> {
    root: &'a Path,
    folder: &'a Folder,
}

impl Parts<'_> {
    fn has(&self, name: &str) -> bool {
        disk::is_file(&self.root.join(self.folder.file(name)))
    }

    /// A sweep without points for each pose, in order of time. A line that is no pose is refused.
    fn poses(&self, notes: &mut Notes) -> Result<Vec<SweepHeader>, Fault> {
        let file = self.folder.file("poses.txt");
        let mut poses = Vec::new();
        for (number, line) in read_lines(self.root, &file)?.iter().enumerate() {
            let read = pose(line).map_err(|found| {
                Fault::new("scan-pose", &file, A_POSE, found).record(format!("line {}", number + 1))
            });
            if let Some(Some((time, world_from_ego))) = notes.accept(Loss::Keyframe, read) {
                let source_id = format!("{}/{}", self.folder.name, time.0);
                let pose = self.sweep(time, POSES, source_id, &file, PointsOf::Nothing);
                poses.push(SweepHeader { world_from_ego, ..pose });
            }
        }
        poses.sort_by_key(|pose| pose.time);
        Ok(poses)
    }

    fn classes(&self) -> Result<Classes, Fault> {
        match self.has("classes.json") {
            true => Classes::read(self.root, &self.folder.file("classes.json")),
            false => Ok(Classes::default()),
        }
    }

    fn tracks(&self, options: &ReadOptions, notes: &mut Notes) -> Result<SceneTracks, Fault> {
        match self.has("tracks.json") {
            true => SceneTracks::read(self.root, &self.folder.file("tracks.json"), options, notes),
            false => Ok(SceneTracks::default()),
        }
    }

    /// A sweep of the world's points, and one for each track and file that has points of it. They are of
    /// no time: the first pose's stands in.
    fn clouds(
        &self,
        poses: &[SweepHeader],
        tracks: &[BoxTrack],
        are_labelled: bool,
        notes: &mut Notes,
    ) -> Result<Vec<SweepHeader>, Fault> {
        let time = poses.first().map_or(Timestamp(0), |pose| pose.time);
        let file = self.folder.cloud(self.root)?;
        let cloud = |lidar, source_id: &str, file: &str, points_of| {
            let source_id = format!("{}/{source_id}", self.folder.name);
            let labelled = are_labelled && points_of == PointsOf::World;
            SweepHeader { labelled, ..self.sweep(time, lidar, source_id, file, points_of) }
        };
        let mut sweeps = vec![cloud(WORLD, WORLD, &file, PointsOf::World)];
        if PointFile::open(self.root, &file).is_ok_and(|points| points.has(Column::Track)) {
            sweeps.extend(tracks.iter().map(|track| {
                let name = format!("{WORLD}-{}", track.source_id);
                cloud(OBJECTS, &name, &file, PointsOf::Track(track.id))
            }));
        }
        for (name, file) in self.folder.objects(self.root)? {
            match id_of(tracks, &name) {
                Some(id) => sweeps.push(cloud(OBJECTS, &name, &file, PointsOf::Track(id))),
                None => {
                    let fault = Fault::new("object-track", &file, "a track of its name", "none");
                    notes.refuse(Loss::Sweep, fault);
                }
            }
        }
        Ok(sweeps)
    }

    fn sweep(
        &self,
        time: Timestamp,
        lidar: &str,
        source_id: String,
        file: &str,
        points_of: PointsOf,
    ) -> SweepHeader {
        SweepHeader {
            time,
            lidar: lidar.to_owned(),
            source_id,
            file: file.to_owned(),
            world_from_ego: Pose::identity(),
            ego_from_lidar: Pose::identity(),
            labelled: false,
            points_of,
        }
    }
}
