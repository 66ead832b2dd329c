//! The rules of labels.md section 10, one by one, on rows of voxels whose answer is known by hand.

use occlabel_core::camera::{BodyMask, CameraModel, Intrinsics, Ocam, Pinhole};
use occlabel_core::{Camera, ClassId, ClassSet, GridSpec, Pose, VoxelGrid, VoxelState, VoxelVote};
use occlabel_occlusion::{
    CameraRays, Eye, Lenses, Matter, Occluders, OcclusionSettings, matter, visible,
};

use Matter::{Air, Ground, Solid};

const ROAD: ClassId = ClassId(11);
const POLE: ClassId = ClassId(15);
const EVERY_RAYS: [CameraRays; 3] =
    [CameraRays::OccupiedCenters, CameraRays::AllCenters, CameraRays::Pixels];

const ALL_CENTERS: OcclusionSettings = OcclusionSettings {
    rays: CameraRays::AllCenters,
    occluders: Occluders::All,
    pixel_stride: 1,
    depth_max_m: 100.0,
};

/// Pixels of a square pinhole, the angle from its axis to its borders being 45 degrees.
fn square(pixels: u32) -> Camera {
    pinhole(pixels, pixels, f64::from(pixels) / 2.0)
}

fn pinhole(width: u32, height: u32, f: f64) -> Camera {
    let (cx, cy) = (f64::from(width) / 2.0, f64::from(height) / 2.0);
    let k = [[f, 0.0, cx], [0.0, f, cy], [0.0, 0.0, 1.0]];
    let model = CameraModel::Pinhole(Pinhole::new(Intrinsics::from_matrix(&k).unwrap()));
    Camera { model, width, height, body_mask: None, rolling_shutter: None }
}

/// A camera that looks along the grid's z: its frame is the grid's, moved.
fn eye(camera: &Camera, bit: usize, [x, y, z]: [f64; 3]) -> Eye<'_> {
    Eye { bit, camera, grid_from_camera: Pose::translation(x, y, z) }
}

/// Voxels of 1 m from 0.
fn grid(shape: [usize; 3]) -> GridSpec {
    GridSpec::new([0.0; 3], shape.map(|n| n as f64), [1.0; 3]).unwrap()
}

/// What a camera in the lowest voxel of a column sees of it.
fn seen_in_column<const N: usize>(column: [Matter; N], settings: &OcclusionSettings) -> Vec<u16> {
    let spec = grid([1, 1, N]);
    let matter = VoxelGrid::from_values(&spec, column.to_vec());
    visible(&[eye(&square(101), 0, [0.5; 3])], &Lenses::default(), &spec, &matter, settings)
        .into_values()
}

/// Bits of a grid, of which the given voxels are solid.
fn bits(eyes: &[Eye], spec: &GridSpec, solid: &[[i64; 3]], rays: CameraRays) -> VoxelGrid<u16> {
    visible(
        eyes,
        &Lenses::default(),
        spec,
        &solids(spec, solid),
        &OcclusionSettings { rays, ..ALL_CENTERS },
    )
}

fn solids(spec: &GridSpec, solid: &[[i64; 3]]) -> VoxelGrid<Matter> {
    let matter = spec.voxels().map(|voxel| if solid.contains(&voxel.0) { Solid } else { Air });
    VoxelGrid::from_values(spec, matter.collect())
}

#[test]
fn section_10_the_first_voxel_that_blocks_is_seen_and_ends_the_ray() {
    for rays in EVERY_RAYS {
        let settings = OcclusionSettings { rays, ..ALL_CENTERS };
        let seen = seen_in_column([Air, Air, Solid, Air, Solid], &settings);
        assert_eq!(seen, [1, 1, 1, 0, 0], "{rays:?}");
    }
}

#[test]
fn section_10_the_cameras_own_voxel_is_seen_and_never_blocks() {
    for (rays, own) in EVERY_RAYS.into_iter().flat_map(|rays| [(rays, Solid), (rays, Ground)]) {
        let settings = OcclusionSettings { rays, ..ALL_CENTERS };
        let seen = seen_in_column([own, Air, Solid, Air], &settings);
        assert_eq!(seen, [1, 1, 1, 0], "{rays:?}, {own:?}");
    }
}

