//! Where rays end: three ways that have to agree.

use nalgebra::{Point3, Vector3};
use occlabel_core::{GridSpec, VoxelGrid};
use occlabel_evaluate::rays::{
    RayEnd, RayGrid, RaySet, cast_rays, first_hit, ray_pairs, textbook_first_hit,
};

use crate::support::*;

/// Shapes and voxel sizes: flat, thin, tall beyond a word, uneven.
const GRIDS: [([usize; 3], [f64; 3]); 8] = [
    ([20, 20, 16], [0.4; 3]),
    ([13, 29, 7], [0.1, 0.3, 0.7]),
    ([8, 9, 64], [1.0, 0.5, 0.25]),
    ([8, 9, 65], [1.0, 0.5, 0.25]),
    ([6, 5, 200], [0.5; 3]),
    ([1, 40, 9], [0.4, 0.2, 0.4]),
    ([40, 1, 9], [0.2, 0.4, 0.4]),
    ([15, 15, 1], [0.4; 3]),
];

/// Pitches and azimuths with all axes and diagonals among them.
fn rays() -> RaySet {
    let pitches: Vec<f64> = (-12..=12).map(|k| (f64::from(k) * 7.5).to_radians()).collect();
    let azimuths: Vec<f64> = (0..48).map(|k| (f64::from(k) * 7.5).to_radians()).collect();
    RaySet::new(&pitches, &azimuths).unwrap()
}

/// A point of the grid; one in three coordinates lies on a face.
fn origin(spec: &GridSpec, dice: &mut Dice) -> Point3<f64> {
    let mut c = |axis: usize| {
        let n = spec.shape()[axis] as u64;
        let u = if dice.below(3) == 0 { dice.below(n) as f64 } else { dice.share() * n as f64 };
        u * spec.size_m()[axis]
    };
    Point3::new(c(0), c(1), c(2))
}

fn same(one: RayEnd, other: RayEnd) -> bool {
    one.hit().map(|hit| hit.flat) == other.hit().map(|hit| hit.flat)
        && (one.depth_m() - other.depth_m()).abs() < 1e-9
}

/// Casts from a few origins of a grid; how many rays hit and how many do not.
fn cast_both_ways(grid: &RayGrid, spec: &GridSpec, dice: &mut Dice) -> [u64; 2] {
    let (rays, mut counts) = (rays(), [0; 2]);
    for _ in 0..4 {
        let origin = origin(spec, dice);
        let ends = cast_rays(grid, &origin, &rays).unwrap();
        for (direction, end) in rays.directions().zip(ends) {
            let alone = first_hit(grid, &origin, &direction);
            assert!(same(end, alone), "{origin} {direction}: {end:?}, alone {alone:?}");
            counts[usize::from(end.hit().is_none())] += 1;
        }
    }
    counts
}

#[test]
fn a_fan_of_rays_ends_where_each_of_them_ends_alone() {
    let (mut dice, mut counts) = (Dice(7), [0; 2]);
    for (shape, size_m) in GRIDS {
        for one_in in [1, 2, 10, 60, 400] {
            let spec = spec(shape, size_m);
            let semantics = semantics(&spec, one_in, &mut dice);
            let grid = RayGrid::new(&spec, &semantics, FREE).unwrap();
            let [hit, free] = cast_both_ways(&grid, &spec, &mut dice);
            counts = [counts[0] + hit, counts[1] + free];
        }
    }
    assert_eq!(counts[0] + counts[1], 8 * 5 * 4 * 25 * 48);
    assert!(counts[0] > 60_000 && counts[1] > 20_000, "{counts:?}");
}

/// Whether a ray meets two faces within 1e-9 m of another somewhere in the grid.
fn has_tie(spec: &GridSpec, origin: &Point3<f64>, direction: &Vector3<f64>) -> bool {
    let u = spec.to_voxel_units(origin);
    let mut met: Vec<f64> = vec![];
    for axis in 0..3 {
        let faces = 0..=spec.shape()[axis];
        let at = |face: usize| (face as f64 - u[axis]) * spec.size_m()[axis] / direction[axis];
        met.extend(faces.map(at).filter(|met| met.is_finite() && *met > -1e-9));
    }
    met.sort_by(f64::total_cmp);
    met.windows(2).any(|two| two[1] - two[0] < 1e-9)
}

