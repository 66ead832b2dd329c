//! The unlabelled points of a scene, numbered, and the verdicts on them.

use std::sync::atomic::{AtomicU16, Ordering};

use nalgebra::Point3;
use occlabel_core::{BackgroundSweep, ClassId};

use crate::groups::Item;

/// Points of a piece: its own part of a number counts them.
const POINTS_A_PIECE: usize = 1 << 16;

/// Points that are relabelled at a time, which bounds the memory for ordering them.
const POINTS_A_ROUND: usize = 1 << 24;

/// A piece counts as so many points at least: thus a round has at most 2^16 pieces.
const LEAST_POINTS: usize = POINTS_A_ROUND >> 16;

/// What was found for a point. Written by any thread, each by one.
pub(crate) struct Verdict(AtomicU16);

/// Consecutive points of one sweep.
struct Piece<'a> {
    positions: &'a [Point3<f64>],
    labels: &'a [Option<ClassId>],
    verdicts: &'a [Verdict],
    /// Points before it.
    before: usize,
}

/// The pieces of a scene.
pub(crate) struct Unlabelled<'a>(Vec<Piece<'a>>);

/// Pieces that are relabelled together. A point's number is its piece, then its place in that.
pub(crate) struct Round<'a>(&'a [Piece<'a>]);

impl Verdict {
    const NONE: u16 = 0x100;

    /// The class found; `None` if none was.
    pub(crate) fn class(&self) -> Option<ClassId> {
        u8::try_from(self.0.load(Ordering::Relaxed)).ok().map(ClassId)
    }

    fn set(&self, class: Option<ClassId>) {
        self.0.store(class.map_or(Self::NONE, |class| u16::from(class.0)), Ordering::Relaxed);
    }
}

impl Default for Verdict {
    fn default() -> Self {
        Self(AtomicU16::new(Self::NONE))
    }
}

impl<'a> Unlabelled<'a> {
    /// The pieces of sweeps, with a verdict for each of their points.
    pub(crate) fn new(
        sweeps: &'a [BackgroundSweep<Option<ClassId>>],
        verdicts: &'a [Vec<Verdict>],
    ) -> Self {
        let mut pieces: Vec<Piece<'a>> = Vec::new();
        for (sweep, verdicts) in sweeps.iter().zip(verdicts) {
            let positions = sweep.cloud.positions.chunks(POINTS_A_PIECE);
            let labels = sweep.cloud.labels.chunks(POINTS_A_PIECE);
            for ((positions, labels), verdicts) in
                positions.zip(labels).zip(verdicts.chunks(POINTS_A_PIECE))
            {
                let end = |last: &Piece<'_>| last.before + last.positions.len().max(LEAST_POINTS);
                let before = pieces.last().map_or(0, end);
                pieces.push(Piece { positions, labels, verdicts, before });
            }
        }
        Self(pieces)
    }

    /// The pieces by rounds.
    pub(crate) fn rounds(&'a self) -> impl Iterator<Item = Round<'a>> {
        let round = |piece: &Piece<'_>| piece.before / POINTS_A_ROUND;
        self.0.chunk_by(move |a, b| round(a) == round(b)).map(Round)
    }
}

impl Round<'_> {
    /// Its unlabelled points.
    pub(crate) fn items(&self) -> Vec<Item> {
        let unlabelled = |piece: &Piece<'_>| piece.labels.iter().filter(|l| l.is_none()).count();
        let mut items = Vec::with_capacity(self.0.iter().map(unlabelled).sum());
        let center = self.position(0);
        for (high, piece) in (0_u32..).zip(self.0) {
            let points = (0_u32..).zip(piece.positions.iter().zip(piece.labels));
            let unlabelled = points.filter(|(_, (_, label))| label.is_none());
            items.extend(unlabelled.map(|(low, (p, _))| Item::new(p, &center, high << 16 | low)));
        }
        items
    }

    /// Where the point of a number is.
    #[inline]
    pub(crate) fn position(&self, number: u32) -> Point3<f64> {
        self.0[(number >> 16) as usize].positions[(number & 0xffff) as usize]
    }

    /// Notes what was found for the point of a number.
    #[inline]
    pub(crate) fn set(&self, number: u32, class: Option<ClassId>) {
        self.0[(number >> 16) as usize].verdicts[(number & 0xffff) as usize].set(class);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use occlabel_core::{PointCloud, Timestamp};

    /// A sweep of points at (its number, 0, 0), (its number, 1, 0), ...; every third has a label.
    fn sweep(x: usize, count: usize) -> BackgroundSweep<Option<ClassId>> {
        let mut cloud = PointCloud::with_origins(vec![Point3::origin()]);
        for y in 0..count {
            let label = (y % 3 == 0).then_some(ClassId(1));
            cloud.push(Point3::new(x as f64, y as f64, 0.0), label, 0);
        }
        BackgroundSweep::new(Timestamp(0), cloud)
    }

    #[test]
    fn verdicts_go_to_the_points_that_items_stand_for() {
        let sweeps = [sweep(0, 100_000), sweep(1, 0), sweep(2, 70_001)];
        let verdicts: Vec<Vec<Verdict>> = (sweeps.iter())
            .map(|sweep| sweep.cloud.labels.iter().map(|_| Verdict::default()).collect())
            .collect();
        let unlabelled = Unlabelled::new(&sweeps, &verdicts);
        for (round, item) in unlabelled.rounds().flat_map(|round| {
            let items = round.items();
            items.into_iter().map(move |item| (Round(round.0), item))
        }) {
            let p = round.position(item.number());
            round.set(item.number(), Some(ClassId((p.x + 7.0 * p.y) as u64 as u8)));
        }
        for (x, (sweep, verdicts)) in sweeps.iter().zip(&verdicts).enumerate() {
            for (y, (label, verdict)) in sweep.cloud.labels.iter().zip(verdicts).enumerate() {
                let expected = label.is_none().then_some(ClassId((x + 7 * y) as u8));
                assert_eq!(verdict.class(), expected, "point {y} of sweep {x}");
            }
        }
    }

    #[test]
    fn a_round_has_no_more_pieces_than_its_numbers_tell_apart() {
        let sweeps: Vec<_> = (0..70_000).map(|x| sweep(x, 1)).collect();
        let verdicts: Vec<Vec<Verdict>> = sweeps.iter().map(|_| vec![Verdict::default()]).collect();
        let unlabelled = Unlabelled::new(&sweeps, &verdicts);
        let pieces: Vec<usize> = unlabelled.rounds().map(|round| round.0.len()).collect();
        assert_eq!(pieces, [1 << 16, 70_000 - (1 << 16)]);
    }
}
