//! How near the nearest return is, pixel by pixel.

/// The distance of the nearest return around each pixel of an image.
pub(crate) struct DepthBuffer {
    width: u32,
    height: u32,
    nearest_m: Vec<f32>,
}

impl DepthBuffer {
    /// An image in which nothing is near.
    pub(crate) fn new(width: u32, height: u32) -> Self {
        let pixels = width as usize * height as usize;
        Self { width, height, nearest_m: vec![f32::INFINITY; pixels] }
    }

    /// Puts down a return: a square reaching `splat_px` pixels to each side of its own.
    pub(crate) fn splat(&mut self, (column, row): (u32, u32), distance_m: f32, splat_px: u32) {
        let last_column = column.saturating_add(splat_px).min(self.width - 1);
        let last_row = row.saturating_add(splat_px).min(self.height - 1);
        for row in row.saturating_sub(splat_px)..=last_row {
            let begin = row as usize * self.width as usize;
            let columns = column.saturating_sub(splat_px) as usize..=last_column as usize;
            for nearest_m in &mut self.nearest_m[begin..][columns] {
                *nearest_m = nearest_m.min(distance_m);
            }
        }
    }

    /// The nearest return around a pixel, metres; infinite where there is none.
    pub(crate) fn nearest_m(&self, (column, row): (u32, u32)) -> f32 {
        self.nearest_m[row as usize * self.width as usize + column as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_return_hides_a_square_around_it() {
        let mut buffer = DepthBuffer::new(5, 4);
        buffer.splat((4, 0), 9.0, 1);
        buffer.splat((3, 1), 5.0, 0);
        buffer.splat((0, 3), 2.0, 1);
        let drawn: Vec<String> =
            (0..4)
                .map(|row| {
                    let near = |column| buffer.nearest_m((column, row));
                    (0..5)
                        .map(|c| {
                            if near(c).is_finite() { char::from(b'0' + near(c) as u8) } else { '.' }
                        })
                        .collect()
                })
                .collect();
        assert_eq!(drawn, ["...99", "...59", "22...", "22..."]);
    }
}
