//! The shipped worlds: that they run, that nothing passes through anything, that nothing floats.

use nalgebra::{Point3, Rotation2, Vector2, Vector3};
use occlabel_core::{Box3, Taxonomy};
use occlabel_pipeline::{parse_taxonomy, shipped_taxonomy};
use occlabel_simulate::{Drive, WORLDS, What, World, shipped_world, world_text_with};

/// Worlds are looked at this often, seconds.
const STEP_S: f64 = 0.25;

fn world(name: &str) -> World {
    World::parse(shipped_world(name).unwrap(), name).unwrap_or_else(|fault| panic!("{fault}"))
}

fn taxonomy(world: &World) -> Taxonomy {
    parse_taxonomy(shipped_taxonomy(&world.taxonomy).unwrap(), &world.taxonomy).unwrap()
}

fn drive(name: &str) -> Drive {
    let world = world(name);
    let taxonomy = taxonomy(&world);
    Drive::new(world, &taxonomy).unwrap_or_else(|fault| panic!("{name}: {fault}"))
}

/// The times at which a world is looked at.
fn moments(world: &World) -> impl Iterator<Item = f64> + use<> {
    let count = (world.duration_s / STEP_S).ceil() as usize;
    (0..=count).map(|step| step as f64 * STEP_S)
}

/// The ego as a box: a car's, or what the world says.
fn ego_box(world: &World, time_s: f64) -> Box3 {
    let body = world.ego.body.as_ref();
    let (min, max) = body.map_or(([-1.0, -0.95, 0.1], [3.7, 0.95, 1.6]), |b| (b.min_m, b.max_m));
    let (min, max) = (Vector3::from(min), Vector3::from(max));
    let centre = nalgebra::Translation3::from((min + max) / 2.0);
    Box3 { world_from_box: world.world_from_ego(time_s) * centre, size_m: max - min }
}

/// Whether two boxes overlap, both taken as upright.
fn overlap(a: &Box3, b: &Box3) -> bool {
    let [ca, cb] = [a, b].map(|boxed| boxed.world_from_box.translation.vector);
    let apart_z = (ca.z - cb.z).abs() >= (a.size_m.z + b.size_m.z) / 2.0;
    let axes = [a, b].map(axes_on_map);
    let between = (ca - cb).xy();
    let apart = |axis: &Vector2<f64>| {
        let reach = |of: &[Vector2<f64>; 2], size: &Vector3<f64>| {
            (of[0].dot(axis).abs() * size.x + of[1].dot(axis).abs() * size.y) / 2.0
        };
        between.dot(axis).abs() >= reach(&axes[0], &a.size_m) + reach(&axes[1], &b.size_m)
    };
    !apart_z && !axes.as_flattened().iter().any(apart)
}

fn axes_on_map(boxed: &Box3) -> [Vector2<f64>; 2] {
    let ahead = (boxed.world_from_box.rotation * Vector3::x()).xy().normalize();
    [ahead, Rotation2::new(std::f64::consts::FRAC_PI_2) * ahead]
}

/// Points spread over a box, its faces less a share of it left out.
fn points_in(boxed: &Box3, share: f64) -> impl Iterator<Item = Point3<f64>> + use<> {
    let (pose, half) = (boxed.world_from_box, boxed.size_m * share / 2.0);
    (0..7 * 5 * 5).map(move |at| {
        let [x, y, z] = [at % 7, at / 7 % 5, at / 35].map(f64::from);
        pose * Point3::new(
            (x / 3.0 - 1.0) * half.x,
            (y / 2.0 - 1.0) * half.y,
            (z / 2.0 - 1.0) * half.z,
        )
    })
}

#[test]
fn every_world_drives_and_its_lidars_see() {
    for shipped in WORLDS {
        let drive = drive(shipped.name);
        assert_eq!(drive.world().name, shipped.name);
        assert!(shipped.about().len() > 20 && shipped.text.starts_with("# "), "{}", shipped.name);
        assert!(drive.scene().keyframes.len() >= 4, "{}", shipped.name);
        for lidar in &drive.world().lidars {
            let rays = lidar.pattern.shots() * lidar.pattern.rings();
            let returns = lidar.sweep(drive.world(), 0).len();
            assert!(returns * 2 > rays, "{}: {returns} of {rays}", shipped.name);
        }
    }
}

