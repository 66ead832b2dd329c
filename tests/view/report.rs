//! The page about a run: its numbers are those of the arrays, what strays comes first, nothing of a log
//! becomes markup, and a browser shows it without a network.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::outside::browser;
use crate::support::{labelled_drive, manifest, occlabel, read_arrays, report, text};
use occlabel_labels::{LabelArrays, LabelTree, NumberArray, TreePath, npz};
use serde_json::{Value, json};
use tempfile::TempDir;

/// Ten keyframes of a short drive.
const WORLD: &str = include_str!("../fixtures/mcap_world.toml");

/// What a log could try.
const HOSTILE: &str = "</script><script>hacked = 1</script><img src=x onerror='hacked = 1'>";

/// A labelled drive and the page about it.
struct Reported {
    folder: TempDir,
    labels: PathBuf,
}

impl Reported {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let world = WORLD.replace("keyframe_hz = 2.0", "keyframe_hz = 10.0");
        let labels = labelled_drive(folder.path(), &world, ["nuscenes"; 2], "occ3d-nuscenes");
        Self { folder, labels }
    }

    /// The page, in its file.
    fn page(&self, more: &[&str]) -> PathBuf {
        self.page_that_exits(0, more)
    }

    fn page_that_exits(&self, code: i32, more: &[&str]) -> PathBuf {
        let page = self.folder.path().join("report.html");
        let line = ["report", text(&self.labels), "--output", text(&page)];
        occlabel(&[&line[..], more].concat()).exits(code);
        page
    }

    fn tokens(&self) -> Vec<String> {
        let tokens = manifest(&self.labels)["scenes"]["street"]["keyframes"].clone();
        serde_json::from_value(tokens).expect("tokens")
    }

    fn arrays(&self, token: &str) -> LabelArrays {
        read_arrays(&self.labels, "street", token).labels
    }

    /// Writes a keyframe again with other classes.
    fn change(&self, token: &str, change: impl Fn(&mut [u8])) {
        let mut arrays = self.arrays(token);
        change(arrays.semantics.values_mut());
        let grids = [arrays.semantics, arrays.mask_lidar, arrays.mask_camera];
        let arrays = grids.map(|grid| NumberArray::new(&grid.shape(), grid.values()));
        let names = ["semantics", "mask_lidar", "mask_camera"];
        let bytes = npz(names.into_iter().zip(&arrays));
        let place = TreePath::labels("street", token).expect("a path");
        fs::write(LabelTree::new(&self.labels).place(&place), bytes).expect("written");
    }
}

/// The numbers behind the plots.
fn data(page: &str) -> Value {
    let (_, rest) = page.split_once("id=\"data\">").expect("data");
    let (json, _) = rest.split_once("</script>").expect("an end");
    serde_json::from_str(json).expect("JSON")
}

/// The cells of the first table behind an id, row by row.
fn table(page: &str, id: &str) -> Vec<Vec<String>> {
    let (_, rest) = page.split_once(&format!("id=\"{id}\"")).expect("a section");
    let (_, rest) = rest.split_once("<tbody>").expect("a table");
    let (body, _) = rest.split_once("</tbody>").expect("its end");
    let cells = |row: &str| {
        let cells = row.split("<td>").skip(1);
        cells.map(|cell| cell.split("</td>").next().unwrap_or_default().to_owned()).collect()
    };
    body.split("<tr>").skip(1).map(cells).collect()
}

/// A count as the page writes it.
fn spaced(count: u64) -> String {
    let digits = count.to_string().into_bytes();
    let groups = digits.rchunks(3).rev().map(|group| String::from_utf8_lossy(group).into_owned());
    groups.collect::<Vec<_>>().join("\u{202f}")
}

#[test]
fn the_numbers_are_those_of_the_arrays() {
    let reported = Reported::new();
    let page = fs::read_to_string(reported.page(&[])).expect("a page");
    let mut by_class: BTreeMap<u8, u64> = BTreeMap::new();
    let mut shares = Vec::new();
    for token in reported.tokens() {
        let LabelArrays { semantics, mask_lidar, mask_camera } = reported.arrays(&token);
        let mut counts = [0_u64; 4];
        for (flat, &class) in semantics.values().iter().enumerate() {
            let (seen, visible) = (mask_lidar.values()[flat] != 0, mask_camera.values()[flat] != 0);
            let state = if class != 17 { 0 } else { 1 + usize::from(!seen) };
            counts[state] += 1;
            counts[3] += u64::from(visible);
            *by_class.entry(class).or_default() += u64::from(class != 17);
        }
        let share = |count: u64| (count as f64 / semantics.values().len() as f64 * 1e5).round();
        shares.push(counts.map(|count| share(count) as u64));
    }
    let data = data(&page);
    assert_eq!(data["scenes"][0]["shares"], json!(shares));
    assert_eq!(shares.len(), 11);
    let rows = table(&page, "classes");
    assert_eq!(rows.len(), 17);
    for (class, row) in (0..17).zip(&rows) {
        let count = by_class.get(&class).copied().unwrap_or(0);
        assert_eq!(data["classes"][usize::from(class)][1], count);
        assert_eq!(row[1], spaced(count), "{row:?}");
    }
    assert!(by_class.values().filter(|count| **count > 0).count() >= 3, "{by_class:?}");
}

