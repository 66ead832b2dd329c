//! What was labelled, by what, and how right it is.

use super::html::Html;
use super::run::Run;
use super::words::{count, part};

/// The figures that one wants first.
pub(crate) fn tiles(page: &mut Html, run: &Run) {
    let totals = run.totals();
    let voxels = totals.voxels();
    let mut tiles = vec![
        ("Scenes", count(run.scenes.len() as u64)),
        ("Keyframes", count(run.keyframes() as u64)),
        ("Occupied", part(totals.occupied(), voxels)),
        ("Free", part(totals.free, voxels)),
        ("Unobserved", part(totals.unobserved, voxels)),
    ];
    if let Some(seen) = totals.seen_by_cameras {
        tiles.push(("Visible to cameras", part(seen, voxels)));
    }
    let (losses, warnings): (Vec<_>, Vec<_>) =
        run.remarks.iter().partition(|remark| remark.is_loss);
    tiles.push(("Skipped or degraded", count(losses.len() as u64)));
    tiles.push(("Warnings", count(warnings.len() as u64)));
    page.markup("<dl class=\"tiles\">\n");
    for (name, value) in tiles {
        page.markup("<div>").element("dt", name).element("dd", &value).markup("</div>\n");
    }
    page.markup("</dl>\n");
}

/// How right the labels are, where it was measured.
pub(crate) fn quality(page: &mut Html, run: &Run) {
    if run.quality.is_empty() {
        return;
    }
    page.markup("<section id=\"quality\"><h2>How right the labels are</h2>\n");
    for table in &run.quality {
        page.element("h3", &table.title).line();
        let columns: Vec<&str> = table.columns.iter().map(String::as_str).collect();
        page.table("numbers narrow", &columns, &table.rows);
    }
    page.markup("</section>\n");
}

/// What made the labels, of what, and by which settings.
pub(crate) fn provenance(page: &mut Html, run: &Run) {
    page.markup("<section id=\"provenance\"><h2>Where the labels come from</h2>\n<table class=\"facts\"><tbody>\n");
    for (name, value) in &run.facts {
        page.markup("<tr>").element("th", name).element("td", value).markup("</tr>\n");
    }
    page.markup("</tbody></table>\n");
    if let Some(config) = &run.config {
        page.markup("<details><summary>Configuration</summary>").preformatted(config);
        page.markup("</details>\n");
    }
    page.markup("</section>\n");
}