#[test]
fn section_10_one_cameras_own_voxel_blocks_the_other_camera() {
    let (spec, camera) = (grid([1, 1, 5]), square(101));
    let eyes = [eye(&camera, 0, [0.5; 3]), eye(&camera, 1, [0.5, 0.5, 2.5])];
    let seen = bits(&eyes, &spec, &[[0, 0, 2]], CameraRays::AllCenters);
    assert_eq!(seen.values(), [0b01, 0b01, 0b11, 0b10, 0b10]);
}

#[test]
fn section_10_unobserved_voxels_never_block() {
    let spec = grid([1, 1, 5]);
    let states = [
        VoxelState::Free,
        VoxelState::Unobserved,
        VoxelState::Free,
        VoxelState::Occupied,
        VoxelState::Unobserved,
    ];
    // A vote alone does not make a voxel occupied.
    let votes = vec![Some(VoxelVote { class: POLE, instance: None }); 5];
    let matter = matter(
        &VoxelGrid::from_values(&spec, states.to_vec()),
        &VoxelGrid::from_values(&spec, votes),
        &ClassSet::default(),
    );
    assert_eq!(matter.values(), [Air, Air, Air, Solid, Air]);
    let seen = visible(
        &[eye(&square(101), 0, [0.5; 3])],
        &Lenses::default(),
        &spec,
        &matter,
        &ALL_CENTERS,
    );
    assert_eq!(seen.values(), [1, 1, 1, 1, 0]);
}

#[test]
fn section_10_ground_is_what_is_occupied_by_a_flat_class() {
    let spec = grid([1, 1, 4]);
    let [occupied, free] = [VoxelState::Occupied, VoxelState::Free];
    let vote = |class| Some(VoxelVote { class, instance: None });
    let flat: ClassSet = [ROAD].into_iter().collect();
    let matter = matter(
        &VoxelGrid::from_values(&spec, vec![occupied, occupied, free, free]),
        &VoxelGrid::from_values(&spec, vec![vote(ROAD), vote(POLE), vote(ROAD), None]),
        &flat,
    );
    assert_eq!(matter.values(), [Ground, Solid, Air, Air]);
}

#[test]
fn section_10_non_flat_shows_ground_wherever_in_view_and_looks_through_it() {
    for rays in EVERY_RAYS {
        let column = [Air, Ground, Air, Solid, Ground, Air];
        let non_flat = OcclusionSettings { rays, occluders: Occluders::NonFlat, ..ALL_CENTERS };
        assert_eq!(seen_in_column(column, &non_flat), [1, 1, 1, 1, 1, 0], "{rays:?}");
        let all = OcclusionSettings { rays, ..ALL_CENTERS };
        assert_eq!(seen_in_column(column, &all), [1, 1, 0, 0, 0, 0], "{rays:?}");
        let near = OcclusionSettings { depth_max_m: 3.9, ..non_flat };
        assert_eq!(seen_in_column(column, &near), [1, 1, 1, 1, 0, 0], "{rays:?}: not in view");
    }
}

#[test]
fn section_10_each_of_the_rays_casts_its_own() {
    let seen = |column: [Matter; 4], rays| {
        seen_in_column(column, &OcclusionSettings { rays, ..ALL_CENTERS })
    };
    assert_eq!(seen([Air; 4], CameraRays::OccupiedCenters), [0; 4], "none to cast");
    assert_eq!(seen([Air; 4], CameraRays::AllCenters), [1; 4]);
    assert_eq!(seen([Air; 4], CameraRays::Pixels), [1; 4]);
    let to_the_middle = [Air, Air, Solid, Air];
    assert_eq!(seen(to_the_middle, CameraRays::OccupiedCenters), [1, 1, 1, 0]);
}

#[test]
fn section_10_the_depth_is_closed() {
    let depth = |depth_max_m| OcclusionSettings { depth_max_m, ..ALL_CENTERS };
    assert_eq!(seen_in_column([Air; 5], &depth(3.0)), [1, 1, 1, 1, 0]);
    assert_eq!(seen_in_column([Air; 5], &depth(2.999_999)), [1, 1, 1, 0, 0]);
    assert_eq!(seen_in_column([Air; 5], &depth(0.5)), [0; 5], "no ray at all");
}

