//! Two label sets against a count by hand.

use nalgebra::Point3;
use occlabel_core::{GridSpec, VoxelGrid};
use occlabel_evaluate::compare::{ComparedLabels, Comparer, Comparison, Difference};

fn spec() -> GridSpec {
    GridSpec::new([-4.0, -1.0, 0.0], [4.0, 1.0, 1.0], [1.0; 3]).unwrap()
}

fn comparer() -> Comparer {
    Comparer::new(spec(), vec!["car".into(), "road".into()]).unwrap()
}

fn along_rays() -> Comparer {
    Comparer::along_rays(spec(), vec!["car".into(), "road".into()]).unwrap()
}

/// A keyframe of two sets.
struct Pair {
    semantics: [VoxelGrid<u8>; 2],
    observed: [VoxelGrid<u8>; 2],
}

impl Pair {
    /// Sixteen voxels drawn as text: `c` car, `r` road, `.` free, `?` unobserved, ` ` no label.
    fn drawn(a: &str, b: &str) -> Self {
        let grid = |text: &str, id: fn(char) -> u8| {
            VoxelGrid::from_values(&spec(), text.chars().map(id).collect())
        };
        let class = |voxel| match voxel {
            'c' => 0,
            'r' => 1,
            ' ' => 255,
            _ => 2,
        };
        Self {
            semantics: [grid(a, class), grid(b, class)],
            observed: [
                grid(a, |voxel| u8::from(voxel != '?')),
                grid(b, |voxel| u8::from(voxel != '?')),
            ],
        }
    }

    fn difference(&self, origins: &[Point3<f64>]) -> Difference {
        let labels = |at: usize| ComparedLabels {
            mask_lidar: Some(&self.observed[at]),
            ..ComparedLabels::of(&self.semantics[at])
        };
        let comparer = if origins.is_empty() { comparer() } else { along_rays() };
        comparer.compare(&labels(0), &labels(1), origins).unwrap()
    }

    fn comparison(&self) -> Comparison {
        self.difference(&[]).comparison(&comparer())
    }
}

#[test]
fn equal_sets_do_not_differ() {
    let pair = Pair::drawn("crrr....????cc..", "crrr....????cc..");
    let comparison = pair.comparison();
    assert_eq!((comparison.differing, comparison.differing_share), (0, Some(0.0)));
    assert_eq!(comparison.semantic.unwrap().miou, Some(1.0));
    assert_eq!(comparison.mask_lidar.unwrap().iou, Some(1.0));
    assert_eq!(comparison.states.unwrap().same, 16);
}

#[test]
fn every_change_of_state_is_counted_by_its_name() {
    let comparison = Pair::drawn("cr..??..........", ".?r?.c..........").comparison();
    let states = comparison.states.unwrap();
    assert_eq!((states.occupied_to_free, states.occupied_to_unobserved), (1, 1));
    assert_eq!((states.free_to_occupied, states.free_to_unobserved), (1, 1));
    assert_eq!((states.unobserved_to_free, states.unobserved_to_occupied), (1, 1));
    assert_eq!(states.same, 10);
    assert_eq!(comparison.differing, 6);
    assert_eq!(comparison.arrays.semantics, 4, "free and unobserved are one number");
    assert_eq!(comparison.arrays.mask_lidar, Some(4));
    assert_eq!(comparison.arrays.mask_camera, None);
    let mask = comparison.mask_lidar.unwrap();
    assert_eq!([mask.both, mask.only_a, mask.only_b, mask.neither], [12, 2, 2, 0]);
}

#[test]
fn the_confusion_tells_which_class_became_which() {
    let comparison = Pair::drawn("ccrr............", "crr.............").comparison();
    let semantic = comparison.semantic.clone().unwrap();
    assert_eq!(semantic.confusion[0][..3], [1, 1, 0]);
    assert_eq!(semantic.confusion[1][..3], [0, 1, 1]);
    assert_eq!(semantic.classes[0].iou, Some(0.5));
    let table = comparison.table();
    assert!(table.contains("car to road") && table.contains("road to free"), "{table}");
}

#[test]
fn rays_are_cast_where_origins_are_known() {
    let pair = Pair::drawn("c...............", "................");
    assert!(pair.comparison().rays.is_none());
    let origin = Point3::new(3.5, -0.5, 0.5);
    let rays = |pair: &Pair| pair.difference(&[origin]).comparison(&comparer()).rays.unwrap();
    let missed = rays(&pair);
    assert!(missed.truth_rays[0] > 0);
    assert_eq!((missed.mean, missed.predicted_rays[0]), (Some(0.0), 0));
    let same = rays(&Pair::drawn("c...............", "c..............."));
    assert_eq!(same.mean, Some(1.0));
}

#[test]
fn differences_add_up_in_any_order() {
    let one = Pair::drawn("cr..??..........", ".?r?.c..........").difference(&[]);
    let two = Pair::drawn("ccrr............", "crr.............").difference(&[]);
    let sum = |parts: [&Difference; 2]| {
        let mut sum = Difference::default();
        parts.into_iter().for_each(|part| sum += part);
        sum
    };
    assert_eq!(sum([&one, &two]), sum([&two, &one]));
    assert_eq!(sum([&one, &two]).comparison(&comparer()).keyframes, 2);
}

#[test]
fn another_grid_or_an_unknown_class_is_refused() {
    let pair = Pair::drawn("cr..??..........", ".?r?.c..........");
    let other = GridSpec::new([0.0; 3], [1.0; 3], [1.0; 3]).unwrap();
    let small = VoxelGrid::filled(&other, 0);
    let refused = comparer().compare(
        &ComparedLabels::of(&small),
        &ComparedLabels::of(&pair.semantics[0]),
        &[],
    );
    assert!(refused.is_err());
    let strange = VoxelGrid::filled(&spec(), 7);
    let refused = comparer().compare(
        &ComparedLabels::of(&strange),
        &ComparedLabels::of(&pair.semantics[0]),
        &[],
    );
    assert!(refused.is_err());
}
