//! The sequences of a log, and the names of their files.

use std::collections::{BTreeMap, BTreeSet};
use std::io::ErrorKind;
use std::path::Path;

use occlabel_core::{Fault, SweepHeader};
use occlabel_disk as disk;

use super::LIDAR;
use crate::files::unreadable;

/// Folders of points, the preferred one first: moved to where the lidar was at the sweep's time; as the
/// lidar turned.
const POINTS: [&str; 2] = ["3d_comp", "3d_raw"];
/// The folder of points' labels.
const LABELS: &str = "3d_semantic";
/// The folder of boxes.
const BOXES: &str = "3d_bbox";

/// One sequence: a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Sequence {
    /// The name of its folders.
    pub(super) name: String,
    /// The folder of its points.
    points: &'static str,
}

impl Sequence {
    /// Whether its points were moved to where the lidar was at the sweep's time.
    pub(super) fn is_compensated(&self) -> bool {
        self.points == POINTS[0]
    }

    /// The points of a frame.
    pub(super) fn points(&self, frame: usize) -> String {
        self.file(self.points, frame, "bin")
    }

    /// The labels of a frame's points.
    fn labels(&self, frame: usize) -> String {
        self.file(LABELS, frame, "bin")
    }

    /// The boxes of a frame.
    pub(super) fn boxes(&self, frame: usize) -> String {
        self.file(BOXES, frame, "json")
    }

    /// The poses of its frames, a line each: those in the frame of all sequences, those in its own.
    pub(super) fn poses(&self) -> [String; 2] {
        ["dense_global", "dense"].map(|kind| format!("poses/{kind}/{}.txt", self.name))
    }

    /// The times of its frames, a line each, under their newer and their older name.
    pub(super) fn times(&self) -> [String; 2] {
        ["", "_frame_to_ts"].map(|ending| format!("timestamps/{}{ending}.txt", self.name))
    }

    /// A calibration: `cam0_intrinsics`, `os1_to_cam0`.
    pub(super) fn calibration(&self, of: &str) -> String {
        format!("calibrations/{}/calib_{of}.yaml", self.name)
    }

    /// The frames whose points are there.
    pub(super) fn frames(&self, root: &Path) -> Result<BTreeSet<usize>, Fault> {
        self.frames_of(root, self.points, "bin")
    }

    /// The frames whose points have labels.
    pub(super) fn labelled_frames(&self, root: &Path) -> Result<BTreeSet<usize>, Fault> {
        self.frames_of(root, LABELS, "bin")
    }

    /// The frames that have boxes.
    pub(super) fn boxed_frames(&self, root: &Path) -> Result<BTreeSet<usize>, Fault> {
        self.frames_of(root, BOXES, "json")
    }

    /// The images of a camera by frame, in a folder of images: `2d_raw`, `2d_rect`.
    ///
    /// # Errors
    /// If the folder is there and cannot be listed.
    pub(super) fn images(
        &self,
        root: &Path,
        kind: &str,
        camera: &str,
    ) -> Result<BTreeMap<usize, String>, Fault> {
        let endings = ["jpg", "png"].into_iter();
        let of = |ending| numbered(root, kind, camera, &self.name, ending);
        Ok(endings.map(of).collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
    }

    fn file(&self, kind: &str, frame: usize, ending: &str) -> String {
        file(kind, LIDAR, &self.name, frame, ending)
    }

    fn frames_of(&self, root: &Path, kind: &str, ending: &str) -> Result<BTreeSet<usize>, Fault> {
        Ok(numbered(root, kind, LIDAR, &self.name, ending)?.into_keys().collect())
    }
}

/// The file of a sweep's labels, and the sequence and frame that its id names.
pub(super) fn label_file(sweep: &SweepHeader) -> Option<String> {
    let (name, frame) = sweep.source_id.rsplit_once('/')?;
    let sequence = Sequence { name: name.to_owned(), points: POINTS[0] };
    Some(sequence.labels(frame.parse().ok()?))
}

/// The sequences below a folder, those of numbers in order of these.
///
/// # Errors
/// If there is none, or a folder of points cannot be listed.
pub(super) fn sequences(root: &Path) -> Result<Vec<Sequence>, Fault> {
    let mut found: BTreeMap<(usize, String), &'static str> = BTreeMap::new();
    for points in POINTS {
        let folder = format!("{points}/{LIDAR}/");
        for name in names(root, &folder)? {
            if disk::is_dir(&root.join(&folder).join(&name)) {
                found.entry((name.len(), name)).or_insert(points);
            }
        }
    }
    if found.is_empty() {
        let expected = "folders 3d_comp/os1/<sequence> or 3d_raw/os1/<sequence>";
        return Err(Fault::new("coda-layout", root.display().to_string(), expected, "none"));
    }
    Ok(found.into_iter().map(|((_, name), points)| Sequence { name, points }).collect())
}

/// The first of some files that is there.
///
/// # Errors
/// If none is.
pub(super) fn first_present(root: &Path, files: &[String]) -> Result<String, Fault> {
    let present = files.iter().find(|file| disk::is_file(&root.join(file)));
    let absent = || Fault::new("missing-file", files.join(", "), "one of these files", "none");
    present.cloned().ok_or_else(absent)
}

fn file(kind: &str, sensor: &str, sequence: &str, frame: usize, ending: &str) -> String {
    format!("{kind}/{sensor}/{sequence}/{kind}_{sensor}_{sequence}_{frame}.{ending}")
}

/// The files of a kind by frame.
fn numbered(
    root: &Path,
    kind: &str,
    sensor: &str,
    sequence: &str,
    ending: &str,
) -> Result<BTreeMap<usize, String>, Fault> {
    let folder = format!("{kind}/{sensor}/{sequence}/");
    let frame = |name: String| {
        let frame = name.strip_suffix(ending)?.strip_suffix('.')?.rsplit('_').next()?;
        let (frame, path) = (frame.parse().ok()?, format!("{folder}{name}"));
        (file(kind, sensor, sequence, frame, ending) == path).then_some((frame, path))
    };
    Ok(names(root, &folder)?.into_iter().filter_map(frame).collect())
}

/// The names in a folder; none if it is absent. One that is no UTF-8 is left out.
fn names(root: &Path, folder: &str) -> Result<Vec<String>, Fault> {
    let listed = match disk::list(&root.join(folder)) {
        Ok(listed) => listed,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(unreadable(folder, &error)),
    };
    Ok(listed.into_iter().filter_map(|entry| entry.file_name().into_string().ok()).collect())
}
