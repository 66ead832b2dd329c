//! The order of the voxels in a file's array, and ours: `[x][y][z]`, index 0 at the lower corner.

use serde::Deserialize;

/// The order of the voxels in a file's array.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Order {
    /// The axes of the array, the slowest first: `xyz` is our own order.
    pub axes: Axes,
    /// The axes along which index 0 lies at the upper end.
    pub reversed: Vec<Axis>,
}

/// The three axes in some order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub struct Axes([usize; 3]);

/// An axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
#[expect(missing_docs, reason = "each is named for what it is")]
pub enum Axis {
    X,
    Y,
    Z,
}

impl Default for Axes {
    fn default() -> Self {
        Self([0, 1, 2])
    }
}

impl TryFrom<String> for Axes {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let places: Vec<_> = text.chars().map(|axis| "xyz".find(axis)).collect();
        match places[..] {
            [Some(a), Some(b), Some(c)] if a != b && b != c && c != a => Ok(Self([a, b, c])),
            _ => Err(format!("expected x, y and z in some order, found `{text}`")),
        }
    }
}

impl Order {
    /// Whether it is our own.
    pub fn is_ours(&self) -> bool {
        self.axes == Axes::default() && self.reversed.is_empty()
    }

    /// The shape of a file's array of a grid of this shape.
    pub fn file_shape(&self, shape: [usize; 3]) -> [usize; 3] {
        self.axes.0.map(|axis| shape[axis])
    }

    /// The shape of the grid whose array in a file has this shape.
    pub fn grid_shape(&self, file_shape: [usize; 3]) -> [usize; 3] {
        let mut shape = [0; 3];
        for (place, axis) in self.axes.0.into_iter().enumerate() {
            shape[axis] = file_shape[place];
        }
        shape
    }

    /// The place in our order of each voxel of a file, in the file's order.
    pub fn places(&self, shape: [usize; 3]) -> impl Iterator<Item = usize> + use<> {
        let sides = self.file_shape(shape);
        let ours = [shape[1] * shape[2], shape[2], 1];
        let steps = self.axes.0.map(|axis| ours[axis]);
        let is_reversed =
            self.axes.0.map(|axis| self.reversed.iter().any(|&at| at as usize == axis));
        let place = move |axis: usize, index: usize| {
            steps[axis] * if is_reversed[axis] { sides[axis] - 1 - index } else { index }
        };
        (0..sides[0]).flat_map(move |a| {
            (0..sides[1]).flat_map(move |b| {
                (0..sides[2]).map(move |c| place(0, a) + place(1, b) + place(2, c))
            })
        })
    }

    /// Items of so many bytes for each voxel, from a file's order into ours.
    pub fn to_ours(&self, shape: [usize; 3], item: usize, bytes: Vec<u8>) -> Vec<u8> {
        if self.is_ours() {
            return bytes;
        }
        let mut ordered = vec![0; bytes.len()];
        for (at, place) in self.places(shape).enumerate() {
            ordered[place * item..][..item].copy_from_slice(&bytes[at * item..][..item]);
        }
        ordered
    }

    /// Items of so many bytes for each voxel, from our order into a file's.
    pub fn to_file(&self, shape: [usize; 3], item: usize, bytes: Vec<u8>) -> Vec<u8> {
        if self.is_ours() {
            return bytes;
        }
        let mut ordered = Vec::with_capacity(bytes.len());
        for place in self.places(shape) {
            ordered.extend_from_slice(&bytes[place * item..][..item]);
        }
        ordered
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn order(axes: &str, reversed: &[Axis]) -> Order {
        Order { axes: axes.to_owned().try_into().unwrap(), reversed: reversed.to_vec() }
    }

    #[test]
    fn a_file_s_order_is_told_by_its_axes() {
        let zyx = order("zyx", &[]);
        assert_eq!(zyx.file_shape([4, 3, 2]), [2, 3, 4]);
        assert_eq!(zyx.grid_shape([2, 3, 4]), [4, 3, 2]);
        // one step along x in the file is a step of 3 * 2 voxels with us
        assert_eq!(zyx.places([4, 3, 2]).take(5).collect::<Vec<_>>(), [0, 6, 12, 18, 2]);
        let reversed = order("xyz", &[Axis::Y]);
        assert_eq!(reversed.places([4, 3, 2]).take(7).collect::<Vec<_>>(), [4, 5, 2, 3, 0, 1, 10]);
    }

    #[test]
    fn every_order_and_back_is_the_identity() {
        let bytes: Vec<u8> = (0..48).collect();
        let mut tried = 0;
        for axes in ["xyz", "xzy", "yxz", "yzx", "zxy", "zyx"] {
            for reversed in [&[][..], &[Axis::X], &[Axis::Y, Axis::Z]] {
                let order = order(axes, reversed);
                let there = order.to_file([4, 3, 2], 2, bytes.clone());
                assert_eq!(there == bytes, order.is_ours(), "{order:?}");
                assert_eq!(order.to_ours([4, 3, 2], 2, there), bytes, "{order:?}");
                tried += 1;
            }
        }
        assert_eq!(tried, 18);
        assert!(
            Axes::try_from("xyy".to_owned()).is_err() && Axes::try_from("xyzx".to_owned()).is_err()
        );
    }
}
