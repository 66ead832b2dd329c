//! The tree of coordinate frames over time.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Quaternion, Translation3, UnitQuaternion};
use occlabel_core::{Fault, Pose, Timestamp, slerp};

use super::messages::RawPose;
use crate::transform::is_place;

/// A quaternion's norm may be off by this much: rounding of 32-bit numbers and printed digits.
const SILENT_NORM_ERROR: f64 = 1e-6;
/// A norm off by more than this tells no rotation.
const LARGEST_NORM_ERROR: f64 = 1e-2;

/// Frames, and how they stand in each other.
#[derive(Debug, Default)]
pub(super) struct Frames {
    /// By child, by parent: `parent_from_child` at times.
    links: BTreeMap<String, BTreeMap<String, Vec<(Timestamp, Pose)>>>,
    /// Poses are interpolated over no longer time, seconds.
    max_gap_s: f64,
}

impl Frames {
    /// No frames yet.
    pub(super) fn new(max_gap_s: f64) -> Self {
        Self { links: BTreeMap::new(), max_gap_s }
    }

    /// Adds how a child stands in its parent at a time.
    pub(super) fn add(&mut self, parent: &str, child: &str, time: Timestamp, pose: Pose) {
        let parents = self.links.entry(child.to_owned()).or_default();
        parents.entry(parent.to_owned()).or_default().push((time, pose));
    }

    /// Puts all in order of time; of several poses at one time the last counts. One that never
    /// changes stands at all times.
    pub(super) fn finish(&mut self) {
        for poses in self.links.values_mut().flat_map(BTreeMap::values_mut) {
            poses.reverse();
            poses.sort_by_key(|(time, _)| *time);
            poses.dedup_by_key(|(time, _)| *time);
            if poses.iter().all(|(_, pose)| *pose == poses[0].1) {
                poses.truncate(1);
            }
        }
    }

    /// Frames that stand in several: which one counts is the first by name.
    pub(super) fn ambiguous(&self, place: &str) -> Vec<Fault> {
        let several = self.links.iter().filter(|(_, parents)| parents.len() > 1);
        let fault = |(child, parents): (&String, &BTreeMap<_, _>)| {
            let found = parents.keys().map(String::as_str).collect::<Vec<_>>().join(", ");
            Fault::new("frame-parents", place, format!("one parent of frame `{child}`"), found)
        };
        several.map(fault).collect()
    }

    /// A line for each frame: how it stands in its parent.
    pub(super) fn describe(&self) -> Vec<String> {
        let links = self.links.iter().flat_map(|(child, parents)| {
            parents.iter().map(move |(parent, poses)| (child, parent, poses.len()))
        });
        let line = |(child, parent, poses): (&String, &String, usize)| match poses {
            1 => format!("frame {child} in {parent}: fixed"),
            _ => format!("frame {child} in {parent}: {poses} poses"),
        };
        links.map(line).collect()
    }

    /// The frame, its parent, its parent's parent, and so on.
    pub(super) fn ancestors<'a>(&'a self, frame: &'a str) -> Vec<&'a str> {
        let (mut chain, mut seen) = (vec![frame], BTreeSet::from([frame]));
        let mut child = frame;
        while let Some((parent, _)) = self.parent(child) {
            if !seen.insert(parent) {
                break;
            }
            chain.push(parent);
            child = parent;
        }
        chain
    }

    /// What a chain of ancestors stands in, and whether it ends.
    pub(super) fn told(&self, chain: &[&str]) -> String {
        let last = chain[chain.len() - 1];
        let end = match self.parent(last) {
            Some((parent, _)) => format!("`{last}` in `{parent}` again, a ring"),
            None => format!("`{last}` in none"),
        };
        let steps = chain.windows(2).map(|pair| format!("`{}` in `{}`, ", pair[0], pair[1]));
        steps.collect::<String>() + &end
    }

    fn parent(&self, child: &str) -> Option<(&str, &[(Timestamp, Pose)])> {
        let (parent, poses) = self.links.get(child)?.first_key_value()?;
        Some((parent, poses))
    }

    /// Whether a frame moves within its parent.
    pub(super) fn moves(&self, frame: &str) -> bool {
        self.parent(frame).is_some_and(|(_, poses)| poses.len() > 1)
    }

    /// `to_from_from` at a time.
    ///
    /// # Errors
    /// What was found, if the frames do not stand in one tree, or one of them has no pose then.
    pub(super) fn pose(&self, to: &str, from: &str, time: Timestamp) -> Result<Pose, String> {
        let (up_to, up_from) = (self.ancestors(to), self.ancestors(from));
        let Some(common) = up_from.iter().find(|frame| up_to.contains(frame)) else {
            let (from_chain, to_chain) = (self.told(&up_from), self.told(&up_to));
            return Err(format!("no way from `{from}` to `{to}`: {from_chain}, but {to_chain}"));
        };
        let down = self.climb(&up_to, common, time)?;
        let up = self.climb(&up_from, common, time)?;
        Ok(if to == *common { up } else { down.inverse() * up })
    }

    /// `top_from_first` of a chain of ancestors.
    fn climb(&self, chain: &[&str], top: &str, time: Timestamp) -> Result<Pose, String> {
        let mut top_from_first = Pose::identity();
        for child in chain.iter().take_while(|frame| **frame != top) {
            let Some((parent, poses)) = self.parent(child) else { break };
            let pose = self
                .at(poses, time)
                .map_err(|why| format!("{why} of `{child}` in `{parent}` at {} ns", time.0))?;
            top_from_first = if *child == chain[0] { pose } else { pose * top_from_first };
        }
        Ok(top_from_first)
    }

