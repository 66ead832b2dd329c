//! What is written.

use std::ops::AddAssign;

/// Which exposures become image files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Images {
    /// None: the log tells of the keyframes' exposures, but their files are absent.
    None,
    /// Those of keyframes.
    #[default]
    Keyframes,
    /// All of every camera.
    All,
}

/// How much a log holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Written {
    /// Drives.
    pub scenes: usize,
    /// Sweeps of all lidars.
    pub sweeps: usize,
    /// Sweeps whose points are labelled.
    pub labelled: usize,
    /// Points of all sweeps.
    pub points: usize,
    /// Keyframes.
    pub keyframes: usize,
    /// Annotated boxes.
    pub boxes: usize,
    /// Image files, masks not counted.
    pub images: usize,
}

impl AddAssign for Written {
    fn add_assign(&mut self, more: Self) {
        self.scenes += more.scenes;
        self.sweeps += more.sweeps;
        self.labelled += more.labelled;
        self.points += more.points;
        self.keyframes += more.keyframes;
        self.boxes += more.boxes;
        self.images += more.images;
    }
}