#[test]
fn the_same_labels_make_the_same_page_on_any_number_of_threads() {
    let reported = Reported::new();
    let pages = ["1", "2", "5"].map(|jobs| fs::read(reported.page(&["--jobs", jobs])).unwrap());
    assert!(pages[0] == pages[1] && pages[0] == pages[2]);
    assert!(pages[0].len() < 600_000, "{}", pages[0].len());
}

#[test]
fn what_strays_is_first_and_what_cannot_be_read_is_told() {
    let reported = Reported::new();
    let tokens = reported.tokens();
    reported.change(&tokens[4], |classes| classes.fill(17));
    let place = TreePath::labels("street", &tokens[7]).expect("a path");
    fs::write(LabelTree::new(&reported.labels).place(&place), "no npz").expect("written");
    let page = fs::read_to_string(reported.page_that_exits(3, &[])).expect("a page");
    let (_, first) = page.split_once("class=\"cards\"").expect("cards");
    let (first, _) = first.split_once("</li>").expect("a card");
    assert!(first.contains(&tokens[4]) && first.contains("Occupied: 0\u{a0}%"), "{first}");
    assert!(first.contains("data:image/png;base64,"));
    let unread = table(&page, "first");
    assert_eq!((unread.len(), unread[0][1].as_str()), (1, tokens[7].as_str()));
}

#[test]
fn an_unfinished_run_or_one_without_a_report_shows_what_there_is() {
    let reported = Reported::new();
    fs::remove_file(reported.labels.join("report.json")).expect("gone");
    let page = fs::read_to_string(reported.page(&[])).expect("a page");
    assert!(page.contains("There is no report.json") && !page.contains("id=\"stages\""));
    assert!(page.contains("id=\"provenance\""));
}

#[test]
fn other_outputs_and_other_figures_are_refused() {
    let reported = Reported::new();
    let labels = text(&reported.labels);
    occlabel(&["report", labels, "--output", "report.pdf"]).exits(2);
    let quality = reported.labels.join("manifest.json");
    let line = ["report", labels, "--output", "report.html", "--quality", text(&quality)];
    let ended = occlabel(&line);
    ended.exits(2);
}

/// Puts a hostile text wherever a run's files have texts of a log.
fn make_hostile(reported: &Reported) -> String {
    let scene = HOSTILE.replace('/', "!");
    let gts = reported.labels.join("gts");
    fs::rename(gts.join("street"), gts.join(&scene)).expect("renamed");
    let mut told = manifest(&reported.labels);
    let scenes = told["scenes"].as_object_mut().expect("scenes");
    let record = scenes.remove("street").expect("the scene");
    scenes.insert(scene.clone(), record);
    told["files"] = json!([]);
    told["preset"] = json!(HOSTILE);
    told["config"][HOSTILE] = json!(HOSTILE);
    told["classes"][3]["name"] = json!(HOSTILE);
    fs::write(reported.labels.join("manifest.json"), told.to_string()).expect("written");
    let mut run = report(&reported.labels);
    let finding = json!({"rule": HOSTILE, "place": HOSTILE, "expected": HOSTILE, "found": HOSTILE, "scene": scene});
    (run["warnings"], run["skipped_or_degraded"]) = (json!([finding]), json!([finding]));
    (run["outcome"], run["host"]) = (json!(HOSTILE), json!({HOSTILE: HOSTILE}));
    run["total"]["dropped"][HOSTILE] = json!(7);
    run["total"]["seconds_by_stage"][HOSTILE] = json!(7.5);
    fs::write(reported.labels.join("report.json"), run.to_string()).expect("written");
    scene
}

/// What a browser says of the page; `None` if there is none.
fn in_browser(page: &Path) -> Option<Value> {
    let told = browser("report.mjs", &[page])?;
    Some(serde_json::from_str(&told).unwrap_or_else(|error| panic!("{error}: {told}")))
}

#[test]
fn in_a_browser_plots_are_drawn_and_no_name_is_markup() {
    let reported = Reported::new();
    let tokens = reported.tokens();
    reported.change(&tokens[2], |classes| classes.iter_mut().for_each(|c| *c = (*c).min(3)));
    let scene = make_hostile(&reported);
    let Some(seen) = in_browser(&reported.page(&[])) else { return };
    assert_eq!((&seen["messages"], &seen["requests"]), (&json!([]), &json!([])));
    assert_eq!(
        (&seen["hacked"], &seen["strange"], &seen["wide"]),
        (&json!(false), &json!(0), &json!(false))
    );
    assert_eq!(seen["scenes"], json!([scene]));
    let plots = seen["plots"].as_object().expect("plots");
    assert_eq!(plots.len(), 6, "{plots:?}");
    assert!(plots.values().all(|colors| colors.as_u64() > Some(10)), "{plots:?}");
    assert!(seen["pictures"].as_u64() > Some(4) && seen["pictures"] == seen["loaded"], "{seen}");
    let first = seen["first"].as_str().expect("a text");
    assert!(first.contains(&scene) && first.contains(&tokens[2]), "{first}");
}