#[test]
fn section_10_the_depth_is_euclids() {
    // 3 m across and 4 m ahead are 5 m.
    let (spec, camera) = (grid([4, 1, 5]), square(101));
    let sees_it = |depth_max_m| {
        let rays = CameraRays::OccupiedCenters;
        let settings = OcclusionSettings { rays, depth_max_m, ..ALL_CENTERS };
        let matter = solids(&spec, &[[3, 0, 4]]);
        *visible(&[eye(&camera, 0, [0.5; 3])], &Lenses::default(), &spec, &matter, &settings)
            .at([3, 0, 4])
            == 1
    };
    assert!(sees_it(5.0));
    assert!(!sees_it(4.999_999));
}

#[test]
fn section_10_pixel_rays_are_as_long_as_the_depth() {
    let pixels = |depth_max_m| {
        let rays = CameraRays::Pixels;
        let settings = OcclusionSettings { rays, depth_max_m, ..ALL_CENTERS };
        seen_in_column([Air; 5], &settings)
    };
    // The middle pixel of 101 looks straight ahead from z = 0.5.
    assert_eq!(pixels(2.4), [1, 1, 1, 0, 0], "to z = 2.9");
    assert_eq!(pixels(2.6), [1, 1, 1, 1, 0], "to z = 3.1");
    assert_eq!(pixels(0.3), [1, 0, 0, 0, 0], "within the camera's own voxel");
}

#[test]
fn section_10_a_voxel_behind_the_body_mask_is_not_in_view() {
    let (spec, places) = (grid([3, 1, 3]), [[0, 0, 2], [1, 0, 2], [2, 0, 2]]);
    // Two metres ahead the three columns of the image are the three voxels.
    let bare = pinhole(3, 1, 2.0);
    let covered = vec![false, false, true];
    let masked = Camera { body_mask: Some(BodyMask::new(3, 1, covered).unwrap()), ..bare.clone() };
    let eyes = [eye(&bare, 0, [1.5, 0.5, 0.5]), eye(&masked, 1, [1.5, 0.5, 0.5])];
    for rays in EVERY_RAYS {
        let seen = bits(&eyes, &spec, &places, rays);
        assert_eq!(places.map(|v| *seen.at(v.map(|i| i as usize))), [3, 3, 1], "{rays:?}");
    }
    let ground = solids(&spec, &places).map(|m| if *m == Solid { Ground } else { Air });
    let non_flat = OcclusionSettings { occluders: Occluders::NonFlat, ..ALL_CENTERS };
    let seen = visible(&eyes, &Lenses::default(), &spec, &ground, &non_flat);
    assert_eq!(places.map(|v| *seen.at(v.map(|i| i as usize))), [3, 3, 1], "ground");
}

#[test]
fn section_10_a_camera_that_is_all_body_sees_nothing() {
    let covered = BodyMask::new(101, 101, vec![true; 101 * 101]).unwrap();
    let camera = Camera { body_mask: Some(covered), ..square(101) };
    for rays in EVERY_RAYS {
        let seen = bits(&[eye(&camera, 0, [0.5; 3])], &grid([1, 1, 3]), &[[0, 0, 2]], rays);
        assert_eq!(seen.values(), [0; 3], "{rays:?}");
    }
}

#[test]
fn section_10_bits_stand_by_camera_index_and_stay_0_without_an_exposure() {
    let (spec, camera) = (grid([1, 1, 4]), square(101));
    let eyes = [eye(&camera, 15, [0.5, 0.5, 1.5]), eye(&camera, 2, [0.5; 3])];
    let seen = bits(&eyes, &spec, &[], CameraRays::AllCenters);
    assert_eq!(seen.values(), [1 << 2, 1 << 15 | 1 << 2, 1 << 15 | 1 << 2, 1 << 15 | 1 << 2]);
    assert_eq!(bits(&[], &spec, &[], CameraRays::AllCenters).values(), [0; 4]);
}

#[test]
fn section_10_nothing_lies_behind_a_pinhole_or_beside_it() {
    let (spec, camera) = (grid([3, 1, 3]), square(100));
    let places = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 0, 1], [2, 0, 1]];
    let seen =
        bits(&[eye(&camera, 0, [1.5, 0.5, 1.5])], &spec, &places, CameraRays::OccupiedCenters);
    assert_eq!(seen.values(), [0; 9]);
}

