//! The scores as text.

use std::collections::BTreeMap;

use super::ray_scores::RayScores;
use super::semantic::{ClassScores, SemanticScores};
use super::tally::{RingScores, Scores};
use crate::rays::RayPqAt;

impl Scores {
    /// The scores as a table for the terminal. Ratios are from 0 to 1; what could not be asked is a
    /// dash.
    pub fn table(&self) -> String {
        let mut lines = Vec::new();
        self.semantic.iter().for_each(|scores| lines.extend(semantic_lines(scores)));
        lines.extend(self.geometry_lines());
        lines.extend(self.panoptic_lines());
        lines.extend(self.velocity_lines());
        self.rays.iter().for_each(|scores| lines.extend(ray_lines(scores)));
        self.semantic.iter().for_each(|scores| lines.extend(class_lines(scores)));
        lines.extend(self.panoptic_class_lines());
        lines.extend(ring_lines(&self.by_ring));
        lines.iter().map(|line| format!("{}\n", line.trim_end())).collect()
    }

    /// A row for each value of each attribute, for the terminal.
    pub fn attribute_table(by_attribute: &BTreeMap<&str, BTreeMap<&str, Scores>>) -> String {
        let mut lines = Vec::new();
        for (name, values) in by_attribute {
            lines.push(String::new());
            let columns =
                ["keyframes", "mIoU", "IoU", "F", "PQ", "RayIoU"].map(|name| format!("{name:>10}"));
            lines.push(format!("{:24}{}", format!("By {}", clean(name)), columns.concat()));
            lines.extend(values.iter().map(|(value, scores)| scores.attribute_line(value)));
        }
        lines.iter().map(|line| format!("{}\n", line.trim_end())).collect()
    }

    fn attribute_line(&self, value: &str) -> String {
        let semantic = self.semantic.as_ref();
        let cells = [
            semantic.and_then(|scores| scores.miou),
            semantic.and_then(|scores| scores.occupied.iou),
            self.f_score.and_then(|scores| scores.f_score),
            self.panoptic.as_ref().and_then(|scores| scores.all.pq),
            self.rays.as_ref().and_then(|scores| scores.ray_iou.mean),
        ];
        format!("  {:22}{:>10}{}", clean(value), self.keyframes, cells.map(wide).concat())
    }

    fn geometry_lines(&self) -> Vec<String> {
        let Some(scores) = self.f_score else { return Vec::new() };
        vec![
            format!("Centres within {} m, mean over keyframes", scores.threshold_m),
            line("F-score", scores.f_score),
            line("completeness", scores.completeness),
            line("accuracy", scores.accuracy),
            line("chamfer distance, m", scores.chamfer_m),
        ]
    }

    fn panoptic_lines(&self) -> Vec<String> {
        let Some(scores) = &self.panoptic else { return Vec::new() };
        let names = ["PQ", "SQ", "RQ"].map(|name| format!("{name:>10}")).concat();
        let mut lines = vec![format!("{:42}{names}", "Panoptic quality")];
        for (name, means) in
            [("all", scores.all), ("things", scores.things), ("stuff", scores.stuff)]
        {
            lines.push(format!("  {name:40}{}", [means.pq, means.sq, means.rq].map(wide).concat()));
        }
        lines.push(line("PQ-dagger", scores.pq_dagger));
        lines
    }

    fn velocity_lines(&self) -> Vec<String> {
        let Some(scores) = &self.velocity else { return Vec::new() };
        vec![
            "Velocity errors, m/s, mean over classes".into(),
            line("AVE-T, all true voxels", scores.ave_t_mps),
            line("AVE-O, of the right class", scores.ave_o_mps),
            line("AVE-D, detections", scores.ave_d_mps),
        ]
    }

