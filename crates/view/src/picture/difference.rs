//! Where two label sets differ.

use image::{Rgb, RgbImage};
use occlabel_core::VoxelGrid;

use crate::picture::birds_eye::{cells, map_with_foot, mark_map};
use crate::picture::color::{FREE, UNOBSERVED, lit};
use crate::picture::cubes::Cubes;
use crate::picture::legend::Legend;
use crate::picture::orbit::{Aim, Orbit};
use crate::picture::painted::Painted;
use crate::picture::perspective::mark_ego;
use crate::picture::plate::{Plate, blank};
use crate::picture::sheet::two;

/// How a voxel differs from the first set, A, to the second, B.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Occupied in the second only.
    Gained,
    /// Occupied in the first only.
    Lost,
    /// Occupied in both, by two classes.
    Class,
    /// The same, but observed, seen or labelled in one only.
    Mask,
}

const CHANGES: [(Change, &str, Rgb<u8>); 4] = [
    (Change::Gained, "occupied in B only", Rgb([70, 165, 255])),
    (Change::Lost, "occupied in A only", Rgb([255, 130, 40])),
    (Change::Class, "two classes", Rgb([255, 240, 120])),
    (Change::Mask, "masks differ", Rgb([150, 96, 196])),
];
/// Occupied by one class in both.
const SAME: Rgb<u8> = Rgb([206, 210, 216]);

/// How many voxels changed, and how.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ChangeCounts([u64; 4]);

impl ChangeCounts {
    /// Of one kind of change.
    pub fn of(&self, change: Change) -> u64 {
        self.0[change as usize]
    }
}

/// Two sets of labels of one keyframe.
#[derive(Clone, Copy, Debug)]
pub struct Difference<'a> {
    /// What the other is compared with.
    pub from: Painted<'a>,
    /// The other, of the same grid and classes.
    pub to: Painted<'a>,
}

impl Difference<'_> {
    /// What became of the voxel at a place of the flat array.
    pub fn change(&self, flat: usize) -> Option<Change> {
        match (self.from.class(flat), self.to.class(flat)) {
            (None, Some(_)) => Some(Change::Gained),
            (Some(_), None) => Some(Change::Lost),
            (Some(a), Some(b)) if a != b => Some(Change::Class),
            _ => self.mask_changed(flat).then_some(Change::Mask),
        }
    }

    /// How many voxels changed.
    pub fn counts(&self) -> ChangeCounts {
        let mut counts = ChangeCounts::default();
        let changes = (0..self.from.spec.len()).filter_map(|flat| self.change(flat));
        changes.for_each(|change| counts.0[change as usize] += 1);
        counts
    }

    /// Masks that one set lacks do not count as changed.
    fn mask_changed(&self, flat: usize) -> bool {
        let differ = |a: Option<&VoxelGrid<u8>>, b: Option<&VoxelGrid<u8>>| match (a, b) {
            (Some(a), Some(b)) => (a.values()[flat] != 0) != (b.values()[flat] != 0),
            _ => false,
        };
        let (from, to) = (&self.from, &self.to);
        from.unlabelled(flat) != to.unlabelled(flat)
            || differ(from.mask_lidar, to.mask_lidar)
            || differ(from.mask_camera, to.mask_camera)
    }

    fn check(&self) {
        self.from.check();
        self.to.check();
        assert_eq!(self.from.spec, self.to.spec, "one grid");
    }

    fn occupied(&self, flat: usize) -> bool {
        self.from.class(flat).or(self.to.class(flat)).is_some()
    }

    fn color(&self, flat: usize) -> Rgb<u8> {
        self.change(flat).filter(|change| *change != Change::Mask).map_or(SAME, color_of)
    }
}

fn color_of(change: Change) -> Rgb<u8> {
    CHANGES[change as usize].2
}

impl Plate<'_> {
    /// Where two sets differ, from above and as cubes, counted in the legend. From above a column
    /// shows its topmost change of occupancy or class; else what stands there; else a change of the masks.
    ///
    /// # Panics
    /// If the grids are not of one spec's shape.
    pub fn difference(&self, sets: &Difference, aim: &Aim) -> RgbImage {
        sets.check();
        let above = |room| {
            map_with_foot(&sets.from, room, |size| {
                let mut map = map(sets, size);
                mark_map(&mut map, &sets.from);
                map
            })
        };
        let body = two(self.body_px(), above, |room| cubes(sets, &aim.at(&sets.from, room)));
        self.around(&body, &legend(sets))
    }
}

fn legend(sets: &Difference) -> Legend {
    let counts = sets.counts();
    let entry = |legend: Legend, (change, name, color): &(Change, &str, Rgb<u8>)| {
        legend.with(*color, &format!("{name}: {}", counts.of(*change)))
    };
    let legend = CHANGES.iter().fold(Legend::default(), entry);
    let same = (0..sets.from.spec.len()).filter(|&flat| sets.occupied(flat)).count() as u64
        - CHANGES[..3].iter().map(|(change, ..)| counts.of(*change)).sum::<u64>();
    let legend = legend.with(SAME, &format!("the same in both: {same}"));
    let legend = legend.with(FREE, sets.from.free_name());
    if sets.from.mask_lidar.is_some() { legend.with(UNOBSERVED, "unobserved") } else { legend }
}

fn cubes(sets: &Difference, orbit: &Orbit) -> RgbImage {
    let lens = orbit.lens();
    let mut scene = blank(orbit.width, orbit.height);
    let cubes = Cubes {
        spec: sets.from.spec,
        solid: |flat| sets.occupied(flat),
        color: |flat| sets.color(flat),
        floor: true,
        opacity: 1.0,
    };
    cubes.render(&lens, &mut scene);
    mark_ego(&mut scene, &lens, &sets.from);
    scene
}

/// A column from above: how much it has to tell, and its colour.
type Look = (u8, Rgb<u8>);

fn map(sets: &Difference, (width, height): (u32, u32)) -> RgbImage {
    let [nx, ny, nz] = sets.from.spec.shape();
    let looks: Vec<Look> = (0..nx * ny).map(|at| look_down(sets, at * nz..(at + 1) * nz)).collect();
    RgbImage::from_fn(width, height, |column, row| {
        let under = cells(row, nx, height);
        let beside = cells(column, ny, width);
        let all = under.flat_map(|x| beside.clone().map(move |y| x * ny + y));
        let all = all.map(|at| looks[at]);
        all.max_by_key(|(rank, _)| *rank).expect("a voxel under each pixel").1
    })
}

fn look_down(sets: &Difference, voxels: std::ops::Range<usize>) -> Look {
    let top_down = || voxels.clone().rev();
    let changed = |flat: usize| sets.change(flat).filter(|change| *change != Change::Mask);
    if let Some(change) = top_down().find_map(changed) {
        return (4, color_of(change));
    }
    if let Some(flat) = top_down().find(|&flat| sets.occupied(flat)) {
        let height = (flat - voxels.start + 1) as f64 / voxels.len() as f64;
        return (3, lit(SAME, 0.72 + 0.28 * height));
    }
    let masked = top_down().any(|flat| sets.change(flat).is_some());
    match top_down().any(|flat| sets.from.observed(flat)) {
        _ if masked => (2, color_of(Change::Mask)),
        true => (1, FREE),
        false => (0, UNOBSERVED),
    }
}
