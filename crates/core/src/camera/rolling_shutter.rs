//! How a rolling shutter reads an image.

/// A rolling shutter: lines of the image are exposed one after the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollingShutter {
    /// Order in which lines are read.
    pub direction: ShutterDirection,
    /// Time from the first line to the last, in seconds.
    pub readout_s: f64,
}

/// The order in which a rolling shutter reads the lines of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShutterDirection {
    /// Rows, the uppermost first.
    TopToBottom,
    /// Rows, the lowest first.
    BottomToTop,
    /// Columns, the leftmost first.
    LeftToRight,
    /// Columns, the rightmost first.
    RightToLeft,
}
