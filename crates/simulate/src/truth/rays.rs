//! Every ray of a drive as it truly ran.

use nalgebra::Point3;
use occlabel_core::{BoxGrowth, ClassId, GrownBox, LIDAR_ORIGIN, PointCloud, Pose, Timestamp};
use rayon::prelude::*;

use crate::lidar::{Lidar, Return};
use crate::{Drive, What, World};

/// A box as large as it truly is.
pub(super) const NOT_GROWN: BoxGrowth = BoxGrowth { scale: 1.0, margin_m: 0.0 };

/// Every ray of every sweep of a drive, without noise and dropout. Rays that end on the ego's own
/// body are left out, as labels drop them.
#[derive(Clone, Debug)]
pub struct TrueRays {
    pub(super) sweeps: Vec<SweepRays>,
}

/// The rays of a sweep.
#[derive(Clone, Debug)]
pub(super) struct SweepRays {
    pub(super) time: Timestamp,
    /// Rays that end on what stands; world.
    pub(super) fixed: PointCloud<Option<ClassId>>,
    pub(super) moving: Vec<MoverRay>,
}

/// A ray that ends on a mover, cut where it enters the mover's true box of that moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct MoverRay {
    pub(super) mover: usize,
    /// Where it comes from; world.
    pub(super) origin: Point3<f64>,
    /// Where it enters the box; none if it comes from within. World.
    pub(super) entry: Option<Point3<f64>>,
    /// The same in the box's frame.
    pub(super) box_entry: Point3<f64>,
    /// Where it ends, in the box's frame.
    pub(super) box_end: Point3<f64>,
}

impl TrueRays {
    /// Casts the rays of a whole drive. Parallel; the same on any number of threads.
    ///
    /// Takes about 30 bytes a return.
    pub fn cast(drive: &Drive) -> Self {
        let cast = |sweep| {
            let (lidar, number) = drive.taken_by(sweep);
            SweepRays::cast(drive, lidar, number)
        };
        Self { sweeps: (0..drive.scene().sweeps.len()).into_par_iter().map(cast).collect() }
    }
}

impl SweepRays {
    /// Casts the rays of one sweep of a lidar.
    pub(super) fn cast(drive: &Drive, lidar: &Lidar, number: usize) -> Self {
        let world = drive.world();
        let time = lidar.shot_time(number, 0);
        let fixed = PointCloud::with_origins(Vec::new());
        let mut rays = Self { time, fixed, moving: Vec::new() };
        let returns = lidar.true_sweep(world, number);
        for shots in returns.chunk_by(|a, b| a.time == b.time) {
            let world_from_lidar = lidar.world_from_lidar(world, shots[0].time);
            rays.fixed.origins.push(world_from_lidar * LIDAR_ORIGIN);
            shots.iter().for_each(|found| rays.add(drive, &world_from_lidar, found));
        }
        rays
    }

    /// Adds a ray of the newest origin.
    fn add(&mut self, drive: &Drive, world_from_lidar: &Pose, found: &Return) {
        let end = world_from_lidar * found.position_m;
        let origin = (self.fixed.origins.len() - 1) as u32;
        match found.hit.what {
            What::Ground(_) | What::Static(_) => {
                self.fixed.push(end, drive.class_of(found.hit.what), origin);
            }
            What::Mover(mover) => {
                let origin = self.fixed.origins[origin as usize];
                self.moving.push(MoverRay::new(drive.world(), mover, found.time, origin, end));
            }
            What::Ego => {}
        }
    }
}

impl MoverRay {
    fn new(
        world: &World,
        mover: usize,
        time: Timestamp,
        origin: Point3<f64>,
        end: Point3<f64>,
    ) -> Self {
        let time_s = time.seconds_since(Timestamp(0));
        let stands = world.movers[mover].box_at(time_s, &world.ground);
        let grown = GrownBox::new(&stands.size_m, &NOT_GROWN);
        let box_from_world = stands.world_from_box.inverse();
        let (box_origin, box_end) = (box_from_world * origin, box_from_world * end);
        let box_entry = grown.entry(&box_origin, &box_end);
        let starts_inside = grown.contains(&box_origin);
        let entry = (!starts_inside).then(|| stands.world_from_box * box_entry);
        Self { mover, origin, entry, box_entry, box_end }
    }
}
