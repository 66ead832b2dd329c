//! Points that are no returns of the scene (cases 6 to 11).

use serde_json::{Value, json};

use crate::asserts::{arrays, assert_keyframes, dropped, label, label_into, untouched, warnings};
use crate::support::{Arrays, Point, TestLog, gts_files};

/// Spoils every n-th point.
fn spoil(points: &mut [Point], every: usize, value: f32) -> usize {
    let spoilt = points.iter_mut().step_by(every);
    spoilt.enumerate().map(|(count, point)| point[count % 3] = value).count()
}

#[test]
fn fault_06_points_that_are_not_finite_are_dropped_and_counted() {
    let log = TestLog::nano();
    let (mut nans, mut infinities) = (0, 0);
    log.edit_points(&log.other_files()[0], |points| nans = spoil(points, 10, f32::NAN));
    log.edit_points(&log.key_files()[1], |points| infinities = spoil(points, 7, f32::INFINITY));
    let label = label(&log);
    label.run().exits(0).tells_nothing_of("warning");
    assert!(nans > 50 && infinities > 50);
    assert_eq!(dropped(&label.output, "not_finite"), (nans + infinities) as u64);
    assert_keyframes(&label.output, &log.keyframes());
}

#[test]
fn fault_06_more_than_half_of_them_is_warned_of() {
    let log = TestLog::nano();
    let file = &log.other_files()[0];
    log.edit_points(file, |points| assert!(spoil(points, 1, f32::NEG_INFINITY) > 0));
    let label = label(&log);
    label.run().exits(0).tells(&["warning", file, "NaN or an infinity"]);
    assert_eq!(warnings(&label.output, "sweep-not-finite").len(), 1);
}

#[test]
fn fault_06_dropped_points_change_nothing() {
    let (_log, clean) = untouched(&[]);
    let log = TestLog::nano();
    for file in log.other_files() {
        log.edit_points(&file, |points| points.push([f32::NAN, 1.0, 1.0, 0.0, 3.0]));
    }
    label(&log).run().exits(0);
    assert!(gts_files(&log.beside("out")) == gts_files(&clean.output));
}

#[test]
fn fault_07_far_points_are_dropped_and_counted() {
    let (_log, clean) = untouched(&[]);
    let log = TestLog::nano();
    let far = [[1e7, 0.0, 0.0], [-4e6, 3e6, 4e6], [0.0, f32::MAX, 0.0], [0.0, 0.0, 1000.1]];
    let far = far.map(|[x, y, z]| [x, y, z, 0.0, 3.0]);
    log.edit_points(&log.other_files()[0], |points| points.extend(far));
    let label = label(&log);
    label.run().exits(0);
    assert_eq!(dropped(&label.output, "far") - dropped(&clean.output, "far"), 4);
    assert!(gts_files(&label.output) == gts_files(&clean.output));
}

#[test]
fn fault_07_a_raised_range_clips_far_points_without_overflow() {
    let log = TestLog::nano();
    let ahead = [[8e5, 1e3, -2e3, 0.0, 3.0], [-5e5, -5e5, 4e5, 0.0, 3.0]];
    log.edit_points(&log.other_files()[0], |points| points.extend(ahead));
    let label = label(&log).with(&["--set", "aggregate.max_range_m=838860"]);
    label.run().exits(0);
    assert_eq!(dropped(&label.output, "far"), 0);
    let far = label_into(&log, "far").with(&["--set", "aggregate.max_range_m=838861"]);
    far.run().exits(2).tells(&["aggregate.max_range_m", "2^20"]);
}

/// A place on the earth as the distance from its centre, metres.
const ON_EARTH_M: [f64; 3] = [4_000_000.0, 900_000.0, 4_860_000.0];

#[test]
fn fault_07_a_drive_in_coordinates_of_the_whole_earth_is_labelled_as_one_near_the_origin() {
    let (_log, clean) = untouched(&[]);
    let log = TestLog::nano();
    for table in ["ego_pose", "sample_annotation"] {
        log.edit(table, |rows| rows.iter_mut().for_each(move_away));
    }
    let label = label(&log);
    label.run().exits(0).tells_nothing_of("warning");
    assert_eq!(dropped(&label.output, "far"), dropped(&clean.output, "far"));
    let (mut same, mut occupied) = (0, 0);
    for (near, far) in arrays(&log, &clean).iter().zip(&arrays(&log, &label)) {
        let classes = near.labels.semantics.values().iter().zip(far.labels.semantics.values());
        same += classes.filter(|(near, far)| near == far).count();
        occupied += far.evidence.state.values().iter().filter(|state| **state == 2).count();
    }
    assert!(same * 1000 >= 3 * 40 * 40 * 8 * 998 && occupied > 1000, "{same}, {occupied} occupied");
}

fn move_away(row: &mut Value) {
    for (axis, on_earth_m) in ON_EARTH_M.into_iter().enumerate() {
        let place_m = row["translation"][axis].as_f64().expect("a place") + on_earth_m;
        row["translation"][axis] = json!(place_m);
    }
}

#[test]
fn fault_08_points_at_the_origin_are_dropped_and_counted() {
    let (_log, clean) = untouched(&[]);
    let log = TestLog::nano();
    log.edit_points(&log.other_files()[3], |points| points.extend([[0.0; 5], [-0.0; 5]]));
    let label = label(&log);
    label.run().exits(0);
    assert_eq!(dropped(&label.output, "at_origin"), 2);
    assert!(gts_files(&label.output) == gts_files(&clean.output));
}

#[test]
fn fault_10_a_grid_away_from_the_sensor_is_a_part_of_one_around_it() {
    let (log, around) = untouched(&[]);
    let ahead = label_into(&log, "ahead").with(&["--set", "grid.min_m=[8.0, -16.0, -1.0]"]);
    ahead.run().exits(0);
    let log_of = |label| arrays(&log, label);
    let mut occupied = 0;
    for (whole, part) in log_of(&around).iter().zip(&log_of(&ahead)) {
        assert_eq!(part.evidence.state.shape(), [10, 40, 8]);
        for (x, y, z) in
            (0..10).flat_map(|x| (0..40).flat_map(move |y| (0..8).map(move |z| (x, y, z))))
        {
            let (here, there) = ([x, y, z], [x + 30, y, z]);
            assert_eq!(part.labels.semantics.at(here), whole.labels.semantics.at(there));
            assert_eq!(part.evidence.hits.at(here), whole.evidence.hits.at(there));
            assert_eq!(part.evidence.crossings.at(here), whole.evidence.crossings.at(there));
            occupied += usize::from(*part.evidence.state.at(here) == 2);
        }
    }
    assert!(occupied > 100, "{occupied} occupied voxels");
}

/// Occupied voxels along the ego's lane at the height of its roof: where it was and will be.
fn on_the_lane(arrays: &Arrays) -> usize {
    let lane = (10..30).flat_map(|x| [19, 20].map(|y| [x, y, 3]));
    lane.filter(|voxel| *arrays.evidence.state.at(*voxel) == 2).count()
}

#[test]
fn fault_11_returns_from_the_own_body_leave_no_trail() {
    let (log, filtered) = untouched(&[]);
    assert!(dropped(&filtered.output, "ego") > 20);
    assert_eq!(arrays(&log, &filtered).iter().map(on_the_lane).sum::<usize>(), 0);
    let (log, bare) = untouched(&["--set", "aggregate.ego_box_m=none"]);
    assert_eq!(dropped(&bare.output, "ego"), 0);
    assert!(arrays(&log, &bare).iter().map(on_the_lane).sum::<usize>() > 3);
}
