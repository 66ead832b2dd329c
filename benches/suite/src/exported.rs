//! Arrays as plain files that any program reads: little-endian, without headers.

use std::fs;
use std::path::PathBuf;

use nalgebra::Point3;

/// A folder of arrays.
pub(crate) struct Exported(PathBuf);

impl Exported {
    /// The folder; it is made if it is not there.
    pub(crate) fn at(folder: PathBuf) -> Self {
        fs::create_dir_all(&folder).expect("a folder");
        Self(folder)
    }

    pub(crate) fn put(&self, name: &str, bytes: &[u8]) {
        fs::write(self.0.join(name), bytes).expect("room for a file");
    }

    pub(crate) fn put_points(&self, name: &str, points: impl Iterator<Item = Point3<f64>>) {
        let bytes: Vec<u8> =
            points.flat_map(|p| [p.x, p.y, p.z]).flat_map(f64::to_le_bytes).collect();
        self.put(name, &bytes);
    }

    /// Where the parts of an array begin, by their lengths; its end last.
    pub(crate) fn put_starts(&self, name: &str, lengths: impl Iterator<Item = usize>) {
        let mut end = 0_u64;
        let mut bytes = end.to_le_bytes().to_vec();
        for length in lengths {
            end += length as u64;
            bytes.extend(end.to_le_bytes());
        }
        self.put(name, &bytes);
    }

    pub(crate) fn bytes(&self, name: &str) -> Vec<u8> {
        let place = self.0.join(name);
        fs::read(&place).unwrap_or_else(|error| panic!("{}: {error}", place.display()))
    }

    pub(crate) fn points(&self, name: &str) -> Vec<Point3<f64>> {
        let bytes = self.bytes(name);
        let numbers: Vec<f64> =
            bytes.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect();
        numbers.as_chunks().0.iter().map(|xyz: &[f64; 3]| Point3::from(*xyz)).collect()
    }

    pub(crate) fn starts(&self, name: &str) -> Vec<usize> {
        let bytes = self.bytes(name);
        bytes.as_chunks().0.iter().map(|b| u64::from_le_bytes(*b) as usize).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_put_is_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let exported = Exported::at(folder.path().join("new"));
        let points = [Point3::new(1.0, -2.5, 3.0), Point3::new(0.1, 0.2, 0.3)];
        exported.put_points("points", points.into_iter());
        exported.put_starts("starts", [2, 0, 3].into_iter());
        assert_eq!(exported.points("points"), points);
        assert_eq!(exported.starts("starts"), [0, 2, 2, 5]);
    }
}
