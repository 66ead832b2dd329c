//! The check of one scene.

use std::path::Path;

use occlabel_core::{Fault, Loss, PointsOf, Refusal, Scene, SweepHeader};
use occlabel_logs::{
    Finding, Inventory, MissingFile, SceneSurvey, Severity, SweepSurvey, UnknownLabels, UnknownSum,
    check_images, check_poses, unknown_hint, without_stand_in,
};
use rayon::prelude::*;
use serde::Serialize;

use crate::input::Opened;
use crate::lacks::lacks;

/// So many sweeps are looked at before what they told is put together: what bounds the memory.
const SWEEPS_AT_ONCE: usize = 64;

/// A scene to check.
pub(super) struct SceneCheck<'a> {
    pub(super) opened: &'a Opened,
    pub(super) root: &'a Path,
    pub(super) name: &'a str,
    /// Whether the user gave a class to what the taxonomy does not name.
    pub(super) takes_unknown: bool,
}

/// What a scene holds.
#[derive(Debug, Default, Serialize)]
pub(super) struct SceneFigures {
    keyframes: usize,
    sweeps: usize,
    missing_files: usize,
    /// About.
    missing_bytes: u64,
    /// How far sweeps differ about the ground's height.
    ground_thickness_m: Option<f64>,
}

/// What is known of a sweep after a look at it.
type Look = Result<(SweepSurvey, UnknownLabels, Vec<Fault>), Fault>;

impl SceneCheck<'_> {
    /// Everything that is wrong with the scene.
    pub(super) fn run(&self) -> (Vec<Finding>, SceneFigures) {
        let scene = match self.opened.source.load(self.name) {
            Ok(scene) => scene,
            Err(fault) => return (vec![self.finding(Severity::Error, fault)], Default::default()),
        };
        let inventory = Inventory::take(&*self.opened.source, self.root, &scene);
        let mut findings = self.structure(&scene, &inventory);
        let (survey, odd) = self.sweeps(&scene);
        findings.extend(odd);
        let ego_box = self.opened.rules.split.ego_box_m.as_ref();
        let (geometry, thickness_m) = survey.conclude(self.name, &scene.sweeps, ego_box);
        findings.extend(geometry);
        let poses = check_poses(&scene, thickness_m);
        findings.extend(poses.into_iter().map(|fault| self.taken(fault)));
        let figures = SceneFigures {
            keyframes: scene.keyframes.len(),
            sweeps: scene.sweeps.len(),
            missing_files: inventory.missing.len(),
            missing_bytes: inventory.missing_bytes(),
            ground_thickness_m: thickness_m,
        };
        (findings, figures)
    }

    /// What the tables and the folders show.
    fn structure(&self, scene: &Scene, inventory: &Inventory) -> Vec<Finding> {
        let refused = scene.refused.iter().map(|refusal| self.refused(refusal));
        let missing = inventory.missing.iter().map(MissingFile::fault);
        let missing = inventory.summary().into_iter().chain(missing);
        let unlabelled = self.opened.rules.check(scene).err();
        // Without a class for them that is an error already.
        let is_new = |lack: &Fault| unlabelled.as_ref().is_none_or(|told| told.rule != lack.rule);
        let lacks = lacks(scene, &self.opened.config).into_iter().filter(is_new);
        let lacks: Vec<Fault> = lacks.collect();
        let errors = missing.chain(unlabelled).map(|fault| self.finding(Severity::Error, fault));
        let images = check_images(self.root, &self.opened.source.image_files(self.name));
        let odd = scene.warnings.iter().map(|fault| self.told(fault)).chain(images);
        refused.chain(errors).chain(odd.chain(lacks).map(|fault| self.taken(fault))).collect()
    }

    /// What the sweeps show, and what is wrong with each.
    fn sweeps(&self, scene: &Scene) -> (SceneSurvey, Vec<Finding>) {
        let (mut survey, mut unknown) = (SceneSurvey::default(), UnknownSum::default());
        let (mut taken, mut refused) = (Vec::new(), Vec::new());
        for some in scene.sweeps.chunks(SWEEPS_AT_ONCE) {
            let looks: Vec<Look> = some.par_iter().map(|sweep| self.look(scene, sweep)).collect();
            for (sweep, look) in some.iter().zip(looks) {
                match look {
                    Ok((one, labels, warnings)) => {
                        survey.add(sweep, one);
                        taken.extend(unknown.add(labels, warnings));
                    }
                    Err(fault) => refused.push(fault),
                }
            }
        }
        // Those were all told at once.
        refused.retain(|fault| fault.rule != "missing-file");
        let refused = refused.into_iter().map(|fault| self.finding(Severity::Error, fault));
        let taken = taken.into_iter().chain(unknown.fault()).map(|fault| self.taken(fault));
        (survey, refused.chain(taken).collect())
    }

    fn look(&self, scene: &Scene, sweep: &SweepHeader) -> Look {
        let points = self.opened.source.read_sweep(sweep)?;
        let ego_box = self.opened.rules.split.ego_box_m.as_ref();
        let survey = match sweep.points_of {
            PointsOf::Moment => SweepSurvey::of(sweep, &points.cloud, &scene.tracks, ego_box),
            // No lidar saw the ground, or the boxes of that time, from there.
            PointsOf::Nothing | PointsOf::World | PointsOf::Track(_) => SweepSurvey::default(),
        };
        Ok((survey, points.unknown, points.warnings))
    }

    /// Something that the reader took: an error if it took it only for the check's sake.
    fn taken(&self, fault: Fault) -> Finding {
        match self.is_refused(&fault) {
            true => self.finding(Severity::Error, unknown_hint(fault)),
            false => self.finding(Severity::of_warning(fault.rule), fault),
        }
    }

    /// What the reader refused: an error, unless it was asked to read up to there.
    fn refused(&self, refusal: &Refusal) -> Finding {
        let severity = match refusal.loss {
            Loss::Remainder => Severity::Warning,
            _ => Severity::Error,
        };
        self.finding(severity, refusal.fault.clone())
    }

    /// A scene's warning as `label` would tell it.
    fn told(&self, fault: &Fault) -> Fault {
        match self.is_refused(fault) {
            true => without_stand_in(fault.clone()),
            false => fault.clone(),
        }
    }

    /// Whether `label` would refuse what a class stands in for here.
    fn is_refused(&self, fault: &Fault) -> bool {
        !self.takes_unknown && matches!(fault.rule, "unknown-label" | "unknown-category")
    }

    fn finding(&self, severity: Severity, fault: Fault) -> Finding {
        Finding { scene: Some(self.name.to_owned()), severity, fault }
    }
}

impl SceneFigures {
    /// One line.
    pub(super) fn line(&self) -> String {
        let mut line = format!("{} keyframes, {} sweeps", self.keyframes, self.sweeps);
        if self.missing_files > 0 {
            line += &format!(
                ", {} files missing (about {} bytes)",
                self.missing_files, self.missing_bytes
            );
        }
        if let Some(thickness_m) = self.ground_thickness_m {
            line += &format!(", a ground {thickness_m:.2} m thick");
        }
        line
    }
}