    fn panoptic_class_lines(&self) -> Vec<String> {
        let Some(scores) = &self.panoptic else { return Vec::new() };
        let names = ["PQ", "SQ", "RQ", "matched", "missed", "spurious"];
        let names = names.map(|name| format!("{name:>10}")).concat();
        let mut lines = vec![String::new(), format!("{:24}{names}", "Segments by class")];
        for class in &scores.classes {
            let ratios = [class.pq, class.sq, class.rq].map(wide).concat();
            let counts = [class.matched, class.missed, class.spurious];
            let counts = counts.map(|count| format!("{count:>10}")).concat();
            lines.push(format!("  {:22}{ratios}{counts}", clean(&class.class)));
        }
        lines
    }
}

fn semantic_lines(scores: &SemanticScores) -> Vec<String> {
    vec![
        format!("Classes, over {} voxels", scores.voxels),
        line("mIoU", scores.miou),
        line("accuracy", scores.accuracy),
        line("F1, mean", scores.f1),
        "Occupied or not".into(),
        line("IoU", scores.occupied.iou),
        line("precision", scores.occupied.precision),
        line("recall", scores.occupied.recall),
        line("mIoU, absent classes as 0 (completion)", Some(scores.completion.miou)),
    ]
}

fn ray_lines(scores: &RayScores) -> Vec<String> {
    let mut lines = vec!["Along rays".into(), line("RayIoU", scores.ray_iou.mean)];
    for at in &scores.ray_iou.by_threshold {
        lines.push(line(&format!("RayIoU at {} m", at.threshold_m), at.mean));
    }
    if let Some(ray_pq) = &scores.ray_pq {
        lines.push(line("RayPQ", ray_pq.mean));
        let at = |at: &RayPqAt| line(&format!("RayPQ at {} m", at.threshold_m), at.pq);
        lines.extend(ray_pq.by_threshold.iter().map(at));
    }
    if let Some(ave) = &scores.ave {
        lines.push(line("mAVE, m/s", ave.mean));
        lines.push(line("challenge score of 2024", scores.challenge_score));
    }
    lines
}

fn class_lines(scores: &SemanticScores) -> Vec<String> {
    let names = ["IoU", "precision", "recall", "F1", "truth", "predicted"];
    let names = names.map(|name| format!("{name:>10}")).concat();
    let heading = [String::new(), format!("{:24}{names}", "By class")];
    heading.into_iter().chain(scores.classes.iter().map(class_line)).collect()
}

fn class_line(scores: &ClassScores) -> String {
    let ratios = [scores.iou, scores.precision, scores.recall, scores.f1].map(wide).concat();
    let (name, truth, prediction) = (clean(&scores.class), scores.truth, scores.prediction);
    format!("  {name:22}{ratios}{truth:>10}{prediction:>10}")
}

fn ring_lines(rings: &[RingScores]) -> Vec<String> {
    if rings.is_empty() {
        return Vec::new();
    }
    let names = ["mIoU", "IoU", "precision", "recall", "voxels"];
    let names = names.map(|name| format!("{name:>10}")).concat();
    let heading = [String::new(), format!("{:24}{names}", "By distance, m")];
    let row = |ring: &RingScores| {
        let (scores, occupied) = (&ring.semantic, ring.semantic.occupied);
        let cells = [scores.miou, occupied.iou, occupied.precision, occupied.recall];
        format!("  {:22}{}{:>10}", name(ring), cells.map(wide).concat(), scores.voxels)
    };
    heading.into_iter().chain(rings.iter().map(row)).collect()
}

fn name(ring: &RingScores) -> String {
    match ring.to_m {
        Some(to_m) => format!("{}-{to_m}", ring.from_m),
        None => format!(">{}", ring.from_m),
    }
}

fn line(name: &str, value: Option<f64>) -> String {
    format!("  {name:40}{}", wide(value))
}

fn wide(value: Option<f64>) -> String {
    value.map_or(format!("{:>10}", "-"), |value| format!("{value:>10.4}"))
}

/// Names of classes and attributes come from files.
fn clean(name: &str) -> String {
    occlabel_core::printable(name)
}
