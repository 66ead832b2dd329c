//! Casting the cameras' rays (labels.md section 10).

use std::ops::ControlFlow;

use occlabel_core::{
    ClassSet, GridSpec, LatticePoint, VoxelGrid, VoxelIndex, VoxelState, VoxelVote, walk,
};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::Eye;

/// The `[occlusion]` table.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OcclusionSettings {
    /// Which rays are cast.
    pub rays: CameraRays,
    /// Which voxels end a ray.
    pub occluders: Occluders,
    /// Under `pixels`: every how many-th pixel of each row and column, at least 1.
    pub pixel_stride: usize,
    /// How far a camera sees, metres.
    pub depth_max_m: f64,
}

/// Which rays a camera casts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CameraRays {
    /// To the centre of each occupied voxel in view (Occ3D text, GS-Occ3D).
    OccupiedCenters,
    /// To the centre of each voxel in view.
    AllCenters,
    /// Through pixel centres (Occ3D Algorithm 3, with the text's stop).
    Pixels,
}

/// Which occupied voxels end a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Occluders {
    /// All of them.
    All,
    /// All but those of flat classes, which are seen wherever they are in view (published masks).
    NonFlat,
}

/// What a voxel is to a camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Matter {
    /// Not occupied, observed or not: never blocks.
    Air,
    /// Occupied by a flat class.
    Ground,
    /// Occupied by anything else.
    Solid,
}

/// What each voxel is to a camera, from its final state and class.
///
/// # Panics
/// If the grids differ in shape.
pub fn matter(
    states: &VoxelGrid<VoxelState>,
    votes: &VoxelGrid<Option<VoxelVote>>,
    flat: &ClassSet,
) -> VoxelGrid<Matter> {
    states.zip_map(votes, |state, vote| match (state, vote) {
        (VoxelState::Occupied, Some(vote)) if flat.contains(vote.class) => Matter::Ground,
        (VoxelState::Occupied, _) => Matter::Solid,
        _ => Matter::Air,
    })
}

/// For each voxel the bits of the cameras that see it. Parallel over cameras.
pub fn visible(
    eyes: &[Eye],
    spec: &GridSpec,
    matter: &VoxelGrid<Matter>,
    settings: &OcclusionSettings,
) -> VoxelGrid<u16> {
    let seen: Vec<(usize, VoxelGrid<bool>)> =
        eyes.par_iter().map(|eye| (eye.bit, seen_by(eye, spec, matter, settings))).collect();
    let mut bits = VoxelGrid::filled(spec, 0);
    for (bit, seen) in seen {
        let flags = seen.values().iter().map(|&is_seen| u16::from(is_seen) << bit);
        bits.values_mut().iter_mut().zip(flags).for_each(|(bits, flag)| *bits |= flag);
    }
    bits
}

fn seen_by(
    eye: &Eye,
    spec: &GridSpec,
    matter: &VoxelGrid<Matter>,
    settings: &OcclusionSettings,
) -> VoxelGrid<bool> {
    let mut look = Look {
        spec,
        matter: matter.values(),
        occluders: settings.occluders,
        start: spec.snap(&eye.position()),
        seen: VoxelGrid::filled(spec, false),
    };
    if settings.rays == CameraRays::Pixels {
        for end in eye.pixel_ends(settings.pixel_stride, settings.depth_max_m) {
            look.along(spec.snap(&end));
        }
    }
    let is_in_view = eye.view(settings.depth_max_m);
    for flat in 0..spec.len() {
        let (is_target, is_plain) = (look.is_target(flat, settings.rays), look.is_plain(flat));
        if (is_target || is_plain) && is_in_view(&spec.centre(spec.voxel_at(flat))) {
            look.at(flat, is_target);
        }
    }
    look.seen
}

/// One camera's view so far.
struct Look<'a> {
    spec: &'a GridSpec,
    matter: &'a [Matter],
    occluders: Occluders,
    start: LatticePoint,
    seen: VoxelGrid<bool>,
}

impl Look<'_> {
    /// Whether a ray is cast to the centre of a voxel that is in view.
    fn is_target(&self, flat: usize, rays: CameraRays) -> bool {
        match rays {
            CameraRays::AllCenters => true,
            CameraRays::OccupiedCenters => self.matter[flat] != Matter::Air,
            CameraRays::Pixels => false,
        }
    }

    /// Whether a voxel is seen wherever it is in view.
    fn is_plain(&self, flat: usize) -> bool {
        self.occluders == Occluders::NonFlat && self.matter[flat] == Matter::Ground
    }

    /// Looks at a voxel in view.
    fn at(&mut self, flat: usize, is_target: bool) {
        if self.is_plain(flat) {
            self.seen.values_mut()[flat] = true;
        }
        if is_target {
            self.along(self.spec.lattice_centre(self.spec.voxel_at(flat)));
        }
    }

    /// Marks all that a ray sees: from the camera's own voxel to the first that blocks.
    #[inline]
    fn along(&mut self, end: LatticePoint) {
        self.mark(self.start.voxel());
        let (matter, occluders, seen) = (self.matter, self.occluders, self.seen.values_mut());
        walk(self.spec, self.start, end, |flat, _| {
            seen[flat] = true;
            if blocks(matter[flat], occluders) {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
    }

    fn mark(&mut self, voxel: VoxelIndex) {
        if let Some(flat) = self.spec.flat(voxel) {
            self.seen.values_mut()[flat] = true;
        }
    }
}

#[inline]
fn blocks(matter: Matter, occluders: Occluders) -> bool {
    match matter {
        Matter::Air => false,
        Matter::Ground => occluders == Occluders::All,
        Matter::Solid => true,
    }
}
