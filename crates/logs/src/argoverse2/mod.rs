//! Sensor logs of Argoverse 2, which are Feather files.
//!
//! docs/argoverse2.md names every file that is read.

#[cfg(feature = "av2")]
mod cameras;
#[cfg(all(feature = "av2", any(test, fuzzing)))]
pub(crate) mod doors;
#[cfg(feature = "av2")]
mod feather;
#[cfg(feature = "av2")]
mod lidars;
#[cfg(feature = "av2")]
mod log;
#[cfg(feature = "av2")]
mod poses;
#[cfg(feature = "av2")]
mod scene;
#[cfg(feature = "av2")]
mod table;
#[cfg(feature = "av2")]
mod times;
#[cfg(feature = "av2")]
mod tracks;
#[cfg(not(feature = "av2"))]
mod without;

#[cfg(feature = "av2")]
pub use log::Argoverse2Log;
#[cfg(not(feature = "av2"))]
pub use without::Argoverse2Log;

/// The ego poses of a log, without which it is none.
pub(crate) const POSES: &str = "city_SE3_egovehicle.feather";
/// Logs lie so deep at most: `sensor/val/<log>`.
pub(crate) const DEPTH: usize = 3;
/// The name of the two lidars, whose points stand in one cloud.
const LIDAR: &str = "lidar";

/// What the format itself says where the configuration says `"auto"`.
fn format_defaults() -> crate::ReaderDefaults {
    crate::ReaderDefaults {
        ego_box_m: None,
        taxonomy: "argoverse2",
        reference_lidar: LIDAR.to_owned(),
    }
}
