//! What came of scoring, as a table or JSON.

use occlabel_evaluate::scores::{Breakdown, Scores};
use serde_json::json;

use crate::args::EvaluateArgs;
use crate::evaluate::mask;
use crate::evaluate::plan::Plan;
use crate::label_pairs::LabelPairs;

/// All that is told.
pub(crate) struct Report<'a> {
    pub(crate) args: &'a EvaluateArgs,
    pub(crate) plan: &'a Plan,
    pub(crate) pairs: &'a LabelPairs,
    pub(crate) breakdown: &'a Breakdown,
}

impl Report<'_> {
    pub(crate) fn json(&self) -> String {
        let rules = self.plan.scorer.rules();
        let report = json!({
            "truth": self.args.truth.display().to_string(),
            "prediction": self.args.prediction.display().to_string(),
            "mask": mask::name(self.plan.mask),
            "missing": self.pairs.only_a.len(),
            "unused": self.pairs.only_b.len(),
            "scores": self.breakdown.all.scores(rules),
            "by_attribute": self.breakdown.scores(rules),
        });
        report.to_string()
    }

    pub(crate) fn table(&self) -> String {
        let rules = self.plan.scorer.rules();
        let scores = self.breakdown.all.scores(rules);
        let by_attribute = Scores::attribute_table(&self.breakdown.scores(rules));
        format!("{}\n\n{}{by_attribute}", self.title(scores.keyframes), scores.table())
    }

    fn title(&self, keyframes: u64) -> String {
        let (truth, prediction) = (self.args.truth.display(), self.args.prediction.display());
        let plural = if keyframes == 1 { "" } else { "s" };
        let mask = mask::name(self.plan.mask);
        let unused = match self.pairs.only_b.len() {
            0 => String::new(),
            unused => format!(", {unused} predictions without truth"),
        };
        format!("{prediction} against {truth}: {keyframes} keyframe{plural}, mask: {mask}{unused}")
    }
}
