//! Casting the cameras' rays (labels.md section 10).

use std::ops::Range;

use occlabel_core::{GridSpec, VoxelGrid, VoxelIndex};
use rayon::prelude::*;

use crate::bit_columns::BitColumns;
use crate::fan::{Targets, cast_fan};
use crate::look::Look;
use crate::pixel_rays::cast_pixels;
use crate::view::View;
use crate::{CameraRays, Eye, Lenses, Matter, Occluders, OcclusionSettings};

/// Columns along x and y that are asked together whether they can be in view.
const BRICK: usize = 8;

/// For each voxel the bits of the cameras that see it. Parallel over cameras.
///
/// `lenses` are those of the scene, or new ones.
pub fn visible(
    eyes: &[Eye],
    lenses: &Lenses,
    spec: &GridSpec,
    matter: &VoxelGrid<Matter>,
    settings: &OcclusionSettings,
) -> VoxelGrid<u16> {
    let sights = Sights::new(spec, matter, settings);
    let looks: Vec<Look> = eyes.par_iter().map(|eye| sights.look(eye, lenses)).collect();
    let mut bits = VoxelGrid::filled(spec, 0);
    for (eye, look) in eyes.iter().zip(&looks) {
        look.add_bit(eye.bit, bits.values_mut());
    }
    bits
}

/// What all cameras of a keyframe look at, and how.
struct Sights<'a> {
    spec: &'a GridSpec,
    settings: &'a OcclusionSettings,
    /// Voxels that end rays.
    blocks: BitColumns,
    /// Voxels to whose centres rays are cast where they are in view.
    targets: BitColumns,
    /// Voxels that are seen wherever they are in view.
    plain: BitColumns,
}

impl<'a> Sights<'a> {
    fn new(
        spec: &'a GridSpec,
        matter: &VoxelGrid<Matter>,
        settings: &'a OcclusionSettings,
    ) -> Self {
        let is_plain = |m| m == Matter::Ground && settings.occluders == Occluders::NonFlat;
        let is_target = |m| match settings.rays {
            CameraRays::AllCenters => true,
            CameraRays::OccupiedCenters => m != Matter::Air,
            CameraRays::Pixels => false,
        };
        Self {
            spec,
            settings,
            blocks: BitColumns::of(spec, matter, |m| m != Matter::Air && !is_plain(m)),
            targets: BitColumns::of(spec, matter, is_target),
            plain: BitColumns::of(spec, matter, is_plain),
        }
    }

    /// What one camera sees.
    fn look(&self, eye: &Eye, lenses: &Lenses) -> Look<'a> {
        let mut look = Look::new(self.spec, &eye.position(), &self.blocks);
        if self.settings.rays == CameraRays::Pixels {
            let cones = lenses.cones(eye, self.settings.pixel_stride);
            cast_pixels(&mut look, eye, &cones, self.settings.depth_max_m);
        }
        let view = View::new(eye, self.settings.depth_max_m);
        for brick in bricks(self.spec.shape()) {
            self.look_at(&mut look, &view, &brick);
        }
        look
    }

    /// Looks at the voxels of a brick that are in view.
    fn look_at(&self, look: &mut Look, view: &View, brick: &[Range<usize>; 3]) {
        let [low, high] = [brick.clone().map(|r| r.start), brick.clone().map(|r| r.end - 1)];
        if !view.may_have(self.spec, voxel(low), voxel(high)) {
            return;
        }
        let [xs, ys, zs] = brick;
        for (x, y) in xs.clone().flat_map(|x| ys.clone().map(move |y| (x, y))) {
            let column = x * self.spec.shape()[1] + y;
            let targets = self.targets.bits(column, zs.start);
            let plain = self.plain.bits(column, zs.start);
            let is_seen = |k| view.has(&self.spec.centre(voxel([x, y, zs.start + k])));
            let in_view =
                ones(targets | plain).filter(|&k| is_seen(k)).fold(0, |all, k| all | 1 << k);
            ones(plain & in_view).for_each(|k| look.mark(column, zs.start + k));
            cast_fan(look, Targets { column, bottom: zs.start, bits: targets & in_view });
        }
    }
}

fn voxel(at: [usize; 3]) -> VoxelIndex {
    VoxelIndex(at.map(|i| i as i64))
}

/// The places of the bits that are set.
fn ones(bits: u64) -> impl Iterator<Item = usize> {
    let rests = std::iter::successors(Some(bits), |rest| Some(rest & rest.wrapping_sub(1)));
    rests.take_while(|rest| *rest != 0).map(|rest| rest.trailing_zeros() as usize)
}

/// The grid cut into bricks of few columns and at most 64 voxels of each.
fn bricks(shape: [usize; 3]) -> impl Iterator<Item = [Range<usize>; 3]> {
    let parts = move |axis: usize, size: usize| {
        (0..shape[axis]).step_by(size).map(move |from| from..(from + size).min(shape[axis]))
    };
    parts(0, BRICK).flat_map(move |xs| {
        parts(1, BRICK).flat_map(move |ys| {
            let xs = xs.clone();
            parts(2, 64).map(move |zs| [xs.clone(), ys.clone(), zs])
        })
    })
}
