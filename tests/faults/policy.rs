//! Scenes that are broken beside scenes that are not.

use serde_json::json;

use crate::asserts::{SKIP, assert_refused, field, label, losses};
use crate::support::{SCENE, TestLog, gts_files, nano_spec};

#[test]
fn a_scene_that_is_broken_is_skipped_and_the_others_are_labelled() {
    let log = TestLog::simulated(&nano_spec().with_scenes(2));
    let token = field(&log.sweeps()[0], "token");
    log.edit("sample_data", |rows| {
        let row = rows.iter_mut().find(|row| row["token"] == token.as_str());
        row.expect("a sweep")["filename"] = json!("/etc/passwd");
    });
    let label = label(&log);
    assert_refused(&label, &["sample_data.json", &token]);
    label.clone().with(&SKIP).run().exits(3);
    assert_eq!(losses(&label.output, "file-name")[0]["scene"], SCENE);
    let written = gts_files(&label.output);
    assert!(written.len() == 6 && written.keys().all(|name| name.starts_with("scene-0002/")));
}
