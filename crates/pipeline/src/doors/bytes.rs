//! Numbers out of bytes.

use nalgebra::{Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use occlabel_core::Pose;

/// Nothing that a reader lets pass stands farther from its frame's origin along an axis, metres.
const FARTHEST_M: f64 = 1e9;

/// Numbers that are likelier to break something than others.
const ODD: [f64; 16] = [
    0.0,
    -0.0,
    0.5,
    1.0,
    -1.0,
    1e-9,
    1e6,
    -1e9,
    1e18,
    1e300,
    f64::MIN_POSITIVE,
    5e-324,
    f64::MAX,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
];

/// Numbers out of bytes, one after the other; zeros once they end.
pub(super) struct Bytes<'a>(pub(super) &'a [u8]);

impl Bytes<'_> {
    fn array<const N: usize>(&mut self) -> [u8; N] {
        std::array::from_fn(|_| self.byte())
    }

    /// Whether there are more.
    pub(super) fn has_more(&self) -> bool {
        !self.0.is_empty()
    }

    pub(super) fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        *first
    }

    /// A number below another, of at most 256.
    pub(super) fn below(&mut self, end: usize) -> usize {
        usize::from(self.byte()) % end
    }

    pub(super) fn flag(&mut self) -> bool {
        self.byte() & 1 == 1
    }

    pub(super) fn of<T: Copy, const N: usize>(&mut self, choices: [T; N]) -> T {
        choices[self.below(N)]
    }

    pub(super) fn whole(&mut self) -> i64 {
        i64::from_le_bytes(self.array())
    }

    /// Any number, most often a plain one.
    pub(super) fn number(&mut self) -> f64 {
        match self.byte() % 8 {
            0 => ODD[self.below(ODD.len())],
            1 => f64::from_bits(u64::from_le_bytes(self.array())),
            2 => f64::from(f32::from_le_bytes(self.array())),
            _ => f64::from(i16::from_le_bytes(self.array())) / 256.0,
        }
    }

    pub(super) fn numbers<const N: usize>(&mut self) -> [f64; N] {
        std::array::from_fn(|_| self.number())
    }

    /// Between two limits, both included.
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * f64::from(u16::from_le_bytes(self.array())) / 65535.0
    }

    /// A coordinate as readers let it pass.
    pub(super) fn metres(&mut self) -> f64 {
        let metres = self.number();
        if metres.is_finite() { metres.clamp(-FARTHEST_M, FARTHEST_M) } else { 0.0 }
    }

    pub(super) fn place(&mut self) -> Point3<f64> {
        Point3::new(self.metres(), self.metres(), self.metres())
    }

    /// A size as readers let it pass.
    pub(super) fn size_m(&mut self) -> Vector3<f64> {
        self.place().coords.map(|metres| metres.abs().max(1e-6))
    }

    /// Upright, turned about z, or turned anyhow.
    pub(super) fn pose(&mut self) -> Pose {
        let [w, i, j, k] = match self.byte() % 4 {
            0 => [1.0, 0.0, 0.0, 0.0],
            1 | 2 => [self.between(-1.0, 1.0), 0.0, 0.0, 1.0],
            _ => [1.0, self.between(-2.0, 2.0), self.between(-2.0, 2.0), self.between(-2.0, 2.0)],
        };
        let rotation = UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k));
        Pose::from_parts(Translation3::from(self.place().coords), rotation)
    }
}
