//! What sweeps say about their scene, gathered one by one.

use std::collections::BTreeMap;

use nalgebra::Point3;
use occlabel_core::{BoxTrack, Fault, PointCloud, PointLabel, SweepHeader};

use super::box_points::{BoxPoints, near_boxes};
use super::ground::{GroundView, ground_normals};
use super::own_body::{OwnBody, near_returns};
use super::thickness::{Thickness, ground_heights};
use super::{Finding, Severity};

/// What is kept of a sweep: little, whatever it holds.
#[derive(Clone, Debug, Default)]
pub struct SweepSurvey {
    ground: Option<GroundView>,
    heights_m: BTreeMap<(i64, i64), f32>,
    near: BTreeMap<[i64; 3], usize>,
    boxes: BTreeMap<(u16, usize), bool>,
}

/// What the sweeps of a scene say together.
#[derive(Debug, Default)]
pub struct SceneSurvey {
    grounds: Vec<GroundView>,
    thickness: Thickness,
    own_body: OwnBody,
    boxes: BoxPoints,
}

impl SweepSurvey {
    /// Looks at a sweep's points, lidar frame. `tracks` are the scene's; `ego_box` is what is taken for the vehicle's body,
    /// lower and upper corner, ego frame, metres.
    pub fn of(
        sweep: &SweepHeader,
        cloud: &PointCloud<PointLabel>,
        tracks: &[BoxTrack],
        ego_box: Option<&(Point3<f64>, Point3<f64>)>,
    ) -> Self {
        let is_return = |i: &usize| {
            let p = cloud.positions[*i];
            p != cloud.origin(*i) && p.coords.iter().all(|metres| metres.is_finite())
        };
        let returns = (0..cloud.len()).filter(is_return);
        let points: Vec<_> = returns.map(|i| sweep.ego_from_lidar * cloud.positions[i]).collect();
        let ground = GroundView::of(sweep, &points);
        let level = ground.and_then(|ground| ground.level);
        let heights_m = level.map(|level| ground_heights(sweep, &points, &level));
        let near = level.map(|level| near_returns(&points, &level, ego_box));
        let (heights_m, near) = (heights_m.unwrap_or_default(), near.unwrap_or_default());
        Self { ground, heights_m, near, boxes: near_boxes(sweep, cloud, tracks) }
    }
}

impl SceneSurvey {
    /// Adds a sweep's. They come in order of time.
    pub fn add(&mut self, sweep: &SweepHeader, survey: SweepSurvey) {
        self.grounds.extend(survey.ground);
        self.thickness.add(survey.heights_m);
        self.own_body.add(sweep, survey.near);
        self.boxes.add(survey.boxes);
    }

    /// What the sweeps show of a scene's geometry, and how far they differ about the ground's height,
    /// metres, if some of them saw the same place. `ego_box` as for [`SweepSurvey::of`].
    ///
    /// Where the ground is not level, nothing else is said: all of it would follow from that.
    pub fn conclude(
        &self,
        scene: &str,
        sweeps: &[SweepHeader],
        ego_box: Option<&(Point3<f64>, Point3<f64>)>,
    ) -> (Vec<Finding>, Option<f64>) {
        let finding =
            |severity, fault: Fault| Finding { scene: Some(scene.to_owned()), severity, fault };
        if let Some(fault) = ground_normals(sweeps, &self.grounds) {
            return (vec![finding(Severity::Error, fault)], None);
        }
        let still = self.own_body.faults(ego_box).into_iter();
        let findings =
            still.chain(self.boxes.fault()).map(|fault| finding(Severity::Warning, fault));
        (findings.collect(), self.thickness.median_m())
    }
}