    fn at(&self, poses: &[(Timestamp, Pose)], time: Timestamp) -> Result<Pose, String> {
        if let [(_, only)] = poses {
            return Ok(*only);
        }
        let after = poses.partition_point(|(at, _)| *at < time);
        let Some((end, last)) = poses.get(after) else { return Err("no more pose".into()) };
        if *end == time {
            return Ok(*last);
        }
        let Some((begin, first)) = after.checked_sub(1).map(|before| &poses[before]) else {
            return Err("no pose yet".into());
        };
        let gap_s = end.seconds_since(*begin);
        if gap_s > self.max_gap_s {
            return Err(format!("a gap of {gap_s:.3} s between poses"));
        }
        let w = time.seconds_since(*begin) / gap_s;
        let place = first.translation.vector.lerp(&last.translation.vector, w);
        Ok(Pose::from_parts(place.into(), slerp(&first.rotation, &last.rotation, w)))
    }
}

/// A pose as written, checked, and its rotation's norm if that is worth a word.
///
/// # Errors
/// What was found, if it is none.
pub(super) fn checked_pose(raw: &RawPose) -> Result<(Pose, Option<f64>), String> {
    let RawPose { translation, rotation: [x, y, z, w] } = *raw;
    if !is_place(&translation) {
        return Err(format!("a translation {translation:?}"));
    }
    let rotation = Quaternion::new(w, x, y, z);
    let norm = rotation.norm();
    let off = (norm - 1.0).abs();
    if off.is_nan() || off > LARGEST_NORM_ERROR {
        return Err(format!("a quaternion of norm {norm}"));
    }
    let rotation = UnitQuaternion::new_normalize(rotation);
    let pose = Pose::from_parts(Translation3::from(translation), rotation);
    Ok((pose, (off > SILENT_NORM_ERROR).then_some(norm)))
}

#[cfg(test)]
mod tests {
    use nalgebra::{Point3, Vector3};

    use super::*;

    fn turned(x: f64, yaw: f64) -> Pose {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
        Pose::from_parts(Translation3::new(x, 0.0, 0.0), turn)
    }

    /// map -> base (moves from x = 0 to 10 within 1 s, turning left by 1 rad) -> mast -> lidar.
    fn frames() -> Frames {
        let mut frames = Frames::new(1.0);
        frames.add("map", "base", Timestamp(1_000_000_000), turned(10.0, 1.0));
        frames.add("map", "base", Timestamp(0), turned(0.0, 0.0));
        frames.add("base", "mast", Timestamp(5), turned(2.0, 0.5));
        frames.add("mast", "lidar", Timestamp(0), turned(1.0, 0.0));
        frames.add("base", "camera", Timestamp(0), turned(-1.0, 0.0));
        frames.finish();
        frames
    }

    #[test]
    fn poses_chain_and_are_interpolated() {
        let (frames, half) = (frames(), Timestamp(500_000_000));
        let map_from_base = frames.pose("map", "base", half).unwrap();
        assert!((map_from_base.translation.x - 5.0).abs() < 1e-12);
        assert!((map_from_base.rotation.angle() - 0.5).abs() < 1e-12);
        let expected = turned(5.0, 0.5) * turned(2.0, 0.5) * turned(1.0, 0.0) * Point3::origin();
        let origin = frames.pose("map", "lidar", half).unwrap() * Point3::origin();
        assert!((origin - expected).norm() < 1e-12, "{origin}");
        let sideways = frames.pose("camera", "mast", Timestamp(-9)).unwrap();
        assert!((sideways.translation.x - 3.0).abs() < 1e-12, "no map on the way");
        assert_eq!(frames.ancestors("lidar"), ["lidar", "mast", "base", "map"]);
    }

    #[test]
    fn nothing_is_known_beyond_the_poses_in_gaps_and_between_trees() {
        let mut frames = frames();
        assert!(frames.pose("map", "lidar", Timestamp(-1)).unwrap_err().contains("no pose yet"));
        let late = frames.pose("base", "map", Timestamp(1_000_000_001)).unwrap_err();
        assert!(late.contains("no more pose of `base`"), "{late}");
        assert_eq!(
            frames.pose("map", "roof", Timestamp(0)).unwrap_err(),
            "no way from `roof` to `map`: `roof` in none, but `map` in none"
        );
        frames.max_gap_s = 0.9;
        assert!(frames.pose("map", "base", Timestamp(5)).unwrap_err().contains("gap of 1.000 s"));
        assert!(frames.pose("map", "base", Timestamp(0)).is_ok());
    }

    #[test]
    fn a_ring_of_frames_ends() {
        let mut frames = Frames::new(1.0);
        frames.add("a", "b", Timestamp(0), Pose::identity());
        frames.add("b", "a", Timestamp(0), Pose::identity());
        frames.add("c", "c", Timestamp(0), Pose::identity());
        assert_eq!(frames.ancestors("a"), ["a", "b"]);
        assert_eq!(frames.ancestors("c"), ["c"]);
        assert_eq!(
            frames.pose("c", "a", Timestamp(0)).unwrap_err(),
            "no way from `a` to `c`: `a` in `b`, `b` in `a` again, a ring, but `c` in `c` again, a ring"
        );
        assert!(frames.pose("a", "b", Timestamp(0)).is_ok());
    }
}
