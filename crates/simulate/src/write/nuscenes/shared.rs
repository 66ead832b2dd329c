//! The rows that all scenes of a log share.

use image::ExtendedColorType;
use occlabel_core::Fault;
use serde_json::json;

use crate::write::files::Output;
use crate::write::png::png;
use crate::write::raw_names::RawNames;

use super::tables::Tables;

/// The image that every log has as its map: the devkit asks for one.
const BLANK_MAP: &str = "maps/blank.png";

/// Visibility tokens are these numbers. Nobody judged how much of a thing is seen: boxes say all.
const VISIBILITIES: [(&str, &str); 4] =
    [("1", "v0-40"), ("2", "v40-60"), ("3", "v60-80"), ("4", "v80-100")];
/// The token of the highest visibility.
pub(super) const VISIBLE: &str = VISIBILITIES[3].0;

pub(super) fn push_shared_rows(
    tables: &mut Tables,
    names: &RawNames,
    output: &Output,
) -> Result<(), Fault> {
    for (index, name) in names.all().iter().enumerate() {
        let row = json!({ "token": name, "name": name, "description": "", "index": index });
        tables.push("category", &row)?;
    }
    for (token, level) in VISIBILITIES {
        let description = "visibility of whole object in percent";
        let row = json!({ "token": token, "level": level, "description": description });
        tables.push("visibility", &row)?;
    }
    output.write(BLANK_MAP, &png(&[0], [1, 1], ExtendedColorType::L8))
}

/// The log and the map of a scene.
pub(super) fn push_log(tables: &mut Tables, scene: &str) -> Result<(), Fault> {
    let log = json!({
        "token": scene, "logfile": scene, "vehicle": "sim", "date_captured": "1970-01-01",
        "location": scene,
    });
    tables.push("log", &log)?;
    let map = json!({
        "token": scene, "category": "semantic_prior", "filename": BLANK_MAP, "log_tokens": [scene],
    });
    tables.push("map", &map)
}
