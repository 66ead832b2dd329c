//! What was odd, lost, or dropped.

use std::collections::BTreeMap;

use super::html::Html;
use super::run::{Remark, Run};
use super::words::{count, part};

/// So many scenes are named for each kind of remark, at most.
const MOST_NAMES: usize = 5;

/// Losses, then warnings, those of one rule in one row.
pub(crate) fn remarks(page: &mut Html, run: &Run) {
    if run.remarks.is_empty() {
        return;
    }
    let mut kinds: BTreeMap<(bool, &str), Vec<&Remark>> = BTreeMap::new();
    for remark in &run.remarks {
        kinds.entry((!remark.is_loss, &remark.rule)).or_default().push(remark);
    }
    let rows: Vec<_> = kinds.values().map(|remarks| row(remarks)).collect();
    page.markup("<section id=\"remarks\"><h2>Skipped, degraded, odd</h2>\n");
    page.table("remarks", &["What", "Rule", "Times", "Scenes", "The first"], &rows);
    page.markup("</section>\n");
}

fn row(remarks: &[&Remark]) -> Vec<String> {
    let first = remarks[0];
    let mut scenes: Vec<&str> = remarks.iter().map(|remark| remark.scene.as_str()).collect();
    scenes.sort_unstable();
    scenes.dedup();
    let kind = if first.is_loss { "skipped or degraded" } else { "warning" };
    let times = count(remarks.len() as u64);
    vec![kind.into(), first.rule.clone(), times, some(&scenes), first.text.clone()]
}

/// The first names, and how many there are besides.
fn some(names: &[&str]) -> String {
    let told = names.iter().take(MOST_NAMES).copied().collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(MOST_NAMES) {
        0 => told,
        more => format!("{told} and {more} more"),
    }
}

/// Points that took no part, by reason.
pub(crate) fn drops(page: &mut Html, run: &Run) {
    let all: u64 = run.drops.iter().map(|(_, points)| points).sum();
    if all == 0 {
        return;
    }
    let some = run.drops.iter().filter(|(_, points)| *points > 0);
    let row = |(reason, points): &(String, u64)| {
        vec![reason.replace('_', " "), count(*points), part(*points, all)]
    };
    page.markup("<section id=\"drops\"><h2>Points that took no part</h2>\n");
    page.table(
        "numbers narrow",
        &["Reason", "Points", "Share of these"],
        &some.map(row).collect::<Vec<_>>(),
    );
    page.markup("</section>\n");
}
