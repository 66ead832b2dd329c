//! The stages of a keyframe, each on the same few of them.

use occlabel_core::{AggregatedScene, ClassId, Instant, Keyframe, OccupancyLabels, VoxelGrid};
use occlabel_labels::{evidence_npz, labels_npz};
use occlabel_occlusion::{CameraRays, Eye, Lenses, Matter, visible};
use occlabel_pipeline::{LabelOptions, Rules, label_keyframe};
use occlabel_voxelize::voxelize;

use crate::clock::cost_of;
use crate::keyframe::{cast, eyes, instant, matter_at, visits, walk_background};
use crate::row::Case;
use crate::world::OpenLog;

/// Keyframes, and what their stages start from.
pub(crate) struct KeyframeStages<'a> {
    log: &'a OpenLog,
    aggregated: &'a AggregatedScene<ClassId>,
    precise: Rules,
    occ3d: Rules,
    lenses: Lenses,
    keyframes: Vec<Prepared<'a>>,
}

struct Prepared<'a> {
    keyframe: &'a Keyframe,
    instant: Instant<'a>,
    eyes: Vec<Eye<'a>>,
    matter: VoxelGrid<Matter>,
    labels: OccupancyLabels,
}

impl<'a> KeyframeStages<'a> {
    pub(crate) fn new(
        log: &'a OpenLog,
        aggregated: &'a AggregatedScene<ClassId>,
        keyframes: &[&'a Keyframe],
    ) -> Self {
        let (scene, precise) = (&log.scene, log.rules("precise"));
        let (lenses, options) = (Lenses::default(), LabelOptions::with_evidence(1));
        let prepare = |keyframe: &&'a Keyframe| {
            let instant = instant(scene, aggregated, keyframe, &precise);
            let whole =
                label_keyframe(scene, aggregated, &lenses, keyframe, &precise, &options, |_| {});
            Prepared {
                keyframe,
                eyes: eyes(scene, keyframe, &instant),
                matter: matter_at(&instant, &precise),
                labels: whole.labels,
                instant,
            }
        };
        let keyframes = keyframes.iter().map(prepare).collect();
        Self { log, aggregated, occ3d: log.rules("occ3d-nuscenes"), precise, lenses, keyframes }
    }

    /// All stages, and the whole.
    pub(crate) fn cases(&self) -> Vec<Case<'_>> {
        let rays = self.sum(|at| at.instant.ray_count());
        let visits = self.sum(|at| visits(&walk_background(&at.instant, &self.precise.spec)));
        let voxels = self.sum(|_| self.precise.spec.len() as u64);
        vec![
            self.case("voxelize", "point", rays, |at| self.votes(at)),
            self.case("rays, precise", "ray", rays, |at| drop(cast(&at.instant, &self.precise)))
                .and("voxel visit", visits),
            self.case("rays, occ3d-nuscenes", "ray", rays, |at| {
                drop(cast(&at.instant, &self.occ3d));
            }),
            self.cameras("cameras, all-centers", "voxel and camera", &self.precise),
            self.cameras("cameras, pixels", "pixel", &self.occ3d),
            self.label("label_keyframe, precise", rays, LabelOptions::labels(1)),
            self.label("label_keyframe, with evidence", rays, LabelOptions::with_evidence(1)),
            self.case("labels.npz", "voxel", voxels, |at| drop(labels_npz(&at.labels))),
            self.case("evidence.npz", "voxel", voxels, |at| {
                drop(evidence_npz(at.labels.evidence()));
            }),
        ]
    }

    fn case<'b>(
        &'b self,
        name: &str,
        unit: &'static str,
        count: u64,
        stage: impl Fn(&Prepared) + 'b,
    ) -> Case<'b> {
        Case::new(name, unit, count, move || cost_of(|| self.keyframes.iter().for_each(&stage)))
    }

    /// What stands in the cameras' way is that of `precise`.
    fn cameras<'b>(&'b self, name: &str, unit: &'static str, rules: &'b Rules) -> Case<'b> {
        let targets = |eye: &Eye| match rules.occlusion.rays {
            CameraRays::Pixels => u64::from(eye.camera.width) * u64::from(eye.camera.height),
            _ => rules.spec.len() as u64,
        };
        let count = self.sum(|at| at.eyes.iter().map(targets).sum());
        self.case(name, unit, count, |at| {
            let Prepared { eyes, matter, .. } = at;
            drop(visible(eyes, &self.lenses, &rules.spec, matter, &rules.occlusion));
        })
    }

    fn sum(&self, count: impl Fn(&Prepared) -> u64) -> u64 {
        self.keyframes.iter().map(count).sum()
    }

    fn votes(&self, at: &Prepared) {
        drop(voxelize(&at.instant, &self.precise.spec, &self.precise.votes()));
    }

    fn label<'b>(&'b self, name: &str, rays: u64, options: LabelOptions) -> Case<'b> {
        self.case(name, "ray", rays, move |at| {
            let Self { log, aggregated, precise, lenses, .. } = self;
            let scene = &log.scene;
            drop(label_keyframe(scene, aggregated, lenses, at.keyframe, precise, &options, |_| {}));
        })
    }
}
