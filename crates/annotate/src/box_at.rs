//! Boxes between annotations (labels.md section 3).

use nalgebra::{Translation3, Vector3};
use occlabel_core::{Box3, BoxTrack, Pose, Timestamp, slerp};
use serde::{Deserialize, Serialize};

/// How far boxes are carried from their annotated times.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoxSettings {
    /// The longest time between two annotations that is interpolated, seconds.
    pub max_gap_s: f64,
    /// How long a track goes on before its first and after its last annotation, seconds.
    pub extrapolate_s: f64,
}

/// What a box at a time rests on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoxSource {
    /// An annotation at that very time.
    Annotated,
    /// The annotations before and after.
    Interpolated,
    /// The annotations on one side only: good for sorting points, not for placing them.
    Extrapolated,
}

/// The track's box at a time, in world; `None` where the track is absent.
pub fn box_at(
    track: &BoxTrack,
    time: Timestamp,
    settings: &BoxSettings,
) -> Option<(Box3, BoxSource)> {
    let boxes = &track.boxes;
    match boxes.binary_search_by_key(&time, |(annotated, _)| *annotated) {
        Ok(at) => Some((boxes[at].1.clone(), BoxSource::Annotated)),
        Err(next) if next == 0 || next == boxes.len() => {
            Some((extrapolate(boxes, next, time, settings)?, BoxSource::Extrapolated))
        }
        Err(next) => {
            let (a, b) = (&boxes[next - 1], &boxes[next]);
            let is_near = b.0.seconds_since(a.0) <= settings.max_gap_s;
            is_near.then(|| (interpolate(a, b, time), BoxSource::Interpolated))
        }
    }
}

/// Centre and size on the straight line, rotation on the great arc, the short way.
fn interpolate(a: &(Timestamp, Box3), b: &(Timestamp, Box3), time: Timestamp) -> Box3 {
    let w = time.seconds_since(a.0) / b.0.seconds_since(a.0);
    let (from, to) = (&a.1.world_from_box, &b.1.world_from_box);
    let centre = mix(&from.translation.vector, &to.translation.vector, w);
    Box3 {
        world_from_box: Pose::from_parts(centre.into(), slerp(&from.rotation, &to.rotation, w)),
        size_m: mix(&a.1.size_m, &b.1.size_m, w),
    }
}

fn mix(a: &Vector3<f64>, b: &Vector3<f64>, w: f64) -> Vector3<f64> {
    a + (b - a) * w
}

/// The nearest box, its centre moved on; `next` is 0 before the first box, the count after the last.
fn extrapolate(
    boxes: &[(Timestamp, Box3)],
    next: usize,
    time: Timestamp,
    settings: &BoxSettings,
) -> Option<Box3> {
    let (nearest, neighbour) = if next == 0 {
        (boxes.first()?, boxes.get(1))
    } else {
        (boxes.last()?, boxes.len().checked_sub(2).map(|at| &boxes[at]))
    };
    if time.seconds_apart(nearest.0) > settings.extrapolate_s {
        return None;
    }
    let mut boxed = nearest.1.clone();
    let moved = velocity(nearest, neighbour, settings) * time.seconds_since(nearest.0);
    boxed.world_from_box.append_translation_mut(&Translation3::from(moved));
    Some(boxed)
}

