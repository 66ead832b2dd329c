//! Points of no time, which come sorted (labels.md section 4).

use nalgebra::Point3;
use occlabel_core::{
    BackgroundSweep, BoxTrack, ClassId, DropCounts, ObjectSweep, PointCloud, PointLabel, RigidMap,
    Sweep, is_finite,
};

use crate::SplitSweep;

/// The points of a sweep of no time: of `track`, in its box's coordinates and of its class, or else
/// background. What has no finite coordinates or means `ignore` is dropped; no lidar looked at the rest,
/// so neither its range nor the ego's body say anything of it.
///
/// # Panics
/// If the track has no box.
pub fn keep_timeless(sweep: &Sweep, track: Option<&BoxTrack>) -> SplitSweep {
    let mut dropped = DropCounts::default();
    let background = |cloud| BackgroundSweep::new(None, cloud);
    let Some(track) = track else {
        let kept = kept(sweep, &mut dropped, |label| label);
        return SplitSweep { background: background(kept), objects: Vec::new(), dropped };
    };
    let objects = match track.class() {
        Some(class) => {
            vec![object(track, kept(sweep, &mut dropped, |_| class))]
        }
        None => {
            dropped.ignored_track += sweep.cloud.len() as u64;
            Vec::new()
        }
    };
    let nothing = background(PointCloud::with_origins(Vec::new()));
    SplitSweep { background: nothing, objects, dropped }
}

fn object(track: &BoxTrack, cloud: PointCloud<ClassId>) -> ObjectSweep {
    let (_, boxed) = track.boxes.first().expect("a track has a box");
    ObjectSweep { track: track.id, time: None, boxed: boxed.clone(), cloud }
}

/// The points that stay, moved out of the sweep's own frame.
fn kept<L>(
    sweep: &Sweep,
    dropped: &mut DropCounts,
    label: impl Fn(Option<ClassId>) -> L,
) -> PointCloud<L> {
    let place = RigidMap::from(&sweep.header.world_from_lidar());
    let mut kept = PointCloud::with_origins(vec![place.apply(&Point3::origin())]);
    kept.reserve(sweep.cloud.len());
    for (position, raw) in sweep.cloud.positions.iter().zip(&sweep.cloud.labels) {
        match raw {
            _ if !is_finite(position) => dropped.not_finite += 1,
            PointLabel::Ignored => dropped.ignored_label += 1,
            PointLabel::Unlabelled => kept.push(place.apply(position), label(None), 0),
            PointLabel::Class(class) => kept.push(place.apply(position), label(Some(*class)), 0),
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use occlabel_core::{Box3, Meaning, PointsOf, Pose, SweepHeader, Timestamp, TrackId};

    const CAR: ClassId = ClassId(4);

    fn track(meaning: Meaning) -> BoxTrack {
        let boxed = Box3 {
            world_from_box: Pose::translation(50.0, 0.0, 0.0),
            size_m: Vector3::repeat(2.0),
        };
        BoxTrack {
            id: TrackId(3),
            source_id: "car".into(),
            category: "car".into(),
            meaning,
            boxes: vec![(Timestamp(9), boxed)],
        }
    }

    fn keep(points: &[([f64; 3], PointLabel)], track: Option<&BoxTrack>) -> SplitSweep {
        let header = SweepHeader {
            time: Timestamp(0),
            lidar: "world".into(),
            source_id: "s".into(),
            file: "cloud.ply".into(),
            world_from_ego: Pose::identity(),
            ego_from_lidar: Pose::identity(),
            labelled: true,
            points_of: PointsOf::World,
        };
        let positions = points.iter().map(|(p, _)| Point3::from(*p)).collect();
        let labels = points.iter().map(|(_, label)| *label).collect();
        let cloud = PointCloud::from_one_origin(Point3::origin(), positions, labels);
        keep_timeless(&Sweep { header: &header, cloud }, track)
    }

    #[test]
    fn section_4_points_of_no_time_stay_wherever_they_are() {
        let wall = PointLabel::Class(ClassId(15));
        let kept = keep(&[([0.0; 3], wall), ([50.0, 0.0, 0.0], PointLabel::Unlabelled)], None);
        assert_eq!(kept.background.cloud.labels, [Some(ClassId(15)), None]);
        assert_eq!((kept.background.time, kept.dropped), (None, DropCounts::default()));
    }

    #[test]
    fn section_4_a_tracks_points_of_no_time_are_of_its_class_in_its_box() {
        let car = track(Meaning::Class(CAR));
        let kept = keep(&[([0.5, 0.0, 0.0], PointLabel::Class(ClassId(1)))], Some(&car));
        let object = &kept.objects[0];
        assert_eq!((object.track, object.time, object.cloud.labels[0]), (TrackId(3), None, CAR));
        assert_eq!(object.cloud.positions, [Point3::new(0.5, 0.0, 0.0)]);
        assert!(kept.background.cloud.is_empty());
    }

    #[test]
    fn points_of_no_time_that_are_no_points_are_dropped_and_counted() {
        let odd = [
            ([f64::NAN, 0.0, 0.0], PointLabel::Unlabelled),
            ([1.0, 0.0, 0.0], PointLabel::Ignored),
            ([1.0, 0.0, 0.0], PointLabel::Unlabelled),
        ];
        let kept = keep(&odd, None);
        assert_eq!((kept.dropped.not_finite, kept.dropped.ignored_label), (1, 1));
        assert_eq!(kept.background.cloud.len(), 1);
        assert_eq!(keep(&odd, Some(&track(Meaning::Ignore))).dropped.ignored_track, 3);
    }
}
