//! Slices of grids as text, small enough to see a shadow move in a diff.
//!
//! A picture is a bird's-eye view of one layer: x goes up, y goes left, one character a voxel.
//!
//! ```
//! use occlabel_testkit::draw;
//!
//! let picture = draw([2, 3, 1], |[x, y, _]| if [x, y] == [1, 2] { '#' } else { '.' }, 0);
//! assert_eq!(picture, "#..\n...\n");
//! ```

use std::path::{Path, PathBuf};

/// Draws layer `z` of a grid of `shape` voxels: a row of text for each x, the highest on top; in
/// it a character for each y, the highest on the left.
pub fn draw(shape: [usize; 3], get: impl Fn([usize; 3]) -> char, z: usize) -> String {
    let row = |x| (0..shape[1]).rev().map(|y| get([x, y, z])).chain(['\n']).collect::<String>();
    (0..shape[0]).rev().map(row).collect()
}

/// Asserts that `text` is what stands in the file `path` (relative to `tests/fixtures/goldens` of
/// the workspace). With `UPDATE_GOLDENS=1` in the environment it writes the file instead.
#[track_caller]
pub fn assert_golden(path: impl AsRef<Path>, text: &str) {
    let update = std::env::var("UPDATE_GOLDENS").is_ok_and(|value| value == "1");
    assert_same(&goldens().join(path), text, update);
}

#[track_caller]
fn assert_same(path: &Path, text: &str, update: bool) {
    if update {
        write_golden(path, text);
    }
    let name = path.display();
    let golden = std::fs::read_to_string(path).unwrap_or_else(|error| {
        panic!("{name}: {error}; UPDATE_GOLDENS=1 writes it; found:\n{text}")
    });
    assert!(
        golden == text,
        "{name}: expected:\n{golden}\nfound:\n{text}\n(UPDATE_GOLDENS=1 rewrites it)"
    );
}

fn write_golden(path: &Path, text: &str) {
    let folder = path.parent().expect("a golden stands in a folder");
    std::fs::create_dir_all(folder).expect("the folder of the golden can be made");
    std::fs::write(path, text).expect("the golden can be written");
}

fn goldens() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/fixtures/goldens")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn x_is_up_and_y_is_left() {
        let letters = [['a', 'b', 'c'], ['d', 'e', 'f']];
        let picture = draw([2, 3, 2], |[x, y, z]| if z == 1 { letters[x][y] } else { '.' }, 1);
        assert_eq!(picture, "fed\ncba\n");
    }

    fn golden_of(text: &str) -> (tempfile::TempDir, PathBuf) {
        let directory = tempfile::tempdir().expect("a temporary directory");
        let path = directory.path().join("folder/golden.txt");
        assert_same(&path, text, true);
        (directory, path)
    }

    #[test]
    fn a_written_golden_is_the_same() {
        let (_directory, path) = golden_of("#.\n");
        assert_same(&path, "#.\n", false);
    }

    #[test]
    #[should_panic(expected = "expected:\n#.\n\nfound:\n.#\n")]
    fn another_golden_shows_both_pictures() {
        let (_directory, path) = golden_of("#.\n");
        assert_same(&path, ".#\n", false);
    }

    #[test]
    #[should_panic(expected = "found:\n#\n")]
    fn a_missing_golden_shows_the_picture() {
        assert_same(Path::new("there-is-none.txt"), "#\n", false);
    }
}
