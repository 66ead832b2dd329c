//! Logs in SemanticKITTI's layout, labelled by the program.

mod support;

use std::path::{Path, PathBuf};

use support::{labelled_drive, read_arrays};

/// Keyframes of the nuScenes log, and the scans that are the same sweeps; nanoseconds.
const KEYFRAMES: [u64; 5] = [0, 500_000_000, 1_000_000_000, 1_500_000_000, 2_000_000_000];

/// A street without movers and cameras, and without the ego's body: the format knows no such box.
const WORLD: &str = r#"
name = "still"
duration_s = 2.1
seed = 1
taxonomy = "occ3d-nuscenes"
keyframe_hz = 2.0

[ground]
bands = [
    { until_y_m = -5.6, class = "flat.sidewalk", raise_m = 0.12 },
    { until_y_m = 5.6, class = "flat.driveable_surface" },
    { class = "flat.terrain", raise_m = 0.12 },
]

[ego]
trajectory.turn = { start = { x_m = 0.1, y_m = -1.61 }, speed_mps = 6.0, begin_s = 0.4, duration_s = 1.5, yaw_rate_rad_s = 0.3 }
roll_rad = { amplitude = 0.006, period_s = 1.7 }
pitch_rad = { amplitude = 0.008, period_s = 1.3 }

[[lidar]]
name = "LIDAR_TOP"
mounting.position_m = [0.9, 0.0, 1.84]
rate_hz = 10.0
max_range_m = 50.0
[lidar.pattern.spinning]
azimuths = 360
beams.even = { count = 16, min_rad = -0.42, max_rad = 0.15 }

[[static]]
class = "static.manmade"
pose = { position_m = [10.0, 9.0, 2.0] }
shape.box.size_m = [30.0, 1.0, 4.0]

[[static]]
class = "static.vegetation"
pose = { position_m = [12.0, -6.5, 2.0] }
shape.cylinder = { radius_m = 0.4, height_m = 4.0 }
"#;

fn labelled(folder: &Path, format: &str) -> PathBuf {
    labelled_drive(folder, WORLD, [format; 2], "semantickitti")
}

/// Voxels that are the same in both lists, and voxels.
fn same<T: PartialEq>(a: &[T], b: &[T]) -> (usize, usize) {
    assert_eq!(a.len(), b.len());
    (a.iter().zip(b).filter(|(a, b)| a == b).count(), a.len())
}

#[test]
fn a_still_drive_gets_the_labels_that_it_gets_as_nuscenes() {
    let folder = tempfile::tempdir().expect("a folder");
    let kitti = labelled(folder.path(), "semantickitti");
    let nuscenes = labelled(folder.path(), "nuscenes");
    let (mut agreed, mut voxels, mut occupied) = (0, 0, 0);
    for time in KEYFRAMES {
        let ours = read_arrays(&kitti, "00", &time.to_string()).labels;
        let theirs = read_arrays(&nuscenes, "still", &format!("still-{time}")).labels;
        let semantics = same(ours.semantics.values(), theirs.semantics.values());
        let mask = same(ours.mask_lidar.values(), theirs.mask_lidar.values());
        agreed += semantics.0 + mask.0;
        voxels += semantics.1 + mask.1;
        occupied += ours.semantics.values().iter().filter(|&&class| class != 20).count();
    }
    let share = agreed as f64 / voxels as f64;
    assert!(share >= 0.999 && occupied > 1000, "{agreed} of {voxels}, {occupied} occupied");
}
