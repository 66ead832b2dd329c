//! Any track, at any time.

use std::collections::BTreeMap;

use occlabel_annotate::{BoxSettings, box_at};
use occlabel_core::{Box3, BoxGrowth, BoxTrack, ClassId, GrownBox, Meaning, Timestamp, TrackId};

use super::bytes::Bytes;

/// Where a box stands between its annotations, and what its grown form holds.
pub(super) fn track(bytes: &[u8]) -> bool {
    let mut bytes = Bytes(bytes);
    let settings = BoxSettings {
        max_gap_s: bytes.of([0.0, 0.5, 1.6, 1e12]),
        extrapolate_s: bytes.of([0.0, 0.5, 1e12]),
    };
    let growth = BoxGrowth { scale: bytes.of([1.0, 1.1, 1e-9]), margin_m: bytes.of([0.0, 0.1]) };
    let time = any_time(&mut bytes);
    let origin = bytes.place();
    let track = any_track(&mut bytes, 1, any_time);
    let Some((boxed, _)) = box_at(&track, time, &settings) else { return true };
    let pose = &boxed.world_from_box;
    assert!(pose.translation.vector.iter().all(|metres| metres.is_finite()), "{boxed:?}");
    assert!((pose.rotation.norm() - 1.0).abs() < 1e-9, "{boxed:?}");
    assert!(boxed.size_m.iter().all(|metres| *metres > 0.0), "{boxed:?}");
    let grown = GrownBox::new(&boxed.size_m, &growth);
    let entry = grown.entry(&(pose.inverse() * origin), &(pose.inverse() * bytes.place()));
    assert!(entry.coords.iter().all(|metres| metres.is_finite()), "{boxed:?} {entry}");
    assert!(grown.radius() > 0.0);
    true
}

/// Up to four boxes, in order of time.
pub(super) fn any_track(
    bytes: &mut Bytes,
    id: u16,
    mut time: impl FnMut(&mut Bytes) -> Timestamp,
) -> BoxTrack {
    let count = 1 + bytes.below(4);
    let mut boxed = |bytes: &mut Bytes| {
        (time(bytes), Box3 { world_from_box: bytes.pose(), size_m: bytes.size_m() })
    };
    let boxes: BTreeMap<Timestamp, Box3> = (0..count).map(|_| boxed(bytes)).collect();
    let class = bytes.below(18) as u8;
    BoxTrack {
        id: TrackId(id),
        source_id: id.to_string(),
        category: String::new(),
        meaning: if class == 17 { Meaning::Ignore } else { Meaning::Class(ClassId(class)) },
        boxes: boxes.into_iter().collect(),
    }
}

fn any_time(bytes: &mut Bytes) -> Timestamp {
    match bytes.byte() % 4 {
        0 => Timestamp(bytes.whole()),
        _ => Timestamp(bytes.whole() >> 32),
    }
}
