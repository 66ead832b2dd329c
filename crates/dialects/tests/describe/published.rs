//! A file with the statistics of the one Occ3D-nuScenes file that public code repositories hold, built
//! from its description: counts by class and height, masks.

use occlabel_labels::NumberArray;

use crate::{Saved, rules_of};

const SHAPE: [usize; 3] = [200, 200, 16];
const FREE: u8 = 17;
const ROAD: u8 = 11;
const SIDEWALK: u8 = 13;
const TERRAIN: u8 = 14;
const MANMADE: u8 = 15;
const VEGETATION: u8 = 16;
const CAR: u8 = 4;

/// Free voxels that a lidar observed, by height.
const FREE_BY_LEVEL: [usize; 16] =
    [0, 0, 51, 486, 2272, 5866, 5216, 3658, 1924, 768, 210, 37, 2, 1, 0, 0];

/// The arrays of a file.
struct Arrays {
    semantics: Vec<u8>,
    lidar: Vec<u8>,
    camera: Vec<u8>,
}

impl Arrays {
    /// All free and unobserved.
    fn new() -> Self {
        let voxels = SHAPE.iter().product();
        Self { semantics: vec![FREE; voxels], lidar: vec![0; voxels], camera: vec![0; voxels] }
    }

    /// Gives so many voxels of a level, from a column on, a class; those that a lidar observed, and of
    /// them those that a camera sees, come first.
    fn lay(&mut self, class: u8, level: usize, from: usize, [all, lidar, camera]: [usize; 3]) {
        for at in 0..all {
            let voxel = (from + at) * SHAPE[2] + level;
            assert_eq!((self.semantics[voxel], self.lidar[voxel]), (FREE, 0), "{class} at {level}");
            self.semantics[voxel] = class;
            self.lidar[voxel] = u8::from(at < lidar);
            self.camera[voxel] = u8::from(at < camera);
        }
    }

    /// What the published file holds: road under the ego, things on it, houses and trees beside it.
    fn published() -> Self {
        let mut arrays = Self::new();
        arrays.lay(ROAD, 0, 0, [11_570, 9_070, 9_070]);
        arrays.lay(SIDEWALK, 0, 11_570, [427, 169, 118]);
        arrays.lay(TERRAIN, 0, 12_000, [222, 0, 0]);
        arrays.lay(CAR, 1, 100, [2_888, 2_888, 2_601]);
        arrays.lay(MANMADE, 1, 13_000, [12_000, 12_000, 11_075]);
        arrays.lay(VEGETATION, 2, 13_000, [11_983, 11_983, 0]);
        arrays.lay(VEGETATION, 5, 30_000, [2, 0, 0]);
        for (level, count) in FREE_BY_LEVEL.iter().enumerate() {
            arrays.lay(FREE, level, 31_000, [*count; 3]);
        }
        arrays
    }

    fn saved(&self) -> Saved {
        let array = |values: &[u8]| NumberArray::new(&SHAPE, values);
        Saved::npz(&[
            ("semantics", array(&self.semantics)),
            ("mask_lidar", array(&self.lidar)),
            ("mask_camera", array(&self.camera)),
        ])
    }
}

#[test]
fn the_published_file_is_occ3d_nuscenes_with_one_suspicion() {
    let told = Arrays::published().saved().describe();
    assert_eq!(told.dialects, ["occ3d-nuscenes"]);
    assert_eq!(rules_of(&told), ["occupied-outside-mask-lidar"]);
    let suspicion = &told.suspicions[0];
    assert_eq!((suspicion.count, suspicion.of), (2_982, 39_092));
    let text = "2982 of 39092 occupied voxels are outside mask_lidar, 2980 of them ground";
    assert_eq!(suspicion.text, text);

    let contents = told.contents.expect("contents");
    assert_eq!((contents.voxels, contents.free, contents.keyframes), (640_000, 17, 1));
    assert_eq!((contents.grid.frame.as_str(), contents.grid.shape), ("ego", SHAPE));
    let states = contents.states;
    assert_eq!((states.occupied, states.free, states.no_label), (39_092, 20_491, 0));
    assert_eq!(states.unobserved, Some(640_000 - 39_092 - 20_491));
    let names: Vec<_> = contents.classes.iter().map(|class| class.name.as_str()).collect();
    let by_count = ["manmade", "vegetation", "driveable_surface", "car", "sidewalk", "terrain"];
    assert_eq!(names, by_count);
}

#[test]
fn where_all_that_is_occupied_was_observed_nothing_is_suspicious() {
    let mut arrays = Arrays::published();
    for (class, seen) in arrays.semantics.iter().zip(&mut arrays.lidar) {
        *seen |= u8::from(*class != FREE);
    }
    let told = arrays.saved().describe();
    assert_eq!(told.dialects, ["occ3d-nuscenes"]);
    assert_eq!(rules_of(&told), [""; 0]);
    assert!(told.to_string().ends_with("nothing suspicious"), "{told}");
}

#[test]
fn a_file_on_its_head_is_known_by_its_road() {
    let mut arrays = Arrays::published();
    for values in [&mut arrays.semantics, &mut arrays.lidar, &mut arrays.camera] {
        values.chunks_exact_mut(SHAPE[2]).for_each(<[u8]>::reverse);
    }
    let told = arrays.saved().describe();
    assert_eq!(rules_of(&told), ["axis-reversed", "occupied-outside-mask-lidar"]);
    assert_eq!(told.suspicions[0].count, 2_888);
}