#[test]
fn a_ray_ends_where_the_textbook_has_it_unless_it_meets_two_faces_at_once() {
    let (mut dice, mut sure, mut ties) = (Dice(8), 0, 0);
    for (shape, size_m) in GRIDS {
        let spec = spec(shape, size_m);
        let semantics = semantics(&spec, 60, &mut dice);
        let grid = RayGrid::new(&spec, &semantics, FREE).unwrap();
        let origin = origin(&spec, &mut dice);
        for direction in rays().directions().chain(RaySet::published().directions()) {
            let textbook = textbook_first_hit(&grid, &origin, &direction);
            let end = first_hit(&grid, &origin, &direction);
            if has_tie(&spec, &origin, &direction) {
                ties += 1;
                continue;
            }
            sure += 1;
            assert!(same(end, textbook), "{origin} {direction}: {end:?}, textbook {textbook:?}");
        }
    }
    assert_eq!(sure + ties, 8 * (25 * 48 + 14_040));
    assert!(sure > 40_000 && ties > 1000, "{sure} {ties}");
}

#[test]
fn a_ray_from_outside_ends_where_it_ends_from_where_it_comes_in() {
    let (mut dice, mut met) = (Dice(9), [0; 2]);
    let spec = spec([13, 17, 9], [0.5, 0.25, 1.0]);
    let semantics = semantics(&spec, 30, &mut dice);
    let grid = RayGrid::new(&spec, &semantics, FREE).unwrap();
    for _ in 0..20_000 {
        let inside =
            Point3::new(dice.between(0.0, 6.5), dice.between(0.0, 4.25), dice.between(0.0, 9.0));
        let direction = Vector3::from_fn(|_, _| dice.between(-1.0, 1.0)).normalize();
        let back_m = dice.between(0.0, 60.0);
        let (origin, end) = (inside - direction * back_m, first_hit(&grid, &inside, &direction));
        let from_outside = first_hit(&grid, &origin, &direction);
        let is_met = from_outside.depth_m() < end.depth_m() + back_m - 1e-6;
        met[usize::from(is_met)] += 1;
        if !is_met {
            assert_eq!(from_outside.hit().map(|hit| hit.flat), end.hit().map(|hit| hit.flat));
            assert!((from_outside.depth_m() - back_m - end.depth_m()).abs() < 1e-9);
        } else {
            let hit = from_outside.hit().expect("something on the way in");
            let centre = spec.centre(spec.voxel_at(hit.flat as usize));
            let off = (centre - origin).cross(&direction).norm();
            assert!(
                off < spec.size_m().norm() / 2.0 && semantics.values()[hit.flat as usize] < FREE
            );
        }
    }
    assert_eq!(met.iter().sum::<i32>(), 20_000);
    assert!(met[0] > 3000 && met[1] > 3000, "{met:?}");
}

#[test]
fn a_ray_that_never_comes_to_the_grid_is_free_at_0_m() {
    let spec = spec([4, 4, 4], [1.0; 3]);
    let full = VoxelGrid::filled(&spec, 0);
    let grid = RayGrid::new(&spec, &full, FREE).unwrap();
    let outside = [[-1.0, 2.0, 2.0], [2.0, 2.0, 1e300], [2.0, -1e15, 2.0], [-3.0, -3.0, 9.0]];
    for origin in outside.map(Point3::from) {
        for direction in [Vector3::x(), Vector3::z(), Vector3::new(0.6, 0.0, 0.8)] {
            let end = first_hit(&grid, &origin, &direction);
            if origin.x == -1.0 && direction == Vector3::x() {
                assert_eq!((end.hit().map(|hit| hit.flat), end.depth_m()), (Some(10), 2.0));
            } else if origin.x != -1.0 || direction.x == 0.0 {
                assert_eq!(end, RayEnd::Free { depth_m: 0.0 }, "{origin} {direction}");
            }
        }
    }
}

#[test]
fn depth_is_where_the_ray_leaves_the_voxel_or_the_grid() {
    let spec = spec([10, 4, 4], [0.5, 1.0, 1.0]);
    let mut semantics = VoxelGrid::filled(&spec, FREE);
    let at = |x: usize| (x * 4 + 1) * 4 + 1;
    semantics.values_mut()[at(6)] = 2;
    semantics.values_mut()[at(3)] = 255;
    let grid = RayGrid::new(&spec, &semantics, FREE).unwrap();
    let from = |x: f64, way: f64| {
        first_hit(&grid, &Point3::new(x, 1.5, 1.5), &Vector3::new(way, 0.0, 0.0))
    };
    let ends =
        [from(0.25, 1.0), from(4.75, -1.0), from(0.25, -1.0), from(3.25, 1.0), from(3.0, -1.0)];
    assert_eq!(ends.map(|end| end.depth_m()), [3.25, 1.75, 0.25, 0.25, 0.0]);
    assert_eq!(ends.map(|end| end.hit().is_some()), [true, true, false, true, true]);
    assert!(ends.iter().filter_map(RayEnd::hit).all(|hit| hit.flat as usize == at(6)));
}

