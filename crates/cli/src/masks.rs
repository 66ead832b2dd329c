//! The masks of a log, from what the configuration says of them.

use std::path::{Path, PathBuf};

use occlabel_core::{ClassId, Fault, MaskClasses, Taxonomy};
use occlabel_disk as disk;
use occlabel_logs::Masks;
use occlabel_pipeline::{PaintTable, shipped_masks};

use crate::input::{file_name, read_text};

/// The folder that `paint.masks = "auto"` looks for.
const FOLDER: &str = "masks";

/// Opens the folder of masks, if there is one, and puts into the configuration what was meant: the
/// folder's name without those above it, which would tell of the machine, and a table in place of its
/// file.
pub(crate) fn open_masks(
    root: &Path,
    paint: &mut PaintTable,
    taxonomy: &Taxonomy,
    unknown_as: Option<ClassId>,
) -> Result<Option<Masks>, Fault> {
    if let MaskClasses::Word(word) = &paint.classes
        && word != "taxonomy"
    {
        paint.classes = table_of(word)?;
    }
    let folder = match paint.masks.as_str() {
        PaintTable::NONE => return Ok(None),
        "auto" if disk::is_dir(&root.join(FOLDER)) => root.join(FOLDER),
        "auto" => {
            PaintTable::NONE.clone_into(&mut paint.masks);
            return Ok(None);
        }
        url if url.contains("://") => PathBuf::from(url),
        folder => root.join(folder),
    };
    paint.masks = file_name(&folder.to_string_lossy());
    let masks = Masks::open(&folder, paint.classes.table(taxonomy)?, unknown_as)?;
    Ok(Some(masks.without_borders(paint.borders_px)))
}

/// A shipped table of masks, or that of a file.
fn table_of(word: &str) -> Result<MaskClasses, Fault> {
    let text = match shipped_masks(word) {
        Some(text) => text.to_owned(),
        None => read_text(Path::new(word))?,
    };
    toml::from_str(&text).map(MaskClasses::Table).map_err(|error| {
        let expected = "a TOML file of class names by id or colour";
        Fault::new("config", word, expected, error.message())
    })
}