#[test]
fn nothing_drives_through_anything_that_moves() {
    for shipped in WORLDS {
        let world = world(shipped.name);
        for time_s in moments(&world) {
            let mut boxes: Vec<(&str, Box3)> = vec![("the ego", ego_box(&world, time_s))];
            let stand = |mover: &occlabel_simulate::Mover| mover.box_at(time_s, &world.ground);
            boxes.extend(world.movers.iter().map(|mover| (mover.name.as_str(), stand(mover))));
            for (at, (a, box_a)) in boxes.iter().enumerate() {
                for (b, box_b) in &boxes[at + 1..] {
                    let met = overlap(box_a, box_b);
                    assert!(!met, "{}: {a} meets {b} at {time_s} s", shipped.name);
                }
            }
        }
    }
}

#[test]
fn nothing_drives_through_what_stands_and_nothing_floats() {
    for shipped in WORLDS {
        let world = world(shipped.name);
        for time_s in moments(&world) {
            let instant = world.at(time_s);
            for mover in &world.movers {
                let boxed = mover.box_at(time_s, &world.ground);
                let told = format!("{}: {} at {time_s} s", shipped.name, mover.name);
                for p in points_in(&boxed, 0.98) {
                    let met = instant.contains(&p);
                    let stands = matches!(met, Some(What::Static(_) | What::Ground(_)));
                    assert!(!stands, "{told} is in {met:?} at {p:?}");
                }
                let foot = Point3::new(0.0, 0.0, -boxed.size_m.z / 2.0 - 0.1);
                let below = instant.contains(&(boxed.world_from_box * foot));
                assert!(below.is_some(), "{told} floats");
            }
        }
    }
}

/// The grids that a taxonomy's labels stand in: voxel size and lower edge in the ego frame, metres.
fn grids(taxonomy: &str) -> &'static [[f64; 2]] {
    match taxonomy {
        "occ3d-nuscenes" => &[[0.4, -1.0]],
        _ => &[[0.4, -1.0], [0.2, -2.4], [0.1, 0.0]],
    }
}

#[test]
fn no_band_of_ground_lies_in_a_face_of_voxels() {
    let mut count = 0;
    for shipped in WORLDS {
        let world = world(shipped.name);
        for (band, [size_m, low_m]) in world
            .ground
            .bands
            .iter()
            .flat_map(|band| grids(&world.taxonomy).iter().map(move |grid| (band, grid)))
        {
            let edges = (band.raise_m - world.ego.heave_m.mean - low_m) / size_m;
            let off_m = (edges - edges.round()).abs() * size_m;
            assert!(off_m > 0.009, "{}: {} is {off_m} m off a face", shipped.name, band.class);
            count += 1;
        }
    }
    assert!(count >= 35, "{count}");
}

#[test]
fn the_log_of_the_demo_is_well_under_a_megabyte() {
    let drive = drive("street");
    let points: usize = (0..drive.scene().sweeps.len()).map(|at| drive.points(at).len()).sum();
    // Five f32 a point, as in nuScenes.
    assert!((10_000..40_000).contains(&points), "{points}");
    assert!((4..=6).contains(&drive.scene().keyframes.len()));
}

#[test]
fn a_world_with_settings_is_the_same_world_but_for_them() {
    let text = shipped_world("street").unwrap();
    let with = |set: &str| {
        let text = world_text_with(text, &[set.to_owned()]).unwrap();
        World::parse(&text, "street")
    };
    let (plain, same) = (world("street"), with("duration_s=2.1").unwrap());
    let noisy = with("lidar.*.range_noise_m=0.02").unwrap();
    assert_eq!(plain.lidars[0].sweep(&plain, 3), same.lidars[0].sweep(&same, 3));
    assert_ne!(plain.lidars[0].sweep(&plain, 3), noisy.lidars[0].sweep(&noisy, 3));
    let fault = with("lidar.LIDAR_TOP.speed=3").unwrap_err();
    assert!(fault.record.as_deref().unwrap_or_default().contains("speed"), "{fault}");
}
