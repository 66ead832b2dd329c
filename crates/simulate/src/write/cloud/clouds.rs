//! The clouds of a drive: of what stands, and of each thing that has boxes.

use std::collections::BTreeMap;

use nalgebra::Point3;
use occlabel_core::{Fault, Pose, Timestamp};

use crate::reconstruction::exposure_cloud;
use crate::write::files::{Output, OutputFile};
use crate::write::raw_names::RawNames;
use crate::{Drive, What};

/// Points of a drive's reconstruction.
#[derive(Default)]
pub(super) struct Clouds {
    world: Cloud,
    /// By mover.
    objects: BTreeMap<usize, Cloud>,
}

/// Points as their file has them.
#[derive(Default)]
struct Cloud {
    points: usize,
    bytes: Vec<u8>,
}

impl Clouds {
    /// What the cameras' exposures show together.
    pub(super) fn of(drive: &Drive, names: &RawNames) -> Self {
        let mut clouds = Self::default();
        let stride = drive.world().reconstruction.exposure_stride;
        for camera in 0..drive.scene().cameras.len() {
            for (number, exposure) in drive.exposures(camera).iter().enumerate().step_by(stride) {
                let mut boxes = Boxes::new(drive, exposure.time);
                for point in exposure_cloud(drive, exposure, number) {
                    let class = names.number(drive.world().class_of(point.what));
                    match boxes.of(point.what) {
                        None => clouds.world.push(&point.position, class),
                        Some((mover, box_from_world)) => {
                            let place = box_from_world * point.position;
                            clouds.objects.entry(mover).or_default().push(&place, class);
                        }
                    }
                }
            }
        }
        clouds
    }

    /// Writes all files; gives the number of points.
    pub(super) fn write(&self, drive: &Drive, output: &Output) -> Result<usize, Fault> {
        let name = &drive.scene().name;
        self.world.write(output.stream(&format!("{name}/cloud.ply"))?)?;
        for (&mover, object) in &self.objects {
            let track = &drive.world().movers[mover].name;
            object.write(output.stream(&format!("{name}/objects/{track}.ply"))?)?;
        }
        Ok(self.world.points + self.objects.values().map(|object| object.points).sum::<usize>())
    }
}

/// The true boxes of movers at an exposure's time, of those that have any in the log.
struct Boxes<'a> {
    drive: &'a Drive,
    time: Timestamp,
    box_from_world: BTreeMap<usize, Pose>,
}

impl<'a> Boxes<'a> {
    fn new(drive: &'a Drive, time: Timestamp) -> Self {
        Self { drive, time, box_from_world: BTreeMap::new() }
    }

    /// The mover that something is a part of, and where its box stands.
    fn of(&mut self, what: What) -> Option<(usize, Pose)> {
        let What::Mover(mover) = what else { return None };
        self.drive.track_of(mover)?;
        let (world, time) = (self.drive.world(), self.time);
        let box_from_world = self.box_from_world.entry(mover).or_insert_with(|| {
            let time_s = time.seconds_since(Timestamp(0));
            world.movers[mover].box_at(time_s, &world.ground).world_from_box.inverse()
        });
        Some((mover, *box_from_world))
    }
}

impl Cloud {
    fn push(&mut self, position: &Point3<f64>, class: u8) {
        self.points += 1;
        position.iter().for_each(|metres| self.bytes.extend((*metres as f32).to_le_bytes()));
        self.bytes.push(class);
    }

    fn write(&self, mut file: OutputFile) -> Result<(), Fault> {
        let header = format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\n\
             property float y\nproperty float z\nproperty uchar class\nend_header\n",
            self.points
        );
        file.write(header.as_bytes())?;
        file.write(&self.bytes)?;
        file.finish()
    }
}
