//! What each pixel of an image shows.

use crate::{Brush, ClassId};

/// The class that stands for none in a [`ClassMask`].
const NO_CLASS: u8 = u8::MAX;

/// The class, and perhaps the instance, of each pixel of an exposure, by rows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClassMask {
    width: u32,
    height: u32,
    classes: Vec<u8>,
    /// 0 where there is none; empty if nobody told instances apart.
    instances: Vec<u16>,
}

impl ClassMask {
    /// A mask of `width * height` pixels, row by row; `None` where no class is shown.
    ///
    /// # Panics
    /// If there are not so many classes, or a class of 255, which no taxonomy has.
    pub fn new(width: u32, height: u32, classes: impl Iterator<Item = Option<ClassId>>) -> Self {
        let id = |class: Option<ClassId>| class.map_or(NO_CLASS, |class| class.0);
        let classes: Vec<u8> = classes.map(id).collect();
        assert_eq!(classes.len(), width as usize * height as usize, "a class for each pixel");
        Self { width, height, classes, instances: Vec::new() }
    }

    /// The same with the instance of each pixel, by numbers that no track has; 0 where there is none.
    ///
    /// # Panics
    /// If there are not as many as pixels.
    pub fn with_instances(self, instances: Vec<u16>) -> Self {
        assert_eq!(instances.len(), self.classes.len(), "an instance for each pixel");
        Self { instances, ..self }
    }

    /// The same, but that pixels within so many of one of another class, to any side or corner, show
    /// nothing: where one class ends and the next begins, masks and calibrations err.
    pub fn without_borders(mut self, within_px: u32) -> Self {
        let width = self.width as usize;
        let (rows, reach) = (self.classes.chunks_exact(width.max(1)), within_px as usize);
        let even: Vec<bool> = rows.flat_map(|row| even_around(row, reach)).collect();
        let is_inner = |place: usize| {
            let (row, column) = (place / width, place % width);
            let last = (row + reach).min(self.height as usize - 1);
            (row.saturating_sub(reach)..=last).all(|row| {
                let beside = row * width + column;
                even[beside] && self.classes[beside] == self.classes[place]
            })
        };
        let inner: Vec<bool> = (0..self.classes.len()).map(is_inner).collect();
        let borders = self.classes.iter_mut().zip(inner).filter(|(_, is_inner)| !is_inner);
        borders.for_each(|(class, _)| *class = NO_CLASS);
        self
    }

    /// What a pixel shows; `None` if it is of no class, or outside.
    #[inline]
    pub fn at(&self, column: u32, row: u32) -> Option<(ClassId, Brush)> {
        let inside = column < self.width && row < self.height;
        let place = row as usize * self.width as usize + column as usize;
        let class = *self.classes.get(place).filter(|class| inside && **class != NO_CLASS)?;
        let instance = self.instances.get(place).copied().unwrap_or_default();
        Some((ClassId(class), Brush::of_instance(instance)))
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }
}

/// Of each pixel of a row, whether all within reach beside it are of its class.
fn even_around(row: &[u8], reach: usize) -> impl Iterator<Item = bool> {
    let (mut begin, length) = (0, row.len());
    row.chunk_by(|a, b| a == b).flat_map(move |run| {
        let (first, end) = (begin, begin + run.len());
        begin = end;
        (first..end).map(move |column| {
            let from_left = first == 0 || column >= first + reach;
            from_left && (end == length || column + reach < end)
        })
    })
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use proptest::prelude::*;

    use super::*;
    use crate::TrackId;

    #[test]
    fn a_mask_is_read_by_rows_and_ends_at_its_borders() {
        let classes = [Some(3), None, Some(1), Some(4), Some(1), Some(5)];
        let mask = ClassMask::new(3, 2, classes.into_iter().map(|id| id.map(ClassId)));
        let id = |column, row| mask.at(column, row).map(|(class, _)| class.0);
        assert_eq!([id(0, 0), id(1, 0), id(0, 1), id(2, 1)], [Some(3), None, Some(4), Some(5)]);
        assert_eq!([id(3, 0), id(0, 2), id(u32::MAX, u32::MAX)], [None; 3]);
        let told = mask.with_instances(vec![7, 8, 0, 0, 0, 9]);
        assert_eq!(told.at(0, 0), Some((ClassId(3), Brush::of_instance(7))));
        assert_eq!(told.at(2, 1).unwrap().1.instance(), Some(TrackId(9)));
        assert_eq!(told.at(2, 0).unwrap().1.instance(), None);
    }

    /// The oracle: every pixel is compared with all around it.
    fn is_inner(classes: &[u8], [width, height]: [i64; 2], place: usize, reach: i64) -> bool {
        let (row, column) = (place as i64 / width, place as i64 % width);
        let same = |r: i64, c: i64| {
            let inside = (0..height).contains(&r) && (0..width).contains(&c);
            !inside || classes[(r * width + c) as usize] == classes[place]
        };
        (-reach..=reach).all(|r| (-reach..=reach).all(|c| same(row + r, column + c)))
    }

    #[test]
    fn borders_are_what_comparing_every_pair_says() {
        let (inner, border) = (Cell::new(0), Cell::new(0));
        // Blocks of pixels, so that there is an inside.
        let blocks = prop::collection::vec(0_u8..3, 12);
        proptest!(ProptestConfig::with_cases(200), |(blocks in blocks, reach in 0_u32..4)| {
            let block = |place: usize| blocks[place / 24 / 4 * 4 + place % 24 / 6];
            let classes: Vec<u8> = (0..24 * 11).map(block).collect();
            let ids = classes.iter().map(|id| Some(ClassId(*id)));
            let mask = ClassMask::new(24, 11, ids).without_borders(reach);
            for place in 0..classes.len() {
                let expected = is_inner(&classes, [24, 11], place, i64::from(reach));
                let found = mask.at(place as u32 % 24, place as u32 / 24);
                prop_assert_eq!(found.is_some(), expected);
                let count = if expected { &inner } else { &border };
                count.set(count.get() + 1);
            }
        });
        assert!(inner.get() > 5000 && border.get() > 5000, "{} {}", inner.get(), border.get());
    }
}
