//! Any grid, and points anywhere.

use nalgebra::Point3;
use occlabel_core::{GridSpec, RigidMap};

use super::bytes::Bytes;

/// A grid by its limits, or by its sides; where points lie in it.
pub(super) fn grid(bytes: &[u8]) -> bool {
    let mut bytes = Bytes(bytes);
    let Some(spec) = any_grid(&mut bytes) else { return false };
    let place = RigidMap::from(&bytes.pose());
    let points: [Point3<f64>; 5] = std::array::from_fn(|_| bytes.place());
    let flats = spec.flats_of(&place, &points);
    for (point, found) in points.iter().zip(flats) {
        let placed = place.apply(point);
        assert_eq!(found, spec.flat_of(&placed), "{spec:?} {placed}");
        assert_eq!(found, spec.flat(spec.snap(&placed).voxel()), "{spec:?} {placed}");
        let back = found.map(|flat| spec.flat(spec.voxel_at(flat)));
        assert!(back.is_none_or(|back| back == found && found < Some(spec.len())), "{spec:?}");
    }
    let radius_m = bytes.metres().abs();
    let mut near = spec.voxels_near(&points[0], radius_m).take(1000);
    assert!(near.all(|voxel| spec.flat(voxel).is_some()), "{spec:?}");
    true
}

fn any_grid(bytes: &mut Bytes) -> Option<GridSpec> {
    let (min_m, size_m) = (bytes.numbers::<3>(), bytes.numbers::<3>());
    let max_m = match bytes.flag() {
        true => bytes.numbers(),
        false => {
            std::array::from_fn(|axis| min_m[axis] + size_m[axis] * (1.0 + bytes.below(99) as f64))
        }
    };
    GridSpec::new(min_m, max_m, size_m).ok()
}

/// Cubes of a metre from the origin on, and points about them.
pub(super) fn grids() -> Vec<Vec<u8>> {
    let sides = [&[3, 0, 0].repeat(3)[..], &[3, 0, 1].repeat(3), &[0, 9, 9, 9]].concat();
    let points = [3, 0, 2].repeat(18);
    vec![[&sides[..], &[0], &points].concat()]
}
