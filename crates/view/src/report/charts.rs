//! Plots, and the numbers behind them.

use serde_json::{Value, json};

use super::attention::Attention;
use super::html::Html;
use super::run::{Run, RunScene};
use super::strays::Share;
use super::totals::VoxelTotals;
use super::words::{count, part, seconds};

/// What is plotted along keyframes.
const STATES: [(&str, Share, &str); 4] = [
    ("Occupied", Share::Occupied, "occupied"),
    ("Free", Share::Free, "free"),
    ("Unobserved", Share::Unobserved, "unobserved"),
    ("Visible to cameras", Share::SeenByCameras, "seen"),
];

/// Classes, shares along keyframes, time by stage.
pub(crate) fn charts(page: &mut Html, run: &Run) {
    classes(page, run);
    along_keyframes(page, run);
    stages(page, run);
}

fn classes(page: &mut Html, run: &Run) {
    let totals = run.totals();
    let occupied = totals.occupied();
    let row = |(class, &voxels): (&super::run::RunClass, &u64)| {
        vec![class.name.clone(), count(voxels), part(voxels, occupied)]
    };
    let rows: Vec<_> = run.classes.iter().zip(&totals.by_class).map(row).collect();
    page.markup("<section id=\"classes\"><h2>Occupied voxels by class</h2>\n<div class=\"two\">");
    let height = 60 + 22 * run.classes.len();
    page.markup(&format!(
        "<div class=\"plot\" style=\"height:{height}px\"><canvas id=\"plot-classes\" role=\"img\" "
    ));
    page.markup(
        "aria-label=\"Occupied voxels by class; the table has the numbers\"></canvas></div>\n",
    );
    page.table("numbers", &["Class", "Voxels", "Share"], &rows);
    page.markup("</div></section>\n");
}

fn along_keyframes(page: &mut Html, run: &Run) {
    page.markup("<section id=\"shares\"><h2>Shares along keyframes</h2>\n");
    page.markup("<p><label>Scene <select id=\"scene\"></select></label> In per cent of all voxels; each plot has its own axis.</p>\n<div class=\"four\">");
    let has_cameras = run.totals().seen_by_cameras.is_some();
    for (title, share, id) in STATES {
        if share != Share::SeenByCameras || has_cameras {
            page.markup("<figure>").element("figcaption", title);
            page.markup(&format!(
                "<div class=\"plot small\"><canvas id=\"plot-{id}\" role=\"img\" "
            ));
            page.markup(&format!(
                "aria-label=\"{title} along the keyframes\"></canvas></div></figure>\n"
            ));
        }
    }
    page.markup("</div></section>\n");
}

fn stages(page: &mut Html, run: &Run) {
    if run.stages.is_empty() {
        return;
    }
    let all: f64 = run.stages.iter().map(|(_, seconds)| seconds).sum();
    let row = |(name, time): &(String, f64)| {
        let share = if all > 0.0 { super::words::percent(time / all) } else { "–".into() };
        vec![name.clone(), seconds(*time), share]
    };
    page.markup("<section id=\"stages\"><h2>Time by stage</h2>\n<p>Summed over threads.</p><div class=\"two\">");
    page.markup("<div class=\"plot\" style=\"height:220px\"><canvas id=\"plot-stages\" role=\"img\" aria-label=\"Time by stage\"></canvas></div>\n");
    page.table(
        "numbers",
        &["Stage", "Time", "Share"],
        &run.stages.iter().map(row).collect::<Vec<_>>(),
    );
    page.markup("</div></section>\n");
}

/// What the plots are drawn of: shares in parts of 100 000.
pub(crate) fn chart_data(run: &Run, order: &Attention) -> Value {
    let totals = run.totals();
    let class = |(class, voxels): (&super::run::RunClass, &u64)| {
        let [r, g, b] = class.color;
        json!([class.name, voxels, format!("#{r:02x}{g:02x}{b:02x}")])
    };
    let classes: Vec<Value> = run.classes.iter().zip(&totals.by_class).map(class).collect();
    let labelled = order.scenes.iter().map(|&scene| &run.scenes[scene]);
    let labelled = labelled.filter(|scene| !scene.keyframes.is_empty());
    let stages: Vec<Value> = run.stages.iter().map(|(name, time)| json!([name, time])).collect();
    json!({
        "classes": classes,
        "states": STATES.map(|(_, _, id)| id),
        "scenes": labelled.map(scene_data).collect::<Vec<_>>(),
        "stages": stages,
    })
}

fn scene_data(scene: &RunScene) -> Value {
    let shares = |totals: &VoxelTotals| {
        let parts = |share: f64| (share * 1e5).round() as u64;
        STATES.map(|(_, share, _)| share.of(totals).map(parts))
    };
    let shares: Vec<_> = scene.keyframes.iter().map(|key| shares(&key.totals)).collect();
    json!({ "name": scene.name, "shares": shares })
}
