//! A comparison as text.

use occlabel_core::printable;

use super::comparison::Comparison;
use super::mask_agreement::MaskAgreement;
use super::state_changes::StateChanges;
use crate::rays::RayIou;
use crate::scores::{ClassScores, RingScores, SemanticScores};

/// How many confusions of classes are told.
const CONFUSIONS: usize = 10;

impl Comparison {
    /// The comparison as a table for the terminal. Ratios are from 0 to 1; a dash where there was
    /// nothing to ask, or a set lacks the array.
    pub fn table(&self) -> String {
        let mut lines = self.difference_lines();
        self.states.iter().for_each(|states| lines.extend(state_lines(states)));
        lines.extend(mask_lines("mask_lidar", self.mask_lidar.as_ref()));
        lines.extend(mask_lines("mask_camera", self.mask_camera.as_ref()));
        self.semantic.iter().for_each(|scores| lines.extend(class_lines(scores)));
        self.semantic.iter().for_each(|scores| lines.extend(confusion_lines(scores)));
        lines.extend(ring_lines(&self.by_ring));
        self.rays.iter().for_each(|rays| lines.extend(ray_lines(rays)));
        lines.iter().map(|line| format!("{}\n", line.trim_end())).collect()
    }

    fn difference_lines(&self) -> Vec<String> {
        let arrays = self.arrays;
        let mut lines = vec![format!("{} keyframes, {} voxels", self.keyframes, self.voxels)];
        lines.push(line("differ in some array", Some(self.differing)));
        lines.push(line("  semantics", Some(arrays.semantics)));
        lines.push(line("  mask_lidar", arrays.mask_lidar));
        lines.push(line("  mask_camera", arrays.mask_camera));
        lines.push(line("  instances", arrays.instances));
        lines.push(line("  flow", arrays.flow));
        lines
    }
}

fn state_lines(states: &StateChanges) -> Vec<String> {
    vec![
        line("same state", Some(states.same)),
        line("  occupied to free", Some(states.occupied_to_free)),
        line("  occupied to unobserved", Some(states.occupied_to_unobserved)),
        line("  free to occupied", Some(states.free_to_occupied)),
        line("  free to unobserved", Some(states.free_to_unobserved)),
        line("  unobserved to occupied", Some(states.unobserved_to_occupied)),
        line("  unobserved to free", Some(states.unobserved_to_free)),
    ]
}

fn mask_lines(name: &str, mask: Option<&MaskAgreement>) -> Vec<String> {
    let Some(mask) = mask else { return Vec::new() };
    let cells = [mask.both, mask.only_a, mask.only_b].map(|count| format!("{count:>12}"));
    let heading = ["IoU", "both", "only A", "only B"].map(|name| format!("{name:>12}")).concat();
    vec![format!("{name:24}{heading}"), format!("{:24}{}{}", "", ratio(mask.iou), cells.concat())]
}

fn class_lines(scores: &SemanticScores) -> Vec<String> {
    let names = ["IoU", "A", "B"].map(|name| format!("{name:>12}")).concat();
    let mut lines = vec![String::new(), format!("{:24}{names}", "By class")];
    let counts = |class: &ClassScores| format!("{:>12}{:>12}", class.truth, class.prediction);
    lines.extend(scores.classes.iter().map(|class| {
        format!("  {:22}{}{}", printable(&class.class), ratio(class.iou), counts(class))
    }));
    lines.push(format!("  {:22}{}", "mean, free left out", ratio(scores.miou)));
    lines.push(format!("  {:22}{}", "occupied or not", ratio(scores.occupied.iou)));
    lines
}

/// The most frequent pairs of different classes.
fn confusion_lines(scores: &SemanticScores) -> Vec<String> {
    let names: Vec<String> = scores.classes.iter().map(|class| printable(&class.class)).collect();
    let mut pairs: Vec<(u64, usize, usize)> = Vec::new();
    for (a, row) in scores.confusion.iter().enumerate() {
        let others = row.iter().enumerate().filter(|(b, count)| *b != a && **count > 0);
        pairs.extend(others.map(|(b, count)| (*count, a, b)));
    }
    pairs.sort_by_key(|(count, a, b)| (std::cmp::Reverse(*count), *a, *b));
    let name = |at: usize| names.get(at).map_or("no label", String::as_str);
    let told = pairs.iter().take(CONFUSIONS);
    let told = told.map(|(count, a, b)| format!("  {count:>12}  {} to {}", name(*a), name(*b)));
    let heading = (!pairs.is_empty()).then(|| "\nMost frequent changes, A to B".to_owned());
    heading.into_iter().chain(told).collect()
}

fn ring_lines(rings: &[RingScores]) -> Vec<String> {
    let names = ["mIoU", "IoU", "voxels"].map(|name| format!("{name:>12}")).concat();
    let row = |ring: &RingScores| {
        let name = match ring.to_m {
            Some(to_m) => format!("{}-{to_m}", ring.from_m),
            None => format!(">{}", ring.from_m),
        };
        let (miou, iou) = (ratio(ring.semantic.miou), ratio(ring.semantic.occupied.iou));
        format!("  {name:22}{miou}{iou}{:>12}", ring.semantic.voxels)
    };
    let heading = [String::new(), format!("{:24}{names}", "By distance, m")];
    heading.into_iter().chain(rings.iter().map(row)).collect()
}

fn ray_lines(rays: &RayIou) -> Vec<String> {
    let thresholds = rays.by_threshold.iter();
    let thresholds =
        thresholds.map(|at| format!("  {:22}{}", format!("{} m", at.threshold_m), ratio(at.mean)));
    let heading = [String::new(), format!("{:24}{}", "RayIoU, A as truth", ratio(rays.mean))];
    heading.into_iter().chain(thresholds).collect()
}

fn line(name: &str, count: Option<u64>) -> String {
    format!("  {name:34}{:>12}", count.map_or("-".to_owned(), |count| count.to_string()))
}

fn ratio(value: Option<f64>) -> String {
    value.map_or(format!("{:>12}", "-"), |value| format!("{value:>12.4}"))
}
