//! What raw point labels are called.

use std::collections::BTreeMap;

use occlabel_core::Fault;

use super::NuScenesLog;
use super::rows::Category;
use super::table::Row;

/// The names of categories by their raw label, from category.json.
///
/// # Errors
/// If a category has no `index`, or that of another.
pub(super) fn label_names(log: &NuScenesLog) -> Result<BTreeMap<u16, &str>, Fault> {
    #[expect(clippy::disallowed_methods, reason = "sorted below")]
    let mut rows: Vec<_> = log.tables.categories.values().collect();
    rows.sort_by_key(|row| row.offset);
    let mut names = BTreeMap::new();
    for row in rows {
        let index = row.index.ok_or_else(|| without_index(row))?;
        if let Some(other) = names.insert(index, row.name.as_str()) {
            let found = format!("{index}, which `{other}` has too");
            return Err(row.fault("category-index", "an `index` of its own", found));
        }
    }
    Ok(names)
}

/// The category.json of nuScenes has no `index`, that of nuScenes-lidarseg has (nuscenes-devkit#547).
fn without_index(row: &Row<Category>) -> Fault {
    let hint = "unpack nuScenes-lidarseg last: its category.json replaces that of nuScenes";
    row.fault("category-index", "an `index`, as points are labelled", "none").hint(hint)
}
