//! What `quality --json` printed, as tables.

use std::collections::BTreeSet;
use std::path::Path;

use occlabel_core::Fault;
use occlabel_labels::read_bounded;
use occlabel_view::QualityTable;
use serde_json::{Map, Value};

/// A file of more bytes is none of figures.
const MAX_BYTES: u64 = 1 << 28;

/// The tables of a file.
///
/// # Errors
/// If it cannot be read, or is not what `quality --json` prints.
pub(crate) fn tables(path: &Path) -> Result<Vec<QualityTable>, Fault> {
    let place = path.display().to_string();
    let fault =
        |found: String| Fault::new("quality", &place, "what `quality --json` prints", found);
    let json: Value = serde_json::from_slice(&read_bounded(path, MAX_BYTES)?)
        .map_err(|error| fault(error.to_string()))?;
    let trees = json["trees"].as_array().into_iter().flatten().filter_map(world_truth);
    let tables: Vec<_> = trees.chain(held_out(&json)).collect();
    if tables.is_empty() { Err(fault("other JSON".into())) } else { Ok(tables) }
}

/// Figures by the exactly known world: each with what it is a share or a mean of.
fn world_truth(tree: &Value) -> Option<QualityTable> {
    let figures = tree["quality"]["all"].as_object()?;
    let row = |(name, figure): (&String, &Value)| {
        Some(vec![words(name), number(&figure["value"])?, figure["count"].as_u64()?.to_string()])
    };
    let (keyframes, name) =
        (&tree["quality"]["keyframes"], tree["tree"].as_str().unwrap_or("labels"));
    Some(QualityTable {
        title: format!("{name} against the exactly known world, {keyframes} keyframes"),
        columns: ["Figure", "Value", "Of"].map(str::to_owned).to_vec(),
        rows: figures.iter().filter_map(row).collect(),
    })
}

/// Figures by sweeps that were held out: of all they met, and of each kind of it, a column each.
fn held_out(json: &Value) -> Option<QualityTable> {
    let every = json["held_out"].as_u64()?;
    let labels = json["total"]["labels"].as_object()?;
    let is_kind = |(_, value): &(&String, &Value)| value.is_object();
    let (kinds, plain): (Vec<_>, Vec<_>) = labels.iter().partition(is_kind);
    let all: Map<String, Value> =
        plain.into_iter().map(|(name, value)| (name.clone(), value.clone())).collect();
    let kinds =
        kinds.into_iter().filter_map(|(name, value)| Some((words(name), value.as_object()?)));
    let columns: Vec<_> = std::iter::once(("all".to_owned(), &all)).chain(kinds).collect();
    let names: BTreeSet<&String> = columns.iter().flat_map(|(_, figures)| figures.keys()).collect();
    let cell = |figures: &Map<String, Value>, name: &String| {
        figures.get(name).and_then(number).unwrap_or_else(|| "–".to_owned())
    };
    let row = |name: &String| -> Vec<String> {
        let cells = columns.iter().map(|(_, figures)| cell(figures, name));
        std::iter::once(words(name)).chain(cells).collect()
    };
    Some(QualityTable {
        title: format!("Asked by sweeps that took no part: every {every}th of each lidar"),
        rows: names.into_iter().map(row).collect(),
        columns: ["Figure".to_owned()]
            .into_iter()
            .chain(columns.iter().map(|(kind, _)| kind.clone()))
            .collect(),
    })
}

/// A whole number as it is, any other to four digits.
fn number(value: &Value) -> Option<String> {
    match value.as_u64() {
        Some(whole) => Some(whole.to_string()),
        None => value.as_f64().map(|number| format!("{number:.4}")),
    }
}

/// A figure's name as people write it, its unit behind it.
fn words(name: &str) -> String {
    let (name, unit) = match name.rsplit_once('_') {
        Some((name, "m")) => (name, ", m"),
        Some((name, "mps")) => (name, ", m/s"),
        Some((name, "voxels")) => (name, ", voxels"),
        _ => (name, ""),
    };
    name.replace('_', " ") + unit
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<QualityTable>, Fault> {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("quality.json");
        std::fs::write(&file, text).unwrap();
        tables(&file)
    }

    #[test]
    fn figures_are_read_of_either_way_to_measure() {
        let world = r#"{"trees": [{"tree": "t", "quality": {"keyframes": 5, "all": {
            "occupied_precision": {"count": 10, "value": 0.98764},
            "occupied_distance_voxels": {"count": 3, "value": null}}}}]}"#;
        let tables = read(world).unwrap();
        assert_eq!(tables[0].rows, [["occupied precision", "0.9876", "10"].map(str::to_owned)]);
        let held_out = r#"{"held_out": 5, "total": {"labels": {"returns": 7,
            "ground": {"depth_mean_m": 0.5, "hit_recall": null}}}}"#;
        let rows = read(held_out).unwrap().remove(0).rows;
        let expected =
            [["depth mean, m", "–", "0.5000"], ["hit recall", "–", "–"], ["returns", "7", "–"]];
        assert_eq!(rows, expected.map(|row| row.map(str::to_owned)));
    }

    #[test]
    fn anything_else_is_refused() {
        for text in ["", "[]", "{\"trees\": []}", "{\"held_out\": 5}"] {
            assert_eq!(read(text).unwrap_err().rule, "quality", "{text}");
        }
    }
}
