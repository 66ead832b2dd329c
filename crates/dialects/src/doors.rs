//! Every reader of this crate that meets bytes of a file, behind one signature: what fuzzing and the
//! tests with damage knock at.

use std::sync::LazyLock;

use occlabel_core::VoxelGrid;
use occlabel_testkit::{Door, in_folder};

use crate::describe::Description;
use crate::{Dialect, KeyframeLabels, LabelSet, Wanted};

/// All of them.
pub const DOORS: &[Door] = &[
    Door { name: "dialect_files", knock: dialect_files, seeds: files },
    Door { name: "dialect_toml", knock: dialect_toml, seeds: texts },
    Door { name: "describe", knock: describe, seeds: described },
];

/// The dialects with grids of a few voxels, so that files are small.
static DIALECTS: LazyLock<Vec<Dialect>> = LazyLock::new(|| {
    let small = |mut dialect: Dialect| {
        dialect.grid.min_m = [0.0; 3];
        dialect.grid.max_m = [4.0, 2.0, 3.0];
        dialect.grid.voxel_size_m = [1.0; 3];
        dialect
    };
    Dialect::all().into_iter().map(small).collect()
});

/// Files by their paths.
type Files = Vec<(String, Vec<u8>)>;

/// The sound files of a keyframe of each dialect, as named in its tree.
static FILES: LazyLock<Vec<Files>> = LazyLock::new(|| {
    let files = |dialect: &Dialect| {
        let encoded = dialect.encode(&labels(dialect), "scene", "token").unwrap();
        encoded.files.into_iter().map(|(path, bytes)| (path.to_string(), bytes)).collect()
    };
    DIALECTS.iter().map(files).collect()
});

/// Labels that say all that is common.
fn labels(dialect: &Dialect) -> KeyframeLabels {
    let spec = dialect.grid.spec().unwrap();
    let mut semantics = VoxelGrid::filled(&spec, dialect.classes.free_index());
    semantics.values_mut()[5..8].copy_from_slice(&[0, 1, 2]);
    let mut labels = KeyframeLabels::of_semantics(spec.clone(), semantics);
    labels.mask_lidar = Some(VoxelGrid::filled(&spec, 1));
    labels.mask_camera = Some(VoxelGrid::filled(&spec, 0));
    labels.instances = Some(VoxelGrid::filled(&spec, 3));
    labels.flow = Some(VoxelGrid::filled(&spec, [1.0, 0.0, -1.0]));
    labels
}

/// A keyframe of the dialect that the first byte tells, with other bytes in the file that the second
/// does. What is read can be written.
fn dialect_files(bytes: &[u8]) -> bool {
    let [dialect, place, bytes @ ..] = bytes else { return false };
    let number = usize::from(*dialect) % DIALECTS.len();
    let mut files: Vec<(&str, &[u8])> =
        FILES[number].iter().map(|(name, bytes)| (&name[..], &bytes[..])).collect();
    let place = usize::from(*place) % files.len();
    files[place].1 = bytes;
    in_folder(&files, |root| {
        let dialect = DIALECTS[number].clone();
        let Ok(set) = LabelSet::in_dialect(root, dialect, None) else { return false };
        let Ok(labels) = set.read_with(&set.keyframes()[0], &Wanted::ALL) else { return false };
        let written = set.dialect().encode(&labels, "scene", "token");
        assert!(written.is_ok(), "{written:?}");
        true
    })
}

/// Every file of every dialect, behind its numbers.
fn files() -> Vec<Vec<u8>> {
    let of_dialect = |(number, files): (usize, &Files)| {
        let behind = move |(place, (_, bytes)): (usize, &(String, Vec<u8>))| {
            [&[number as u8, place as u8][..], bytes].concat()
        };
        files.iter().enumerate().map(behind).collect::<Vec<_>>()
    };
    FILES.iter().enumerate().flat_map(of_dialect).collect()
}

/// A dialect's own file; what it says of its tree has to hold.
fn dialect_toml(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    Dialect::parse("a", &text).is_ok_and(|dialect| {
        dialect.classes.names().len() == dialect.classes.list.len() && dialect.grid.spec().is_ok()
    })
}

fn texts() -> Vec<Vec<u8>> {
    crate::shipped::SHIPPED.iter().map(|(_, text)| text.as_bytes().to_vec()).collect()
}

/// The endings of label files, by the first byte.
const ENDINGS: [&str; 6] = ["npz", "npy", "label", "bin", "invalid", "occluded"];

/// A file of which nobody says what it is.
fn describe(bytes: &[u8]) -> bool {
    let Some((ending, bytes)) = bytes.split_first() else { return false };
    let name = format!("a.{}", ENDINGS[usize::from(*ending) % ENDINGS.len()]);
    in_folder(&[(&name, bytes)], |root| {
        let _ = LabelSet::open(root, None);
        Description::of_file(&root.join(&name), None).is_ok_and(|told| told.contents.is_some())
    })
}

/// Those of the small keyframes that tell their grid.
fn described() -> Vec<Vec<u8>> {
    let files = FILES.iter().flatten();
    let npz = files.filter(|(name, _)| name.ends_with(".npz"));
    npz.map(|(_, bytes)| [&[0][..], bytes].concat()).collect()
}

#[cfg(test)]
mod tests {
    use occlabel_testkit::{knock_with_corpus, knock_with_damage};

    use super::*;

    /// Runs of each reader.
    const CASES: u32 = 200;

    #[test]
    fn fault_34_damaged_label_files_are_read_or_refused() {
        for (door, [taken, refused]) in DOORS.iter().zip(knock_with_damage(DOORS, CASES)) {
            assert!(refused > CASES / 20, "{}: {taken} taken, {refused} refused", door.name);
        }
    }

    #[test]
    fn fault_34_what_fuzzing_found_in_label_files_is_read_or_refused() {
        assert!(knock_with_corpus(DOORS) >= DOORS.len());
    }
}
