//! The columns below and above a level line, in order.

use super::ray::Axis;

/// Two faces met within this share of their distance may be met in either order by rays of different
/// pitch: each rounds on its own. The rounding itself is below 1e-15.
const TIE: f64 = 1e-12;

/// A column on the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Crossing {
    /// `x * ny + y`.
    pub(super) column: u32,
    /// Where the level line leaves it, metres from the origin.
    pub(super) out_m: f64,
}

/// Fills `path` with the columns of `shape` that a level line along x and y crosses, its own first.
///
/// `false` if faces of x and y are met so nearly at once that the order is not the same for all
/// pitches; `path` then means nothing. The line starts in the grid.
pub(super) fn trace(line: [Axis; 2], shape: [usize; 2], path: &mut Vec<Crossing>) -> bool {
    path.clear();
    let [x_line, y_line] = line;
    let end = |axis: Axis, n: usize| if axis.step > 0 { n as i64 } else { -1 };
    let (x_end, y_end) = (end(x_line, shape[0]), end(y_line, shape[1]));
    let (mut x, mut y) = (x_line.first, y_line.first);
    let (mut x_m, mut y_m) = (x_line.leaves_m(x), y_line.leaves_m(y));
    let (mut column, mut least_gap) = (x * shape[1] as i64 + y, f64::INFINITY);
    let x_step = x_line.step * shape[1] as i64;
    while x != x_end && y != y_end {
        let out_m = if x_m < y_m { x_m } else { y_m };
        let gap = (x_m - y_m).abs() - TIE * out_m;
        least_gap = if gap < least_gap { gap } else { least_gap };
        path.push(Crossing { column: column as u32, out_m });
        if x_m < y_m {
            (x, column) = (x + x_line.step, column + x_step);
            x_m = x_line.leaves_m(x);
        } else {
            (y, column) = (y + y_line.step, column + y_line.step);
            y_m = y_line.leaves_m(y);
        }
    }
    least_gap > 0.0
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;
    use occlabel_core::GridSpec;

    use super::*;
    use crate::rays::ray::Start;

    fn columns(start: [f64; 2], way: [f64; 2]) -> (bool, Vec<[u32; 2]>) {
        let mut path = vec![];
        let spec = GridSpec::new([0.0; 3], [4.0, 3.0, 1.0], [1.0; 3]).unwrap();
        let start = Start::new(&spec, &Point3::new(start[0], start[1], 0.5));
        let line = [0, 1].map(|axis| start.axis(axis, way[axis]));
        let is_sure = trace(line, [4, 3], &mut path);
        (is_sure, path.iter().map(|crossing| [crossing.column / 3, crossing.column % 3]).collect())
    }

    #[test]
    fn the_columns_of_a_level_line_come_in_order() {
        let (is_sure, path) = columns([0.5, 0.5], [0.8, 0.6]);
        assert!(is_sure);
        assert_eq!(path, [[0, 0], [1, 0], [1, 1], [2, 1], [2, 2], [3, 2]]);
        assert_eq!(columns([3.5, 0.5], [-1.0, 0.0]).1, [[3, 0], [2, 0], [1, 0], [0, 0]]);
    }

    #[test]
    fn a_line_through_an_edge_is_not_sure() {
        assert!(!columns([0.5, 0.5], [0.6, 0.6]).0);
        assert!(!columns([1.0, 1.0], [-0.6, -0.3]).0);
        assert!(columns([1.0, 0.5], [-0.6, -0.4]).0);
    }
}
