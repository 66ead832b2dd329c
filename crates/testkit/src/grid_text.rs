//! Slices of grids as text, small enough to see a shadow move in a diff.
//!
//! A picture is a bird's-eye view of one layer: x goes up, y goes left, one character a voxel.
//!
//! ```
//! use occlabel_testkit::{draw, parse};
//!
//! let picture = draw([2, 3, 1], |[x, y, _]| if [x, y] == [1, 2] { '#' } else { '.' }, 0);
//! assert_eq!(picture, "#..\n...\n");
//! assert_eq!(parse(&picture).get(1, 2), '#');
//! ```

use std::path::{Path, PathBuf};

/// Draws layer `z` of a grid of `shape` voxels: a row of text for each x, the highest on top; in
/// it a character for each y, the highest on the left.
pub fn draw(shape: [usize; 3], get: impl Fn([usize; 3]) -> char, z: usize) -> String {
    let row = |x| (0..shape[1]).rev().map(|y| get([x, y, z])).chain(['\n']).collect::<String>();
    (0..shape[0]).rev().map(row).collect()
}

/// A picture that was read back.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextSlice {
    rows: Vec<Vec<char>>,
}

/// Reads a picture; blanks around its lines and empty lines do not count.
pub fn parse(picture: &str) -> TextSlice {
    let lines = picture.lines().map(str::trim).filter(|line| !line.is_empty());
    let rows: Vec<Vec<char>> = lines.map(|line| line.chars().collect()).collect();
    let widths: Vec<usize> = rows.iter().map(Vec::len).collect();
    assert!(widths.windows(2).all(|pair| pair[0] == pair[1]), "rows of widths {widths:?}");
    TextSlice { rows }
}

impl TextSlice {
    /// The number of voxels along x and y.
    pub fn shape(&self) -> [usize; 2] {
        [self.rows.len(), self.rows.first().map_or(0, Vec::len)]
    }

    /// The character of a voxel.
    pub fn get(&self, x: usize, y: usize) -> char {
        let [nx, ny] = self.shape();
        assert!(x < nx && y < ny, "voxel ({x}, {y}) of a picture of {nx} x {ny}");
        self.rows[nx - 1 - x][ny - 1 - y]
    }
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

    #[test]
    fn a_picture_reads_back() {
        let get = |[x, y, _]: [usize; 3]| char::from(b'a' + (5 * x + y) as u8);
        let slice = parse(&draw([4, 5, 1], get, 0));
        assert_eq!(slice.shape(), [4, 5]);
        for (x, y) in (0..4).flat_map(|x| (0..5).map(move |y| (x, y))) {
            assert_eq!(slice.get(x, y), get([x, y, 0]));
        }
    }

    #[test]
    #[should_panic(expected = "rows of widths [2, 3]")]
    fn ragged_pictures_are_refused() {
        parse("..\n...\n");
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
