//! Classes that masks give points, beside the points' own labels.

use std::ops::AddAssign;

use occlabel_core::ClassId;
use serde::Serialize;

/// How points were painted, by the class that they are labelled.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PaintedTally(Vec<ClassTally>);

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct ClassTally {
    labelled: u64,
    painted: u64,
    right: u64,
}

/// What becomes of the points of one class, or of all.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PaintedFigures {
    /// The class's name, `all` of all together.
    pub class: String,
    /// Labelled background points.
    pub points: u64,
    /// The share of them that some camera's mask gives a class.
    pub painted: Option<f64>,
    /// The share of painted ones whose class is that of their label.
    pub accuracy: Option<f64>,
}

impl PaintedTally {
    /// Notes a point by its label and by the class that masks give it, if they do.
    pub fn count(&mut self, label: ClassId, painted: Option<ClassId>) {
        let classes = self.0.len().max(label.index() + 1);
        self.0.resize(classes, ClassTally::default());
        let tally = &mut self.0[label.index()];
        tally.labelled += 1;
        tally.painted += u64::from(painted.is_some());
        tally.right += u64::from(painted == Some(label));
    }

    /// The figures of all points, then those of each class that has any, in order of ids.
    pub fn figures(&self, names: &[String]) -> Vec<PaintedFigures> {
        let all = self.0.iter().copied().fold(ClassTally::default(), ClassTally::and);
        let of_class = (names.iter().zip(&self.0)).filter(|(_, tally)| tally.labelled > 0);
        let of_class = of_class.map(|(name, tally)| tally.figures(name));
        [all.figures("all")].into_iter().chain(of_class).collect()
    }
}

impl AddAssign<&Self> for PaintedTally {
    fn add_assign(&mut self, other: &Self) {
        self.0.resize(self.0.len().max(other.0.len()), ClassTally::default());
        self.0.iter_mut().zip(&other.0).for_each(|(sum, tally)| *sum = sum.and(*tally));
    }
}

impl ClassTally {
    fn and(self, other: Self) -> Self {
        Self {
            labelled: self.labelled + other.labelled,
            painted: self.painted + other.painted,
            right: self.right + other.right,
        }
    }

    fn figures(self, class: &str) -> PaintedFigures {
        let share = |part: u64, of: u64| (of > 0).then(|| part as f64 / of as f64);
        PaintedFigures {
            class: class.to_owned(),
            points: self.labelled,
            painted: share(self.painted, self.labelled),
            accuracy: share(self.right, self.painted),
        }
    }
}

/// The figures as text: a row for all, then one a class.
pub fn painted_table(figures: &[PaintedFigures]) -> String {
    let share = |share: Option<f64>| share.map_or("-".into(), |share| format!("{share:.4}"));
    let row = |row: &PaintedFigures| {
        let (painted, right) = (share(row.painted), share(row.accuracy));
        format!("{:24}{:>12}{painted:>10}{right:>10}", row.class, row.points)
    };
    let heading =
        format!("{:24}{:>12}{:>10}{:>10}", "Labelled points", "points", "painted", "right");
    [heading].into_iter().chain(figures.iter().map(row)).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_of_the_points_of_a_class() {
        let mut tally = PaintedTally::default();
        let points = [(2, Some(2)), (2, Some(0)), (2, None), (2, None), (0, Some(0))];
        for (label, painted) in points {
            tally.count(ClassId(label), painted.map(ClassId));
        }
        let mut twice = tally.clone();
        twice += &tally;
        let names = ["road", "sky", "car"].map(String::from);
        let figures = twice.figures(&names);
        let told: Vec<_> =
            figures.iter().map(|f| (f.class.as_str(), f.points, f.painted, f.accuracy)).collect();
        let expected = [
            ("all", 10, Some(0.6), Some(2.0 / 3.0)),
            ("road", 2, Some(1.0), Some(1.0)),
            ("car", 8, Some(0.5), Some(0.5)),
        ];
        assert_eq!(told, expected);
        assert!(
            painted_table(&figures)
                .contains("car                                8    0.5000    0.5000")
        );
        assert!(painted_table(&PaintedTally::default().figures(&names)).ends_with("-         -"));
    }
}
