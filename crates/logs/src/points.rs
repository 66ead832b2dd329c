//! The points of a sweep's file.

use std::path::Path;

use nalgebra::Point3;
use occlabel_core::{Fault, SweepHeader, is_finite};

use crate::files::file_bytes;

/// Numbers a point in a sweep's file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointColumns {
    /// x, y, z, intensity, as KITTI has it.
    Four,
    /// x, y, z, intensity, ring, as nuScenes has it.
    Five,
}

impl PointColumns {
    fn count(self) -> usize {
        match self {
            Self::Four => 4,
            Self::Five => 5,
        }
    }

    /// Bytes of a point.
    fn bytes(self) -> usize {
        4 * self.count()
    }

    /// How many points the files of sweeps hold, by their sizes; an absent one holds none.
    pub(crate) fn points_in(self, root: &Path, sweeps: &[SweepHeader]) -> u64 {
        let points = |sweep: &SweepHeader| file_bytes(root, &sweep.file) / self.bytes() as u64;
        sweeps.iter().map(points).sum()
    }
}

/// The points of a file of 32-bit little-endian numbers, lidar frame, metres; and what is odd.
///
/// Without `columns` there have to be five, and the fifth has to look like a ring: a file of four
/// columns can have a length that fits five.
///
/// # Errors
/// If the bytes are no whole number of points, or look like four columns.
pub(crate) fn decode_points(
    bytes: &[u8],
    file: &str,
    columns: Option<PointColumns>,
) -> Result<(Vec<Point3<f64>>, Vec<Fault>), Fault> {
    let stride = columns.unwrap_or(PointColumns::Five);
    if !bytes.len().is_multiple_of(stride.bytes()) {
        return Err(wrong_length(bytes.len(), file, stride));
    }
    let fits_four = bytes.len().is_multiple_of(PointColumns::Four.bytes());
    if columns.is_none() && fits_four && !has_rings(bytes) {
        let found = "a fifth column that is mostly no ring";
        return Err(four_columns(Fault::new("sweep-columns", file, "five columns", found)));
    }
    let points: Vec<_> = bytes.chunks_exact(stride.bytes()).map(position).collect();
    let warnings = oddities(&points, file);
    Ok((points, warnings))
}

#[inline]
fn position(point: &[u8]) -> Point3<f64> {
    let metres = |column| f64::from(number(point, column));
    Point3::new(metres(0), metres(1), metres(2))
}

/// A column of a point; NaN if the point has no such column.
#[inline]
fn number(point: &[u8], column: usize) -> f32 {
    let bytes = point[4 * column..].first_chunk();
    bytes.map_or(f32::NAN, |bytes| f32::from_le_bytes(*bytes))
}

/// Whether at least half of the points have a whole number below 256 as their fifth: the largest
/// lidars have 128 beams.
fn has_rings(bytes: &[u8]) -> bool {
    let is_ring = |ring: f32| f32::from(ring as u8) == ring;
    let points = bytes.chunks_exact(PointColumns::Five.bytes());
    let all = points.len();
    2 * points.filter(|point| is_ring(number(point, 4))).count() >= all
}

fn wrong_length(bytes: usize, file: &str, columns: PointColumns) -> Fault {
    let (each, count) = (columns.bytes(), columns.count());
    let expected = format!("a multiple of {each} bytes ({count} columns)");
    let found = format!("{bytes} bytes, {} more than {} points", bytes % each, bytes / each);
    let fault = Fault::new("sweep-length", file, expected, found);
    match columns == PointColumns::Five && bytes.is_multiple_of(PointColumns::Four.bytes()) {
        true => four_columns(fault),
        false => fault,
    }
}

fn four_columns(fault: Fault) -> Fault {
    fault.hint("looks like 4-column KITTI: if it is, `--columns 4` reads it")
}

fn oddities(points: &[Point3<f64>], file: &str) -> Vec<Fault> {
    let (bad, all) = (points.iter().filter(|point| !is_finite(point)).count(), points.len());
    if all == 0 {
        vec![Fault::new("sweep-empty", file, "points", "none")]
    } else if 2 * bad > all {
        let found = format!("{bad} of {all} points with a NaN or an infinity");
        vec![Fault::new("sweep-not-finite", file, "finite coordinates", found)]
    } else {
        Vec::new()
    }
}
