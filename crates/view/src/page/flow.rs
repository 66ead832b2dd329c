//! Flow made small: to 1 cm/s, and only where something moves or nobody knows.

use super::bits::BitWriter;
use super::counts::zigzag;
use super::deflate::deflate;

/// Velocities are written in these, metres per second.
pub(crate) const STEP_MPS: f32 = 0.01;
/// In place of a velocity that is not known. Known ones saturate before it.
const UNKNOWN: i16 = i16::MIN;

/// Parts: a bit a voxel, set where the flow is not 0; then for each axis the steps from one such voxel
/// to the next, low bytes and high bytes.
pub(crate) fn encode(flow: &[[f32; 3]]) -> Vec<Vec<u8>> {
    let rounded = |flow: &[f32; 3]| flow.map(round);
    let mut places = BitWriter::default();
    flow.iter().for_each(|flow| places.push(u32::from(rounded(flow) != [0; 3]), 1));
    let moving: Vec<_> = flow.iter().map(rounded).filter(|flow| *flow != [0; 3]).collect();
    let mut parts = vec![deflate(&places.bytes())];
    for axis in 0..3 {
        let before = std::iter::once(0).chain(moving.iter().map(|flow| flow[axis]));
        let steps = moving.iter().zip(before).map(|(flow, before)| step(before, flow[axis]));
        let [low, high]: [Vec<u8>; 2] =
            steps.fold(Default::default(), |[mut low, mut high], [l, h]| {
                low.push(l);
                high.push(h);
                [low, high]
            });
        parts.extend([deflate(&low), deflate(&high)]);
    }
    parts
}

fn round(velocity_mps: f32) -> i16 {
    if velocity_mps.is_nan() {
        UNKNOWN
    } else {
        ((velocity_mps / STEP_MPS).round() as i16).max(-i16::MAX)
    }
}

fn step(before: i16, now: i16) -> [u8; 2] {
    (zigzag(i32::from(now.wrapping_sub(before))) as u16).to_le_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn velocities_are_rounded_to_a_centimetre_per_second() {
        let rounded = [0.0, 0.004, -0.006, 33.333, 1e9, -1e9, f32::INFINITY].map(round);
        assert_eq!(rounded, [0, 0, -1, 3333, i16::MAX, -i16::MAX, i16::MAX]);
        assert_eq!(round(f32::NAN), UNKNOWN);
    }
}