/// Between the two annotations, metres per second; zero if there is one only, or a gap.
fn velocity(
    nearest: &(Timestamp, Box3),
    neighbour: Option<&(Timestamp, Box3)>,
    settings: &BoxSettings,
) -> Vector3<f64> {
    let centre = |boxed: &Box3| boxed.world_from_box.translation.vector;
    match neighbour {
        Some(other) if nearest.0.seconds_apart(other.0) <= settings.max_gap_s => {
            (centre(&nearest.1) - centre(&other.1)) / nearest.0.seconds_since(other.0)
        }
        _ => Vector3::zeros(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;
    use occlabel_core::{ClassId, Meaning, TrackId};

    const SETTINGS: BoxSettings = BoxSettings { max_gap_s: 0.6, extrapolate_s: 0.25 };

    fn boxed(x: f64, yaw: f64, length: f64) -> Box3 {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
        Box3 {
            world_from_box: Pose::from_parts(Translation3::new(x, 0.0, 0.0), turn),
            size_m: Vector3::new(length, 2.0, 1.5),
        }
    }

    fn track(boxes: &[(f64, Box3)]) -> BoxTrack {
        BoxTrack {
            id: TrackId(1),
            source_id: "t".into(),
            category: "car".into(),
            meaning: Meaning::Class(ClassId(0)),
            boxes: boxes.iter().map(|(s, boxed)| (seconds(*s), boxed.clone())).collect(),
        }
    }

    fn seconds(s: f64) -> Timestamp {
        Timestamp((s * 1e9) as i64)
    }

    fn x_at(track: &BoxTrack, s: f64) -> Option<f64> {
        box_at(track, seconds(s), &SETTINGS).map(|(boxed, _)| boxed.world_from_box.translation.x)
    }

    #[test]
    fn fault_22_the_left_key_gives_the_left_box_exactly() {
        let car = track(&[(0.0, boxed(1.0, 0.3, 4.0)), (0.5, boxed(6.0, 0.5, 5.0))]);
        for (s, expected) in [(0.0, &car.boxes[0].1), (0.5, &car.boxes[1].1)] {
            let (found, source) = box_at(&car, seconds(s), &SETTINGS).unwrap();
            assert_eq!((&found, source), (expected, BoxSource::Annotated));
        }
        let near_left = x_at(&car, 0.05).unwrap();
        assert!((near_left - 1.5).abs() < 1e-12, "a tenth of the way from the left, {near_left}");
    }

    #[test]
    fn section_3_centre_size_and_rotation_are_interpolated() {
        let car = track(&[(0.0, boxed(1.0, 3.0, 4.0)), (0.5, boxed(6.0, -3.0, 5.0))]);
        let (half, source) = box_at(&car, seconds(0.25), &SETTINGS).unwrap();
        assert_eq!(source, BoxSource::Interpolated);
        assert_eq!((half.world_from_box.translation.x, half.size_m.x), (3.5, 4.5));
        let turned = half.world_from_box.rotation.angle();
        assert!((turned - std::f64::consts::PI).abs() < 1e-9, "the short way is over pi: {turned}");
    }

    #[test]
    fn fault_21_a_gap_is_not_bridged() {
        let car = track(&[(0.0, boxed(0.0, 0.0, 4.0)), (1.0, boxed(9.0, 0.0, 4.0))]);
        assert_eq!(x_at(&car, 0.5), None);
        assert_eq!(x_at(&car, 1.0), Some(9.0));
    }

    #[test]
    fn section_3_the_longest_gap_is_closed() {
        let car = track(&[(0.0, boxed(0.0, 0.0, 4.0)), (0.6, boxed(6.0, 0.0, 4.0))]);
        assert!(x_at(&car, 0.3).is_some());
    }

    #[test]
    fn section_3_outside_its_annotations_a_track_moves_on_for_a_while() {
        let car = track(&[(1.0, boxed(0.0, 0.2, 4.0)), (1.5, boxed(5.0, 0.4, 5.0))]);
        let (after, source) = box_at(&car, seconds(1.75), &SETTINGS).unwrap();
        assert_eq!(source, BoxSource::Extrapolated);
        assert_eq!(after.world_from_box.translation.x, 7.5);
        assert_eq!(
            (after.size_m.x, after.world_from_box.rotation),
            (5.0, car.boxes[1].1.world_from_box.rotation)
        );
        assert_eq!(x_at(&car, 0.75), Some(-2.5));
        assert_eq!((x_at(&car, 1.76), x_at(&car, 0.74)), (None, None));
    }

    #[test]
    fn section_3_a_lone_box_and_one_across_a_gap_are_held_still() {
        let lone = track(&[(1.0, boxed(3.0, 0.0, 4.0))]);
        assert_eq!((x_at(&lone, 0.8), x_at(&lone, 1.2)), (Some(3.0), Some(3.0)));
        let gap = track(&[(0.0, boxed(0.0, 0.0, 4.0)), (1.0, boxed(9.0, 0.0, 4.0))]);
        assert_eq!(x_at(&gap, 1.2), Some(9.0));
    }
}
