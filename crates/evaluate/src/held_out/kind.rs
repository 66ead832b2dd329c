//! Ground, structure or track: what returned a ray.

use nalgebra::Point3;
use occlabel_core::{ClassId, ClassSet, VoxelIndex};

use super::{HeldOutRay, Labels, Source, Verdict};

/// Width of a bin of heights, metres.
const BIN_M: f64 = 0.1;

/// How far from the fullest bin's middle a return is still ground, metres: kerbs and a road's
/// camber within, most of what stands on it without.
const GROUND_REACH_M: f64 = 0.2;

/// What returned a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// The ground.
    Ground,
    /// What is neither ground nor a track.
    Structure,
    /// A track.
    Track,
}

/// How ground is told from what stands on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GroundRule {
    /// By these classes: of the return itself if it has a label, else of its voxel, else of the
    /// nearest occupied one of the 26 around it. With none of these a return is no ground.
    Classes(ClassSet),
    /// By height, for logs without point labels: near the height at which most returns lie. Good
    /// for streets that are nearly level, and for nothing else.
    Height,
}

/// The kind of each ray's return.
pub(super) fn kinds(labels: &Labels, rays: &[HeldOutRay], rule: &GroundRule) -> Vec<Kind> {
    let level = match rule {
        GroundRule::Classes(_) => None,
        GroundRule::Height => level_m(labels, rays),
    };
    let is_ground = |ray: &HeldOutRay, own: Option<ClassId>| match rule {
        GroundRule::Classes(flat) => {
            let class = own.or_else(|| class_near(labels, &ray.point));
            class.is_some_and(|class| flat.contains(class))
        }
        GroundRule::Height => {
            level.is_some_and(|level| (ray.point.z - level).abs() <= GROUND_REACH_M)
        }
    };
    let kind = |ray: &HeldOutRay| match ray.source {
        Source::Track => Kind::Track,
        Source::Background(own) if is_ground(ray, own) => Kind::Ground,
        Source::Background(_) => Kind::Structure,
    };
    rays.iter().map(kind).collect()
}

/// The class of the voxel that holds a point, else of the nearest occupied one around it; the first
/// in flat order on ties.
fn class_near(labels: &Labels, p: &Point3<f64>) -> Option<ClassId> {
    let spec = labels.spec;
    let class_at = |voxel: VoxelIndex| match labels.verdicts.values()[spec.flat(voxel)?] {
        Verdict::Occupied(class) => Some(class),
        _ => None,
    };
    let own = spec.snap(p).voxel();
    let distance = |voxel: &VoxelIndex| (spec.centre(*voxel) - p).norm_squared();
    let around = around(own).filter_map(|voxel| Some((distance(&voxel), class_at(voxel)?)));
    let nearest = || around.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, class)| class);
    class_at(own).or_else(nearest)
}

/// A voxel and the 26 around it, in flat order.
pub(super) fn around(VoxelIndex([x, y, z]): VoxelIndex) -> impl Iterator<Item = VoxelIndex> {
    let columns = (-1..=1).flat_map(move |dx| (-1..=1).map(move |dy| (x + dx, y + dy)));
    columns.flat_map(move |(x, y)| (-1..=1).map(move |dz| VoxelIndex([x, y, z + dz])))
}

/// The middle of the bin of heights in the grid that holds most background returns, the lowest on
/// ties; metres.
fn level_m(labels: &Labels, rays: &[HeldOutRay]) -> Option<f64> {
    let (low, high) = (labels.spec.min_m().z, labels.spec.max_m().z);
    let mut bins = vec![0_u64; ((high - low) / BIN_M).ceil() as usize + 1];
    for ray in rays.iter().filter(|ray| ray.source != Source::Track) {
        if labels.spec.flat_of(&ray.point).is_some() {
            bins[((ray.point.z - low) / BIN_M) as usize] += 1;
        }
    }
    let fullest = (0..bins.len()).max_by_key(|&bin| (bins[bin], std::cmp::Reverse(bin)))?;
    (bins[fullest] > 0).then_some(low + (fullest as f64 + 0.5) * BIN_M)
}

#[cfg(test)]
mod tests {
    use occlabel_core::{GridSpec, VoxelGrid};

    use super::*;

    const ROAD: ClassId = ClassId(11);
    const WALL: ClassId = ClassId(15);

    fn ray(point: [f64; 3], source: Source) -> HeldOutRay {
        let origin = Point3::new(0.5, 0.5, 3.5);
        HeldOutRay { origin, point: point.into(), source, is_of_another_time: false }
    }

    fn kinds_of(rays: &[HeldOutRay], rule: GroundRule) -> Vec<Kind> {
        let spec = GridSpec::new([0.0; 3], [8.0, 1.0, 4.0], [1.0; 3]).unwrap();
        let mut verdicts = VoxelGrid::filled(&spec, Verdict::Free);
        let flat = |x: i64, z: i64| spec.flat(VoxelIndex([x, 0, z])).unwrap();
        (0..7).for_each(|x| verdicts.values_mut()[flat(x, 0)] = Verdict::Occupied(ROAD));
        verdicts.values_mut()[flat(6, 1)] = Verdict::Occupied(WALL);
        let labels = Labels { spec: &spec, verdicts: &verdicts, standing: None };
        kinds(&labels, rays, &rule)
    }

    #[test]
    fn a_return_goes_by_its_own_label_then_its_voxel_then_the_nearest() {
        let unlabelled = Source::Background(None);
        let rays = [
            ray([2.5, 0.5, 0.5], Source::Background(Some(WALL))),
            ray([2.5, 0.5, 0.5], unlabelled),
            ray([2.5, 0.5, 1.2], unlabelled),
            ray([5.8, 0.5, 1.5], unlabelled),
            ray([2.5, 0.5, 2.5], unlabelled),
            ray([2.5, 0.5, 0.5], Source::Track),
        ];
        use Kind::{Ground, Structure, Track};
        let found = kinds_of(&rays, GroundRule::Classes([ROAD].into_iter().collect()));
        assert_eq!(found, [Structure, Ground, Ground, Structure, Structure, Track]);
    }

    #[test]
    fn without_labels_ground_is_where_most_returns_lie() {
        let at = |z: f64| ray([2.5, 0.5, z], Source::Background(None));
        let rays = [at(0.32), at(0.31), at(0.38), at(0.16), at(0.54), at(0.58), at(2.0)];
        use Kind::{Ground, Structure};
        let expected = [Ground, Ground, Ground, Ground, Ground, Structure, Structure];
        assert_eq!(kinds_of(&rays, GroundRule::Height), expected);
    }
}