#[test]
fn section_10_the_image_is_half_open() {
    let (spec, camera) = (grid([3, 1, 2]), square(100));
    let eyes = [eye(&camera, 0, [1.5, 0.5, 0.5])];
    // 45 degrees to the left are column 0, to the right column 100 of 0..100.
    let sees = |voxel: [usize; 3]| {
        let solid = [voxel.map(|i| i as i64)];
        *bits(&eyes, &spec, &solid, CameraRays::OccupiedCenters).at(voxel)
    };
    assert_eq!([[0, 0, 1], [1, 0, 1], [2, 0, 1]].map(sees), [1, 1, 0]);
}

#[test]
fn section_10_an_omnidirectional_camera_sees_up_to_its_angle() {
    // The radius grows with the angle to beyond 100 degrees; 90 degrees are 200 pixels.
    let model = |max_angle| {
        Ocam::new(&[100.0, 0.0, -0.0025], [300.0; 2], [1.0, 0.0, 0.0], max_angle).unwrap()
    };
    let sees = |max_angle: f64, voxel: [usize; 3]| {
        let model = CameraModel::Ocam(model(max_angle));
        let (width, height, body_mask) = (600, 600, None);
        let camera = Camera { model, width, height, body_mask, rolling_shutter: None };
        let eyes = [eye(&camera, 0, [4.5, 0.5, 1.5])];
        let solid = [voxel.map(|i| i as i64)];
        *bits(&eyes, &grid([5, 1, 3]), &solid, CameraRays::OccupiedCenters).at(voxel)
    };
    let (ahead, beside, behind) = ([0, 0, 2], [0, 0, 1], [0, 0, 0]);
    let degrees = |degrees: f64| degrees.to_radians();
    // Behind is 90 degrees and atan(1 / 4) = 14.04 more.
    assert_eq!([ahead, beside, behind].map(|v| sees(degrees(105.0), v)), [1, 1, 1]);
    assert_eq!([ahead, beside, behind].map(|v| sees(degrees(104.0), v)), [1, 1, 0]);
    assert_eq!([ahead, beside, behind].map(|v| sees(degrees(89.0), v)), [1, 0, 0]);
}

#[test]
fn section_10_the_pixel_stride_picks_pixels_0_s_2s() {
    // At 10 m the pixels of 6 x 6 are as large as voxels: pixel (i, j) looks at voxel (i, j, 10).
    let (spec, camera) = (grid([6, 6, 11]), pinhole(6, 6, 10.0));
    for stride in 1..8 {
        let (rays, depth_max_m) = (CameraRays::Pixels, 10.45);
        let settings = OcclusionSettings { rays, pixel_stride: stride, depth_max_m, ..ALL_CENTERS };
        let eyes = [eye(&camera, 0, [3.0, 3.0, 0.5])];
        let seen = visible(&eyes, &Lenses::default(), &spec, &solids(&spec, &[]), &settings);
        for (i, j) in (0..6).flat_map(|i| (0..6).map(move |j| (i, j))) {
            let is_picked = i % stride == 0 && j % stride == 0;
            assert_eq!(*seen.at([i, j, 10]), u16::from(is_picked), "({i}, {j}) by {stride}");
        }
    }
}

#[test]
fn section_10_a_camera_outside_the_grid_looks_into_it() {
    for rays in EVERY_RAYS {
        let (spec, camera) = (grid([1, 1, 4]), square(101));
        let outside = [eye(&camera, 0, [0.5, 0.5, -5.5])];
        assert_eq!(bits(&outside, &spec, &[[0, 0, 2]], rays).values(), [1, 1, 1, 0], "{rays:?}");
        let beyond = [eye(&camera, 0, [0.5, 0.5, 5.5])];
        assert_eq!(bits(&beyond, &spec, &[[0, 0, 2]], rays).values(), [0; 4], "{rays:?}");
    }
}

#[test]
fn section_10_ties_step_x_before_y_before_z_away_from_the_camera() {
    let (spec, camera) = (grid([3, 1, 3]), pinhole(300, 300, 100.0));
    let eyes = [eye(&camera, 0, [0.5; 3])];
    let rays = CameraRays::OccupiedCenters;
    let seen = bits(&eyes, &spec, &[[1, 0, 1]], rays);
    assert_eq!(seen.values(), [1, 0, 0, 1, 1, 0, 0, 0, 0], "(0, 0, 0), (1, 0, 0), (1, 0, 1)");
    let hidden = bits(&eyes, &spec, &[[1, 0, 0], [1, 0, 1]], rays);
    assert_eq!(hidden.values(), [1, 0, 0, 1, 0, 0, 0, 0, 0], "the corner's voxel blocks");
}
