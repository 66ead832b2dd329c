//! The meshes that an annotator has of those who change shape.

use nalgebra::{Point3, Translation3};
use occlabel_core::{Keyframe, Pose};

use crate::Drive;
use crate::instant::mover_bodies;
use crate::noise::{Chance, Kind};
use crate::rotation::about_axis;

/// The surface of a mover at a keyframe, in the log's world.
#[derive(Clone, Debug)]
pub struct DrawnMesh {
    /// The mover, by number.
    pub mover: usize,
    /// Its parts' corners, one part after the other; metres.
    pub vertices: Vec<Point3<f64>>,
    /// Triangles, counter-clockwise seen from outside. The parts overlap as they do.
    pub faces: Vec<[u32; 3]>,
}

impl Drive {
    /// The meshes of all movers of deformable classes at a keyframe, where an annotator without jitter
    /// would draw their boxes.
    ///
    /// A mesh is off by `mesh_jitter_m` in a direction, and by `mesh_jitter_rad` about an axis through
    /// its box's centre; any is as likely.
    pub fn meshes(&self, keyframe: &Keyframe) -> Vec<DrawnMesh> {
        let movers = (0..self.world().movers.len()).filter(|&mover| self.is_deformable(mover));
        movers.map(|mover| self.mesh(keyframe, mover)).collect()
    }

    fn mesh(&self, keyframe: &Keyframe, mover: usize) -> DrawnMesh {
        let time_s = self.mover_time_s(keyframe, mover);
        let drawn_from_true = self.drawn_from_true(keyframe, mover, time_s);
        let (mut vertices, mut faces) = (Vec::new(), Vec::<[u32; 3]>::new());
        for body in mover_bodies(self.world(), mover, time_s) {
            let first = vertices.len() as u32;
            let (corners, triangles) = body.shape.surface();
            let drawn_from_shape = drawn_from_true * body.world_from_shape;
            vertices.extend(corners.iter().map(|corner| drawn_from_shape * corner));
            faces.extend(triangles.iter().map(|face| face.map(|at| at + first)));
        }
        DrawnMesh { mover, vertices, faces }
    }

    /// What the annotator makes of where a mover truly is.
    fn drawn_from_true(&self, keyframe: &Keyframe, mover: usize, time_s: f64) -> Pose {
        let (world, annotator) = (self.world(), &self.world().annotator);
        let (lidar, number) = self.taken_by(keyframe.sweep);
        let lidar = world.lidar_number(&lidar.name);
        let logged = self.poses().logged_from_true(world, lidar, keyframe.time);
        let chance = Chance::of(world.seed, Kind::Mesh, mover, number);
        let centre = world.movers[mover].box_at(time_s, &world.ground).world_from_box.translation;
        let turn = about_axis(&chance.direction(1), annotator.mesh_jitter_rad);
        let shift = Translation3::from(chance.direction(0) * annotator.mesh_jitter_m);
        logged * shift * centre * turn * centre.inverse()
    }
}
