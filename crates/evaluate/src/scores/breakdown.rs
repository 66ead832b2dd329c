//! Tallies by what is known of scenes.

use std::collections::BTreeMap;
use std::ops::AddAssign;

use super::attributes::SceneAttributes;
use super::rules::ScoringRules;
use super::tally::{ScoreTally, Scores};

/// A tally of everything, and one for each value of each attribute of scenes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Breakdown {
    /// Of all keyframes.
    pub all: ScoreTally,
    by_attribute: BTreeMap<(String, String), ScoreTally>,
}

impl Breakdown {
    /// Adds what was counted in a keyframe of a scene.
    pub fn add(&mut self, tally: &ScoreTally, scene: &str, attributes: &SceneAttributes) {
        self.all += tally;
        for (name, value) in attributes.of(scene) {
            *self.by_attribute.entry((name.into(), value.into())).or_default() += tally;
        }
    }

    /// The scores of each value of each attribute: by attribute, then by value, in byte order.
    pub fn scores(&self, rules: &ScoringRules) -> BTreeMap<&str, BTreeMap<&str, Scores>> {
        let mut scores: BTreeMap<&str, BTreeMap<&str, Scores>> = BTreeMap::new();
        for ((name, value), tally) in &self.by_attribute {
            scores.entry(name).or_default().insert(value, tally.scores(rules));
        }
        scores
    }
}

impl AddAssign<&Breakdown> for Breakdown {
    fn add_assign(&mut self, other: &Self) {
        self.all += &other.all;
        for (key, tally) in &other.by_attribute {
            *self.by_attribute.entry(key.clone()).or_default() += tally;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::scorer::tests::{pair, row};
    use super::super::scorer::{Metrics, Scorer};
    use super::*;

    #[test]
    fn each_value_has_its_own_tally() {
        let rules = row(2, 1.0);
        let metrics = Metrics { semantic: true, ..Metrics::default() };
        let scorer = Scorer::new(rules.clone(), metrics).unwrap();
        let tally =
            |prediction: &[u8]| scorer.score(&pair(&rules, &[0, 1], prediction).scored()).unwrap();
        let table = "scene\tlight\ns1\tday\ns2\tnight\ns3\tday\n";
        let attributes = SceneAttributes::parse(table, "a.tsv").unwrap();
        let (mut one, mut other) = (Breakdown::default(), Breakdown::default());
        one.add(&tally(&[0, 1]), "s1", &attributes);
        one.add(&tally(&[1, 1]), "s2", &attributes);
        other.add(&tally(&[0, 0]), "s3", &attributes);
        other.add(&tally(&[0, 0]), "unknown", &attributes);
        one += &other;
        let scores = one.scores(&rules);
        let miou = |value: &str| scores["light"][value].semantic.as_ref().unwrap().miou;
        assert_eq!((miou("day"), miou("night")), (Some(2.0 / 3.0), Some(0.0)));
        assert_eq!(one.all.keyframes(), 4);
    }
}
