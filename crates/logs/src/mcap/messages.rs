//! What messages say, whatever their encoding.

use occlabel_core::Timestamp;

/// When and where something was measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Header {
    /// Its own time; 0 if it has none.
    pub(super) time: Timestamp,
    /// The frame of its coordinates.
    pub(super) frame: String,
}

/// A rigid transform as written: metres, and a quaternion x, y, z, w.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RawPose {
    pub(super) translation: [f64; 3],
    pub(super) rotation: [f64; 4],
}

impl RawPose {
    /// What a message means that has none.
    pub(super) const IDENTITY: Self =
        Self { translation: [0.0; 3], rotation: [0.0, 0.0, 0.0, 1.0] };
}

/// Points of one revolution, undecoded.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cloud {
    pub(super) header: Header,
    /// `frame_from_points`.
    pub(super) pose: RawPose,
    pub(super) fields: Vec<Field>,
    /// Rows of `width` points, `row_step` bytes from one to the next; one row if the format has none.
    pub(super) rows: usize,
    pub(super) width: usize,
    pub(super) row_step: usize,
    pub(super) point_step: usize,
    pub(super) big_endian: bool,
    pub(super) data: Vec<u8>,
}

/// A number of each point.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Field {
    pub(super) name: String,
    /// From the point's first byte.
    pub(super) offset: usize,
    pub(super) kind: NumberKind,
}

/// How a number is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NumberKind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// `parent_from_child` at a time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Link {
    pub(super) header: Header,
    pub(super) child: String,
    pub(super) parent_from_child: RawPose,
}

/// A camera's optics.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Optics {
    pub(super) header: Header,
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) model: String,
    pub(super) distortion: Vec<f64>,
    /// 3 x 3, rows first.
    pub(super) matrix: Vec<f64>,
}

/// Boxes, and what they replace.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Boxes {
    pub(super) cubes: Vec<Cube>,
    /// Times at which every box was taken away: annotated, if with nothing.
    pub(super) cleared: Vec<Timestamp>,
}

/// A box of a track.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cube {
    pub(super) header: Header,
    pub(super) track: String,
    pub(super) category: String,
    /// `frame_from_box`.
    pub(super) pose: RawPose,
    /// Length, width, height.
    pub(super) size_m: [f64; 3],
}

/// An image, undecoded.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Picture {
    pub(super) header: Header,
    pub(super) data: Vec<u8>,
}

/// What is wrong with a message: expected, found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Defect {
    pub(super) expected: String,
    pub(super) found: String,
}

impl Defect {
    /// A defect.
    pub(super) fn new(expected: impl Into<String>, found: impl Into<String>) -> Self {
        Self { expected: expected.into(), found: found.into() }
    }
}

/// Seconds and nanoseconds since the epoch.
pub(super) fn timestamp(seconds: i64, nanos: i64) -> Timestamp {
    Timestamp(seconds.saturating_mul(1_000_000_000).saturating_add(nanos))
}

/// A frame's name without the leading stroke that ROS 1 allowed.
pub(super) fn frame_name(name: &str) -> String {
    name.strip_prefix('/').unwrap_or(name).to_owned()
}
