//! The figures as text, 100 columns wide with the usual four rings.

use super::figures::{FIGURES, Figure, Figures, Value};
use super::quality::{ClassQuality, Quality, RingQuality};

/// The columns of the block by class: codes of figures.
const CLASS_COLUMNS: [&str; 9] = ["A1", "A2", "A2d", "A5", "A5p", "A7", "A7s", "A9", "FE"];

impl Quality {
    /// The figures as a table for the terminal: a row for each, its value over everything and by
    /// ring, and how many voxels (for A5m classes, for A9 objects) it rests on; then a row for each
    /// class. What could not be asked is a dash.
    pub fn table(&self) -> String {
        let mut lines = vec![self.title(), String::new(), self.heading()];
        let mut group = "";
        for figure in FIGURES {
            if figure.group != group {
                group = figure.group;
                lines.push(group.into());
            }
            lines.push(self.row(figure));
        }
        lines.extend(self.class_lines());
        lines.extend(self.worst_line());
        lines.iter().map(|line| format!("{}\n", line.trim_end())).collect()
    }

    fn title(&self) -> String {
        let noise = match self.noise_sigma_m {
            0.0 => String::new(),
            sigma_m => format!(", ranges with noise of {sigma_m} m (sigma)"),
        };
        let plural = if self.keyframes == 1 { "" } else { "s" };
        format!(
            "Labels against the exactly known world: {} keyframe{plural}{noise}",
            self.keyframes
        )
    }

    fn heading(&self) -> String {
        let rings: String = self.by_ring.iter().map(|ring| format!("{:>8}", name(ring))).collect();
        format!(
            "{:41}{:>8}{rings}{:>10}",
            "Distance from the grid frame's origin, m", "all", "count"
        )
    }

    fn row(&self, figure: &Figure) -> String {
        let cell = |figures: &Figures| number(figures.get(figure.name));
        let rings: String = self.by_ring.iter().map(|ring| cell(&ring.figures)).collect();
        let count = self.all.get(figure.name).map_or(0, |value| value.count);
        format!("  {:5}{:34}{}{rings}{count:>10}", figure.code, figure.words, cell(&self.all))
    }

    fn class_lines(&self) -> Vec<String> {
        let judged = self.by_class.iter().filter(|class| !class.figures.is_empty());
        let codes: String = CLASS_COLUMNS.iter().map(|code| format!("{code:>8}")).collect();
        let heading = format!("{:24}{codes}", "By class");
        [String::new(), heading].into_iter().chain(judged.map(class_line)).collect()
    }

    fn worst_line(&self) -> Option<String> {
        let worst = self.worst_object.as_ref()?;
        Some(format!(
            "\nWorst object (A9w): {} track {} ({}), {:.4} of {} seen voxels",
            occlabel_core::printable(&worst.scene),
            worst.track,
            worst.class.as_deref().unwrap_or("no class"),
            worst.completeness,
            worst.voxels
        ))
    }
}

fn class_line(class: &ClassQuality) -> String {
    let cells: String = CLASS_COLUMNS.iter().map(|code| class_cell(class, code)).collect();
    format!("  {:22}{cells}", class.class)
}

fn class_cell(class: &ClassQuality, code: &str) -> String {
    let figure = FIGURES.iter().find(|figure| figure.code == code);
    number(figure.and_then(|figure| class.figures.get(figure.name)))
}

fn name(ring: &RingQuality) -> String {
    match ring.to_m {
        Some(to_m) => format!("{}-{to_m}", ring.from_m),
        None => format!(">{}", ring.from_m),
    }
}

fn number(value: Option<Value>) -> String {
    match value.and_then(|value| value.value) {
        // What rounds to zero has no sign.
        Some(value) if value.abs() < 5e-5 => format!("{:>8.4}", 0.0),
        Some(value) => format!("{value:>8.4}"),
        None => format!("{:>8}", "-"),
    }
}
