//! Figures as text.

use super::{Figures, HeldOutFigures, KindFigures};

/// A figure of one kind of rays: its name, how it is written, where it stands, and of how many.
type KindRow =
    (&'static str, Unit, fn(&KindFigures) -> Option<f64>, fn(&KindFigures) -> (u64, &'static str));

/// One kind of rays: its name, and where its figures stand.
type KindColumn = (&'static str, fn(&Figures) -> &KindFigures);

/// How a figure is written.
#[derive(Clone, Copy)]
enum Unit {
    Share,
    Metres,
}

const KIND_ROWS: [KindRow; 7] = [
    ("hit recall", Unit::Share, |kind| kind.hit_recall, returns),
    ("free agreement", Unit::Share, |kind| kind.free_agreement, crossings),
    ("air unobserved", Unit::Share, |kind| kind.crossings_of_unobserved, crossings),
    ("depth error, mean", Unit::Metres, |kind| kind.depth_mean_m, returns),
    ("depth error, median", Unit::Metres, |kind| kind.depth_median_m, returns),
    ("depth error, 95 %", Unit::Metres, |kind| kind.depth_p95_m, returns),
    ("meet nothing", Unit::Share, |kind| kind.meet_nothing, returns),
];

fn returns(kind: &KindFigures) -> (u64, &'static str) {
    (kind.returns, "returns")
}

fn crossings(kind: &KindFigures) -> (u64, &'static str) {
    (kind.crossings, "crossings")
}

/// A table: a row a figure, the labels' column beside the floor's.
pub fn table(figures: &HeldOutFigures) -> String {
    let mut lines = vec![format!("{:20} {:10} {:>10} {:>10}", "", "rays to", "labels", "floor")];
    for (name, unit, figure, of) in KIND_ROWS {
        for (kind, choose) in kinds() {
            let (ours, floor) = (choose(&figures.labels), choose(&figures.floor));
            lines.push(row(name, kind, unit, (figure(ours), figure(floor)), of(ours)));
        }
    }
    let (ours, floor) = (&figures.labels, &figures.floor);
    let pair = (ours.returns_in_unobserved, floor.returns_in_unobserved);
    lines.push(row("in unobserved", "all", Unit::Share, pair, (ours.returns, "returns")));
    let pair = (ours.contradicted, floor.contradicted);
    let of = (ours.occupied_asked, "occupied voxels");
    lines.push(row("contradicted", "all", Unit::Share, pair, of));
    lines.push(format!("not asked: {} returns where a track stands now", ours.returns_covered));
    lines.join("\n")
}

fn kinds() -> [KindColumn; 3] {
    [
        ("ground", |figures| &figures.ground),
        ("structure", |figures| &figures.structure),
        ("tracks", |figures| &figures.tracks),
    ]
}

fn row(
    name: &str,
    kind: &str,
    unit: Unit,
    (ours, floor): (Option<f64>, Option<f64>),
    (count, what): (u64, &str),
) -> String {
    let (ours, floor) = (written(ours, unit), written(floor, unit));
    format!("{name:20} {kind:10} {ours:>10} {floor:>10}  of {count} {what}")
}

fn written(figure: Option<f64>, unit: Unit) -> String {
    match (figure, unit) {
        (None, _) => "-".into(),
        (Some(share), Unit::Share) => format!("{:.3} %", share * 100.0),
        (Some(metres), Unit::Metres) => format!("{metres:.3} m"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::held_out::{HeldOutTally, KindTally};

    #[test]
    fn labels_stand_beside_their_floor_and_nothing_is_a_dash() {
        let mut tally = HeldOutTally::default();
        let ground = KindTally { returns: 8, hits: 7, ..KindTally::default() };
        tally.labels.ground = ground.clone();
        tally.floor.ground = KindTally { hits: 8, ..ground };
        let text = table(&HeldOutFigures::of(&tally));
        let line = |words: &[&str]| {
            let has = |line: &&str| words.iter().all(|word| line.contains(word));
            text.lines().find(has).unwrap_or_else(|| panic!("{words:?} in\n{text}")).to_owned()
        };
        assert!(line(&["hit recall", "ground"]).contains("87.500 %  100.000 %  of 8 returns"));
        assert!(line(&["depth error, mean", "tracks"]).contains("-          -  of 0 returns"));
        assert_eq!(text.lines().count(), 1 + 7 * 3 + 3);
    }
}
