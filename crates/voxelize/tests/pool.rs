//! Larger voxels from smaller ones, each block drawn as text: `a b c` occupied by that class, `.`
//! free, `?` unobserved.

use occlabel_core::{Blocks, Evidence, GridSpec, OccupancyLabels, VoxelGrid, VoxelState};
use occlabel_voxelize::pool;

const FREE: u8 = 9;

/// `c` goes before `a` before `b` on ties.
const RANK: [u8; 3] = [1, 2, 0];

/// Blocks of eight voxels along x.
fn row(blocks: &[&str]) -> (OccupancyLabels, Blocks) {
    let count = blocks.len() as f64;
    let spec = GridSpec::new([0.0; 3], [2.0 * count, 2.0, 2.0], [1.0; 3]).unwrap();
    let blocks_of = Blocks::of(&spec, [2.0; 3]).unwrap();
    let voxels: Vec<char> = blocks.iter().flat_map(|block| block.chars()).collect();
    assert_eq!(voxels.len(), spec.len(), "eight voxels a block");
    (labels(&spec, &voxels), blocks_of)
}

fn labels(spec: &GridSpec, voxels: &[char]) -> OccupancyLabels {
    let grid = |f: &dyn Fn(char) -> u8| {
        VoxelGrid::from_values(spec, voxels.iter().map(|&voxel| f(voxel)).collect())
    };
    let states = voxels.iter().map(|voxel| match voxel {
        '?' => VoxelState::Unobserved,
        '.' => VoxelState::Free,
        _ => VoxelState::Occupied,
    });
    let class = |voxel: char| if voxel.is_alphabetic() { voxel as u8 - b'a' } else { FREE };
    OccupancyLabels {
        semantics: grid(&class),
        mask_lidar: grid(&|voxel| u8::from(voxel != '?')),
        mask_camera: grid(&|voxel| u8::from(voxel == 'c')),
        states: VoxelGrid::from_values(spec, states.collect()),
        evidence: None,
    }
}

/// The blocks as text.
fn pooled(blocks: &[&str]) -> String {
    let (labels, blocks) = row(blocks);
    let pooled = pool(&labels, &blocks, FREE, &RANK);
    let letter = |(class, state): (&u8, &VoxelState)| match state {
        VoxelState::Unobserved => '?',
        VoxelState::Free => '.',
        VoxelState::Occupied => char::from(b'a' + class),
    };
    pooled.semantics.values().iter().zip(pooled.states.values()).map(letter).collect()
}

#[test]
fn classes_win_over_free_and_free_over_unobserved() {
    assert_eq!(pooled(&["........", ".......a", "???????b", "???????.", "????????"]), ".ab.?");
}

#[test]
fn the_class_of_most_voxels_wins_and_ties_go_by_priority() {
    assert_eq!(pooled(&["aab.....", "abb.....", "ab......", "bc......", "aabbcc.."]), "abacc");
}

#[test]
fn masks_follow_the_pooled_labels() {
    let (labels, blocks) = row(&["........", "....c???", "????????"]);
    let pooled = pool(&labels, &blocks, FREE, &RANK);
    assert_eq!(pooled.semantics.values(), [FREE, 2, FREE]);
    assert_eq!(pooled.mask_lidar.values(), [1, 1, 0]);
    assert_eq!(pooled.mask_camera.values(), [0, 1, 0]);
}

#[test]
fn evidence_is_pooled_along() {
    let (mut labels, blocks) = row(&["aaaabbc.", "????????"]);
    let spec = GridSpec::new([0.0; 3], [4.0, 2.0, 2.0], [1.0; 3]).unwrap();
    // The places of the first block in the flat array are 0..8: it comes first along x.
    let values = |values: [u16; 8]| {
        VoxelGrid::from_values(&spec, values.into_iter().chain([0; 8]).collect::<Vec<u16>>())
    };
    let flow = |at: usize| match at {
        0 => [5.0; 3],
        3 => [f32::NAN; 3],
        _ => [at as f32, 0.0, 0.0],
    };
    labels.evidence = Some(Evidence {
        hits: values([1, 2, 3, 4, 5, 6, 7, 0]),
        crossings: values([u16::MAX, 1, 0, 0, 0, 0, 0, 0]),
        state: labels.states.map(|state| *state as u8),
        instances: values([0, 4, 4, 4, 5, 5, 5, 0]),
        flow: VoxelGrid::from_values(&spec, (0..16).map(flow).collect()),
        camera_bits: values([1, 0, 4, 0, 0, 0, 0, 0]),
    });
    let pooled = pool(&labels, &blocks, FREE, &RANK).evidence.unwrap();
    assert_eq!(pooled.hits.values(), [28, 0]);
    assert_eq!(pooled.crossings.values(), [u16::MAX, 0]);
    assert_eq!(pooled.state.values(), [2, 0]);
    assert_eq!(pooled.instances.values(), [4, 0], "most of class a, those without do not compete");
    assert_eq!(
        pooled.flow.values()[0],
        [1.5, 0.0, 0.0],
        "of voxels 1 and 2: the flow of 3 is unknown"
    );
    assert_eq!(pooled.camera_bits.values(), [5, 0]);
}

#[test]
fn pooling_twice_keeps_states_as_pooling_once_does() {
    let mut state = 0x9e37_79b9_u64;
    let mut next = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ['a', 'b', '.', '?', '?', '?', '.', '?'][(state >> 61) as usize]
    };
    let fine = GridSpec::new([0.0; 3], [8.0, 8.0, 4.0], [1.0; 3]).unwrap();
    let mut seen = [0; 3];
    for _ in 0..50 {
        let voxels: Vec<char> = (0..fine.len()).map(|_| next()).collect();
        let labels = labels(&fine, &voxels);
        let halves = Blocks::of(&fine, [2.0; 3]).unwrap();
        let quarters = Blocks::of(halves.coarse(), [4.0; 3]).unwrap();
        let twice = pool(&pool(&labels, &halves, FREE, &RANK), &quarters, FREE, &RANK);
        let once = pool(&labels, &Blocks::of(&fine, [4.0; 3]).unwrap(), FREE, &RANK);
        assert_eq!(once.states, twice.states);
        assert_eq!(once.mask_camera, twice.mask_camera);
        once.states.values().iter().for_each(|state| seen[*state as usize] += 1);
    }
    assert_eq!(seen.iter().sum::<u32>(), 50 * 4);
    assert!(seen[2] > 150, "{seen:?}");
}
