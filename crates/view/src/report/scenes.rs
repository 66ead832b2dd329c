//! Scenes and keyframes: what strays first, then all of them.

use super::attention::{Attention, Item, KeyframeAt, MOST_ITEMS};
use super::html::{Html, escaped};
use super::run::{Run, RunScene, Thumbnail};
use super::words::{count, part, seconds, stray};
use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;

/// So many ways in which one thing strays are told, at most.
const MOST_STRAYS: usize = 3;
/// So many keyframes that could not be read are named, at most.
const MOST_UNREADABLE: usize = 20;
/// Keyframes of larger runs are not listed one by one.
const MOST_LISTED: usize = 400;

/// What to look at first.
pub(crate) fn attention(page: &mut Html, run: &Run, order: &Attention, thumbnails: &[Thumbnail]) {
    page.markup("<section id=\"first\"><h2>Look here first</h2>\n");
    unreadable(page, run);
    page.markup("<p class=\"quiet\">Keyframes whose shares stray from the rest of their scene, and scenes that \
        stray from the rest of the run, by more than 3.5 times the usual spread (median absolute \
        deviation). A stray is a reason to look, not a fault.</p>\n");
    if order.items.is_empty() {
        page.markup("<p>Nothing strays.</p>\n");
    }
    page.markup("<ol class=\"cards\">\n");
    order.items.iter().take(MOST_ITEMS).for_each(|item| card(page, run, item, thumbnails));
    page.markup("</ol>\n");
    if let more @ 1.. = order.items.len().saturating_sub(MOST_ITEMS) {
        page.element("p", &format!("{more} more stray less."));
    }
    page.markup("</section>\n");
}

fn unreadable(page: &mut Html, run: &Run) {
    let all = run.scenes.iter().flat_map(|scene| {
        scene.unreadable.iter().map(move |(token, why)| [&scene.name, token, why])
    });
    let all: Vec<_> = all.collect();
    if all.is_empty() {
        return;
    }
    let rows: Vec<_> =
        all.iter().take(MOST_UNREADABLE).map(|row| row.map(String::clone).to_vec()).collect();
    page.element("h3", &format!("{} keyframes could not be read", count(all.len() as u64)));
    page.table("remarks", &["Scene", "Keyframe", "Why"], &rows);
}

fn card(page: &mut Html, run: &Run, item: &Item, thumbnails: &[Thumbnail]) {
    let scene = &run.scenes[item.scene];
    page.markup("<li>");
    if let Some(at) = item.shown(run) {
        picture(page, run, at, thumbnails);
    }
    page.markup("<div>").element("h3", &scene.name);
    match item.keyframe {
        Some(keyframe) => {
            let what = format!("keyframe {} of {}: ", keyframe + 1, scene.keyframes.len());
            page.markup("<p class=\"token\">").text(&what);
            page.element("code", &scene.keyframes[keyframe].token).markup("</p>");
        }
        None => {
            page.markup("<p class=\"token\">the scene as a whole</p>");
        }
    }
    let rest = match (item.keyframe, item.in_scene) {
        (None, _) => "in the run",
        (_, true) => "in its scene",
        (_, false) => "in the run",
    };
    for one in item.strays.iter().take(MOST_STRAYS) {
        page.element("p", &stray(one, rest, run));
    }
    page.markup("</div></li>\n");
}

fn picture(page: &mut Html, run: &Run, at: KeyframeAt, thumbnails: &[Thumbnail]) {
    let Some(found) = thumbnails.iter().find(|thumbnail| thumbnail.at == at) else { return };
    let scene = &run.scenes[at.scene];
    let named = escaped(&format!("{}, {}", scene.name, scene.keyframes[at.keyframe].token));
    let data = BASE64.encode(&found.png);
    page.markup(&format!(
        "<img src=\"data:image/png;base64,{data}\" alt=\"{named}, from above\" title=\"{named}\">"
    ));
}

/// All scenes, and their keyframes where there are not too many.
pub(crate) fn scenes(page: &mut Html, run: &Run, order: &Attention, thumbnails: &[Thumbnail]) {
    page.markup("<section id=\"scenes\"><h2>Scenes</h2>\n<p class=\"quiet\">First those that lost something, \
        then those that stray, then those with warnings.</p>\n");
    let heads = [
        "Scene",
        "Keyframes",
        "Occupied",
        "Free",
        "Unobserved",
        "Visible to cameras",
        "Time",
        "Lost",
        "Warnings",
        "Stray",
    ];
    let rows = order.scenes.iter().map(|&scene| scene_row(run, scene, order.strays_of[scene]));
    page.table("numbers", &heads, &rows.collect::<Vec<_>>());
    gallery(page, run, order, thumbnails);
    if run.keyframes() <= MOST_LISTED {
        page.markup("<details><summary>Keyframes one by one</summary>\n");
        let heads = ["Scene", "Keyframe", "Occupied", "Free", "Unobserved", "Visible to cameras"];
        let rows = order.scenes.iter().flat_map(|&scene| keyframe_rows(&run.scenes[scene]));
        page.table("numbers two-names", &heads, &rows.collect::<Vec<_>>());
        page.markup("</details>\n");
    }
    page.markup("</section>\n");
}

fn scene_row(run: &Run, place: usize, strays: usize) -> Vec<String> {
    let scene = &run.scenes[place];
    let totals = scene.totals();
    let voxels = totals.voxels();
    let (lost, warned): (Vec<_>, Vec<_>) =
        run.remarks_of(&scene.name).partition(|remark| remark.is_loss);
    let lost = lost.len() + scene.unreadable.len();
    vec![
        scene.name.clone(),
        count(scene.keyframes.len() as u64),
        part(totals.occupied(), voxels),
        part(totals.free, voxels),
        part(totals.unobserved, voxels),
        totals.seen_by_cameras.map_or("–".into(), |seen| part(seen, voxels)),
        scene.seconds.map_or("–".into(), seconds),
        count(lost as u64),
        count(warned.len() as u64),
        count(strays as u64),
    ]
}

fn keyframe_rows(scene: &RunScene) -> impl Iterator<Item = Vec<String>> {
    scene.keyframes.iter().map(|keyframe| {
        let totals = &keyframe.totals;
        vec![
            scene.name.clone(),
            keyframe.token.clone(),
            count(totals.occupied()),
            count(totals.free),
            count(totals.unobserved),
            totals.seen_by_cameras.map_or("–".into(), count),
        ]
    })
}

fn gallery(page: &mut Html, run: &Run, order: &Attention, thumbnails: &[Thumbnail]) {
    page.markup("<h3>From above</h3>\n<p class=\"quiet\">x is up, y is left; a column has the colour of its topmost \
        occupied voxel, grey where free, dark where unobserved.</p>\n<div class=\"gallery\">\n");
    for &place in &order.scenes {
        let mut of_scene: Vec<_> = thumbnails.iter().filter(|t| t.at.scene == place).collect();
        of_scene.sort_by_key(|thumbnail| thumbnail.at);
        if of_scene.is_empty() {
            continue;
        }
        page.markup("<figure>");
        of_scene.iter().for_each(|thumbnail| picture(page, run, thumbnail.at, thumbnails));
        page.element("figcaption", &run.scenes[place].name).markup("</figure>\n");
    }
    page.markup("</div>\n");
    let shown = thumbnails.len();
    let left_out = run.keyframes().saturating_sub(shown);
    if left_out > 0 {
        let text = format!(
            "{} of {} keyframes are shown.",
            count(shown as u64),
            count(run.keyframes() as u64)
        );
        page.element("p class=\"quiet\"", &text);
    }
}
