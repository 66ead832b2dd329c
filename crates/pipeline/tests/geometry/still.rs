//! What stands still: shadows, wedges, tunnels, ground.

use occlabel_core::OccupancyLabels;
use occlabel_testkit::assert_golden;

use crate::scenes::{MANMADE, Stage, TERRAIN, UNOBSERVED, class_at, slab, small, upright};
use crate::{LIDAR_XY, above, beside, one_look, picture, road_with, voxels_above_ground};

#[test]
fn a_wall_throws_a_shadow() {
    let wall = slab(MANMADE, [5.1, -1.3, 0.0], [5.4, 1.3, 4.0]);
    let world = |_| road_with(std::slice::from_ref(&wall));
    let stage = one_look(&world);
    let rules = small(&[]);
    let labels = stage.drive(&[0.0]).label(&rules);

    let [dark, lit, occupied] = stage.check_still(&labels, &rules);
    assert!(
        dark > 500 && lit > 900 && occupied > 300,
        "{dark} dark, {lit} lit, {occupied} occupied"
    );
    shadow_is_the_wedge(&labels, |[x, y]| {
        let reach = (x - LIDAR_XY[0]) / (5.1 - LIDAR_XY[0]);
        let aside = y - LIDAR_XY[1];
        x > 5.4 && (-1.3 - LIDAR_XY[1]) * reach < aside && aside < (1.3 - LIDAR_XY[1]) * reach
    });
    let views = [above(&labels, 3), beside(&labels, 8)];
    assert_golden("geometry/wall.txt", &picture("A wall and its shadow.", &views));
}

/// Columns within the wedge are unobserved in the layers above the ground, columns without are not.
#[track_caller]
fn shadow_is_the_wedge(labels: &OccupancyLabels, is_dark: impl Fn([f64; 2]) -> bool) {
    let (mut within, mut without) = (0, 0);
    for (x, y, z) in voxels_above_ground() {
        let dark = corners_xy(x, y).into_iter().filter(|&corner| is_dark(corner)).count();
        let state = *labels.evidence().state.at([x, y, z]);
        assert!(dark < 4 || state == UNOBSERVED, "{:?} is dark, found {state}", [x, y, z]);
        assert!(dark > 0 || state != UNOBSERVED, "{:?} is lit", [x, y, z]);
        within += usize::from(dark == 4);
        without += usize::from(dark == 0);
    }
    assert!(within > 50 && without > 500, "{within} within the wedge, {without} without");
}

#[test]
fn a_pillar_throws_a_wedge_and_of_two_the_common_part_stays_dark() {
    let pillar = slab(MANMADE, [4.1, -0.9, 0.0], [4.9, -0.1, 5.0]);
    let world = |_| road_with(std::slice::from_ref(&pillar));
    let aside = |time: f64| upright([0.0, 3.0 * time, 0.0], 0.4 * time);
    let rules = small(&[]);
    let seen_from = |sweeps_s: &[f64]| {
        let stage = Stage {
            world: &world,
            map_from_ego: &aside,
            sweeps_s,
            annotated_s: &[],
            step_deg: 1.5,
        };
        let labels = stage.drive(&[0.0]).label(&rules);
        let [dark, lit, occupied] = stage.check_still(&labels, &rules);
        assert!(dark > 350 && lit > 1300 && occupied > 300, "{dark}, {lit}, {occupied}");
        labels
    };
    let (one, two) = (seen_from(&[0.0]), seen_from(&[0.0, 0.5]));
    let wedge = |labels: &OccupancyLabels| {
        voxels_above_ground()
            .filter(|&(x, y, z)| *labels.evidence().state.at([x, y, z]) == UNOBSERVED)
            .count()
    };
    assert!(wedge(&two) < wedge(&one) / 2 && wedge(&two) > 0, "{} of {}", wedge(&two), wedge(&one));
    let views = [above(&one, 3), above(&two, 3)];
    let title = "A pillar and its wedge, seen from one place, then from two (1.5 m to the left).";
    assert_golden("geometry/pillar.txt", &picture(title, &views));
}

#[test]
fn a_tunnel_hides_all_but_what_its_end_lets_through() {
    let shell = [
        slab(MANMADE, [-20.0, 2.1, 0.0], [5.6, 2.4, 2.2]),
        slab(MANMADE, [-20.0, -2.4, 0.0], [5.6, -2.1, 2.2]),
        slab(MANMADE, [-20.0, -2.4, 1.9], [5.6, 2.4, 2.2]),
    ];
    let world = |_| road_with(&shell);
    let stage = one_look(&world);
    let rules = small(&[]);
    let labels = stage.drive(&[0.0]).label(&rules);

    let [dark, lit, occupied] = stage.check_still(&labels, &rules);
    assert!(dark > 900 && lit > 500 && occupied > 300, "{dark}, {lit}, {occupied}");
    let outside = (0..15).flat_map(|x| [0, 1, 2, 13, 14, 15].map(|y| [x, y]));
    let seen = outside.flat_map(|[x, y]| (0..6).map(move |z| [x, y, z]));
    assert_eq!(
        seen.filter(|&voxel| class_at(&labels, voxel) != '?').count(),
        0,
        "through the walls"
    );
    let views = [above(&labels, 3), beside(&labels, 8)];
    assert_golden("geometry/tunnel.txt", &picture("A tunnel with its end 5.6 m ahead.", &views));
}

#[test]
fn ground_on_two_levels_is_ground_on_both() {
    let quay = slab(TERRAIN, [4.3, -30.0, -1.0], [30.0, 30.0, 1.0]);
    let world = |_| road_with(std::slice::from_ref(&quay));
    let stage = one_look(&world);
    let rules = small(&[]);
    let labels = stage.drive(&[0.0]).label(&rules);

    let [dark, lit, occupied] = stage.check_still(&labels, &rules);
    assert!(dark > 700 && lit > 1000 && occupied > 300, "{dark}, {lit}, {occupied}");
    let mut grounded = 0;
    for (x, y) in (0..24).flat_map(|x| (0..16).map(move |y| (x, y))) {
        let column: String = (0..6).map(|z| class_at(&labels, [x, y, z])).collect();
        let expected = match x {
            0..12 => "?=....",
            12 => "?*--..",
            _ => "???-..",
        };
        // Far away, rays are too few to hit every voxel of the ground.
        let fits =
            |(found, expected): (char, char)| expected == '*' || found == expected || found == '.';
        assert!(column.chars().zip(expected.chars()).all(fits), "column ({x}, {y}): {column}");
        grounded += usize::from(column.contains(['=', '-']));
    }
    assert!(grounded > 300, "ground in {grounded} of 384 columns");
    let views = [beside(&labels, 8), above(&labels, 2)];
    assert_golden("geometry/two-levels.txt", &picture("A road, and ground 1 m above it.", &views));
}

/// Lower and upper corner of a voxel of the small grid in x and y, metres.
fn corners_xy(x: usize, y: usize) -> [[f64; 2]; 4] {
    let (x, y) = (x as f64 * 0.5 - 2.0, y as f64 * 0.5 - 4.0);
    [[x, y], [x + 0.5, y], [x, y + 0.5], [x + 0.5, y + 0.5]]
}
