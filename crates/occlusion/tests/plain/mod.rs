//! The plain way, kept as the oracle of the fast one: each ray is cast by itself.

use std::ops::ControlFlow;

use nalgebra::Point3;
use occlabel_core::{GridSpec, VoxelGrid, walk};
use occlabel_occlusion::{CameraRays, Eye, Matter, Occluders, OcclusionSettings};

/// For each voxel the bits of the cameras that see it.
pub(crate) fn visible_plainly(
    eyes: &[Eye],
    spec: &GridSpec,
    matter: &VoxelGrid<Matter>,
    settings: &OcclusionSettings,
) -> VoxelGrid<u16> {
    let mut bits = VoxelGrid::filled(spec, 0);
    for eye in eyes {
        let look = Look { eye, spec, matter: matter.values(), settings };
        for (bits, is_seen) in bits.values_mut().iter_mut().zip(look.seen()) {
            *bits |= u16::from(is_seen) << eye.bit;
        }
    }
    bits
}

struct Look<'a> {
    eye: &'a Eye<'a>,
    spec: &'a GridSpec,
    matter: &'a [Matter],
    settings: &'a OcclusionSettings,
}

impl Look<'_> {
    fn seen(&self) -> Vec<bool> {
        let mut seen = vec![false; self.spec.len()];
        if self.settings.rays == CameraRays::Pixels {
            self.cast_pixels(&mut seen);
        }
        for voxel in self.spec.voxels() {
            let flat = self.spec.flat(voxel).unwrap();
            if self.is_in_view(&self.spec.centre(voxel)) {
                seen[flat] |= self.is_plain(flat);
                if self.is_target(flat) {
                    self.cast(self.spec.lattice_centre(voxel), &mut seen);
                }
            }
        }
        seen
    }

    fn cast_pixels(&self, seen: &mut [bool]) {
        let (camera, stride) = (self.eye.camera, self.settings.pixel_stride);
        for row in (0..camera.height).step_by(stride) {
            for column in (0..camera.width).step_by(stride) {
                let Some(way) = camera.ray_of(column, row) else { continue };
                let end = Point3::from(way.into_inner() * self.settings.depth_max_m);
                self.cast(self.spec.snap(&(self.eye.grid_from_camera * end)), seen);
            }
        }
    }

    fn is_in_view(&self, p: &Point3<f64>) -> bool {
        let way = p - self.position();
        let camera_from_grid = self.eye.grid_from_camera.rotation.inverse().to_rotation_matrix();
        let in_camera = || Point3::from(camera_from_grid * way);
        way.norm() <= self.settings.depth_max_m && self.eye.camera.pixel_of(&in_camera()).is_some()
    }

    fn position(&self) -> Point3<f64> {
        self.eye.grid_from_camera.translation.vector.into()
    }

    fn is_target(&self, flat: usize) -> bool {
        match self.settings.rays {
            CameraRays::AllCenters => true,
            CameraRays::OccupiedCenters => self.matter[flat] != Matter::Air,
            CameraRays::Pixels => false,
        }
    }

    fn is_plain(&self, flat: usize) -> bool {
        self.settings.occluders == Occluders::NonFlat && self.matter[flat] == Matter::Ground
    }

    fn cast(&self, end: occlabel_core::LatticePoint, seen: &mut [bool]) {
        let start = self.spec.snap(&self.position());
        if let Some(flat) = self.spec.flat(start.voxel()) {
            seen[flat] = true;
        }
        walk(self.spec, start, end, |flat, _| {
            seen[flat] = true;
            match self.matter[flat] {
                Matter::Air => ControlFlow::Continue(()),
                Matter::Ground if self.settings.occluders == Occluders::NonFlat => {
                    ControlFlow::Continue(())
                }
                _ => ControlFlow::Break(()),
            }
        });
    }
}