/// A street of the published size: ground with holes, houses, trees with crowns, cars.
fn street(dice: &mut Dice) -> (GridSpec, VoxelGrid<u8>) {
    let spec = GridSpec::new([-40.0, -40.0, -1.0], [40.0, 40.0, 5.4], [0.4; 3]).unwrap();
    let mut grid = VoxelGrid::filled(&spec, FREE);
    let mut fill = |x: [u64; 2], y: [u64; 2], z: [u64; 2], class: u8| {
        for x in x[0]..x[1].min(200) {
            for y in y[0]..y[1].min(200) {
                let column = (x * 200 + y) as usize * 16;
                grid.values_mut()[column + z[0] as usize..column + z[1] as usize].fill(class);
            }
        }
    };
    fill([0, 200], [20, 180], [1, 2], 0);
    for _ in 0..60 {
        let (x, y) = (dice.below(195), 20 + dice.below(150));
        match dice.below(4) {
            0 => fill([x, x + 1], [y, y + 1], [2, 16], 1),
            1 => fill([x, x + 8], [y, y + 8], [9, 14], 2),
            2 => fill([x, x + 11], [y, y + 5], [2, 6], 3),
            _ => fill([x, x + 6], [y, y + 6], [0, 3], FREE),
        }
    }
    fill([30, 170], [160, 163], [1, 16], 4);
    (spec, grid)
}

#[test]
fn in_a_street_all_published_rays_end_where_the_textbook_has_them() {
    let (mut dice, rays, mut hits) = (Dice(10), RaySet::published(), 0);
    let (spec, semantics) = street(&mut dice);
    let grid = RayGrid::new(&spec, &semantics, FREE).unwrap();
    for _ in 0..4 {
        let origin = Point3::new(dice.between(-30.0, 30.0), dice.between(-20.0, 20.0), 1.84);
        let ends = cast_rays(&grid, &origin, &rays).unwrap();
        for (direction, end) in rays.directions().zip(&ends) {
            let textbook = textbook_first_hit(&grid, &origin, &direction);
            assert!(same(*end, textbook), "{origin} {direction}: {end:?}, textbook {textbook:?}");
        }
        hits += ends.iter().filter(|end| end.hit().is_some()).count();
    }
    assert!((20_000..4 * 14_040).contains(&hits), "{hits}");
}

#[test]
fn pairs_are_the_rays_that_hit_something_in_the_truth() {
    let (mut dice, rays) = (Dice(11), rays());
    let spec = spec([20, 20, 16], [0.4; 3]);
    let grids = [10, 30].map(|one_in| semantics(&spec, one_in, &mut dice));
    let [truth, prediction] = [0, 1].map(|at| RayGrid::new(&spec, &grids[at], FREE).unwrap());
    let origins = [[3.0, 4.1, 2.2], [8.1, 4.0, 3.3]].map(Point3::from);
    let pairs = ray_pairs(&truth, &prediction, &origins, &rays).unwrap();
    let mut ours: Vec<[Option<u32>; 2]> = (pairs.iter())
        .map(|pair| [Some(pair.truth.flat), pair.prediction.map(|hit| hit.flat)])
        .collect();
    let mut alone = vec![];
    for origin in &origins {
        let flat = |grid, way| first_hit(grid, origin, &way).hit().map(|hit| hit.flat);
        let both = rays.directions().map(|way| [&truth, &prediction].map(|grid| flat(grid, way)));
        alone.extend(both.filter(|[truth, _]| truth.is_some()));
    }
    ours.sort_unstable();
    alone.sort_unstable();
    assert_eq!(ours, alone);
    let free = pairs.iter().filter(|pair| pair.error_m().is_none()).count();
    assert!(free > 50 && pairs.len() > free + 400, "{} {free}", pairs.len());
}

#[test]
fn grids_and_origins_that_do_not_fit_are_faults() {
    let (one, other) = (spec([4, 4, 4], [1.0; 3]), spec([4, 4, 5], [1.0; 3]));
    let [full, taller] = [&one, &other].map(|spec| VoxelGrid::filled(spec, 0));
    assert_eq!(RayGrid::new(&one, &taller, FREE).unwrap_err().rule, "ray-grid");
    let [truth, prediction] = [(&one, &full), (&other, &taller)]
        .map(|(spec, grid)| RayGrid::new(spec, grid, FREE).unwrap());
    let pairs = |prediction, x| ray_pairs(&truth, prediction, &[Point3::new(x, 1.0, 1.0)], &rays());
    assert_eq!(pairs(&prediction, 1.0).unwrap_err().rule, "ray-grid");
    assert_eq!(pairs(&truth, f64::NAN).unwrap_err().rule, "ray-origin");
    assert!(cast_rays(&truth, &Point3::new(0.0, f64::INFINITY, 0.0), &rays()).is_err());
    assert_eq!(pairs(&truth, 1.0).unwrap().len(), rays().len());
}
