//! The dialects that ship with the program.

macro_rules! shipped {
    ($($name:literal)*) => {
        &[$(($name, include_str!(concat!("../../../configs/dialects/", $name, ".toml")))),*]
    };
}

/// The text of each dialect's file by its name.
pub(crate) const SHIPPED: &[(&str, &str)] = shipped!(
    "occ3d-nuscenes" "occ3d-nuscenes-submission" "occ3d-waymo" "occ3d-waymo-fine" "surroundocc"
    "openoccupancy" "openocc-v2" "lightwheelocc" "openscene" "semantickitti"
    "semantickitti-predictions" "sscbench-kitti360" "sscbench-waymo" "uniocc"
);
