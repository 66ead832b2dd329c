//! Known scenes, grids as text, a small log writer, and doors to knock at, for tests only.
//!
//! A label can only be judged against a world that is known. So this crate holds one: a plain
//! street of planes, boxes and cylinders, whose every ray has a closed-form answer, driven through
//! by a simulated car and written in the nuScenes format, so that tests and benchmarks read it
//! through the same door as a recorded drive. It shares no code with the crates it tests (not even
//! poses, or the step of a hash): what both sides got wrong together, no test would show. All of it is a function of the
//! [`LogSpec`] alone, with `libm` for the transcendentals, so the same bytes come out everywhere
//! and a written log can stand in the repository as a fixture.
//!
//! ```
//! use occlabel_testkit::{LogSpec, write_log};
//!
//! # fn main() -> std::io::Result<()> {
//! let directory = std::env::temp_dir().join(format!("occlabel-nano-{}", std::process::id()));
//! write_log(&directory, &LogSpec::nano())?;
//! assert!(directory.join("v1.0-mini/scene.json").exists());
//! std::fs::remove_dir_all(&directory)
//! # }
//! ```

mod categories;
mod corpus;
#[cfg(not(fuzzing))]
mod damage;
mod door;
mod drive;
mod grid_text;
mod lidar;
mod log_spec;
mod nuscenes_log;
mod path;
mod pose;
mod rig;
mod scene_rows;
mod shared_rows;
mod solid;
mod street;
mod table_set;
mod tables;
mod token;

pub use corpus::knock_with_corpus;
#[cfg(not(fuzzing))]
pub use damage::knock_with_damage;
pub use door::{Door, in_folder};
pub use grid_text::{assert_golden, draw};
pub use lidar::LidarPattern;
pub use log_spec::LogSpec;
pub use nuscenes_log::{VERSION, write_log};
