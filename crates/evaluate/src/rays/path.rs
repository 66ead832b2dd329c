//! The columns below and above a level line, in order.

use super::ray::Axis;

/// Two faces met within this share of their distance may be met in either order by rays of different
/// pitch: each rounds on its own. The rounding itself is below 1e-15.
const TIE: f64 = 1e-12;

/// A column on the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Crossing {
    pub(super) x: u32,
    pub(super) y: u32,
    /// Where the level line leaves it, metres from the origin.
    pub(super) out_m: f64,
}

/// Fills `path` with the columns of `shape` that a level line along x and y crosses, its own first.
///
/// `false` if faces of x and y are met so nearly at once that the order is not the same for all
/// pitches; `path` then means nothing. The line starts in the grid.
pub(super) fn trace(line: [Axis; 2], shape: [usize; 2], path: &mut Vec<Crossing>) -> bool {
    path.clear();
    let mut voxel = line.map(|axis| axis.first);
    let ends = [0, 1].map(|axis| if line[axis].step > 0 { shape[axis] as i64 } else { -1 });
    let mut leaves_m = [0, 1].map(|axis| line[axis].leaves_m(voxel[axis]));
    let mut is_sure = true;
    while voxel[0] != ends[0] && voxel[1] != ends[1] {
        let [x_m, y_m] = leaves_m;
        let out_m = x_m.min(y_m);
        is_sure &= (x_m - y_m).abs() > TIE * out_m;
        path.push(Crossing { x: voxel[0] as u32, y: voxel[1] as u32, out_m });
        let axis = usize::from(y_m < x_m);
        voxel[axis] += line[axis].step;
        leaves_m[axis] = line[axis].leaves_m(voxel[axis]);
    }
    is_sure
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(start: [f64; 2], way: [f64; 2]) -> (bool, Vec<[u32; 2]>) {
        let mut path = vec![];
        let line = [0, 1].map(|axis| Axis::new(start[axis], 1.0, way[axis]));
        let is_sure = trace(line, [4, 3], &mut path);
        (is_sure, path.iter().map(|crossing| [crossing.x, crossing.y]).collect())
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
        assert!(columns([1.0, 0.5], [-0.6, -0.3]).0);
    }
}
