//! How far a beam goes before it may see anything new.

use std::ops::Range;

use crate::beam::{Beam, Slopes};
use crate::look::Look;

/// How often a layer is halved where its voxels as a whole say nothing.
const HALVINGS: u32 = 4;

/// How far the rays of a beam have come, all that they saw having been seen before.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Front {
    /// The beam's main axis.
    pub(crate) axis: usize,
    /// Faces of that axis up to which surely no ray has ended.
    pub(crate) sure: i64,
    /// Faces of that axis up to which nothing new was seen; rays outside the bounds have ended.
    pub(crate) faces: i64,
    /// Bounds of the rays that may go on.
    pub(crate) bounds: [Slopes; 2],
}

/// Lets a beam go on from where it was until it may see something new; `None` if it never does.
pub(crate) fn march(look: &Look, mut beam: Beam, from: Option<&Front>) -> Option<Front> {
    let start = look.start.voxel().0[beam.axis];
    let layers = look.spec.shape()[beam.axis] as i64;
    let first_face = {
        let up = 1.0 - look.start_within(beam.axis);
        if beam.is_up { up } else { 1.0 - up }
    };
    let room = if beam.is_up { layers - 1 - start } else { start };
    let last = room.min((beam.far - first_face).max(-1.0) as i64 + 2);
    let mut sure = from.map(|front| front.sure);
    for faces in from.map_or(0, |front| front.faces)..=last {
        let layer = (if beam.is_up { start + faces } else { start - faces }) as usize;
        let leave = first_face + faces as f64;
        let part = (leave - 1.0).max(0.0)..leave;
        match pass(look, &mut beam, layer, &part, HALVINGS) {
            Finding::Open => {}
            Finding::Seen => sure = sure.or(Some(faces)),
            Finding::End => return None,
            Finding::New => {
                let sure = sure.unwrap_or(faces);
                return Some(Front { axis: beam.axis, sure, faces, bounds: beam.slopes });
            }
        }
    }
    None
}

/// What a beam finds on a part of its way.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Finding {
    /// All is seen, and lets every ray pass.
    Open,
    /// All is seen; rays may have ended.
    Seen,
    /// All is seen, and no ray goes on.
    End,
    /// Maybe something new.
    New,
}

/// Finds what a beam meets in a part of a layer; its slopes lose rays that end there.
#[inline]
fn pass(look: &Look, beam: &mut Beam, layer: usize, part: &Range<f64>, halvings: u32) -> Finding {
    let Some(ranges) = ranges(look, beam, layer, part) else { return Finding::End };
    if look.all_open(&ranges) {
        return Finding::Open;
    }
    pass_closely(look, beam, layer, part, ranges, halvings)
}

#[inline(never)]
fn pass_closely(
    look: &Look,
    beam: &mut Beam,
    layer: usize,
    part: &Range<f64>,
    mut ranges: [Range<usize>; 3],
    halvings: u32,
) -> Finding {
    let before = beam.slopes;
    let is_left = clip(look, beam, part, &mut ranges);
    if look.all_seen(&ranges) {
        return if is_left { Finding::Seen } else { Finding::End };
    }
    // A ray that ends here may see something new before it does.
    beam.slopes = before;
    let is_one = ranges.iter().all(|range| range.len() == 1);
    if halvings == 0 || is_one {
        return Finding::New;
    }
    let middle = (part.start + part.end) / 2.0;
    match pass(look, beam, layer, &(part.start..middle), halvings - 1) {
        first @ (Finding::Open | Finding::Seen) => {
            match pass(look, beam, layer, &(middle..part.end), halvings - 1) {
                Finding::Open => first,
                second => second,
            }
        }
        end_or_new => end_or_new,
    }
}

/// The voxels of a layer that a beam may be in; `None` if it has left the grid.
#[inline]
fn ranges(look: &Look, beam: &Beam, layer: usize, part: &Range<f64>) -> Option<[Range<usize>; 3]> {
    let shape = look.spec.shape();
    let mut ranges = [layer..layer + 1, layer..layer + 1, layer..layer + 1];
    for (slopes, &other) in beam.slopes.iter().zip(&beam.others) {
        ranges[other] = slopes.voxels(part, shape[other])?;
    }
    Some(ranges)
}

/// Cuts off sides of the voxels that end every ray that enters them; tells whether a ray is left.
fn clip(look: &Look, beam: &mut Beam, part: &Range<f64>, ranges: &mut [Range<usize>; 3]) -> bool {
    loop {
        let before = ranges.clone();
        for (slopes, &other) in beam.slopes.iter_mut().zip(&beam.others) {
            let Range { start, end } = ranges[other];
            let is_shut = |at: usize| {
                let mut side = ranges.clone();
                side[other] = at..at + 1;
                look.all_shut(&side)
            };
            if is_shut(start) {
                ranges[other] = start + 1..end;
                if start + 1 == end || !slopes.keep_above(start + 1, part) {
                    return false;
                }
            } else if is_shut(end - 1) {
                ranges[other] = start..end - 1;
                if !slopes.keep_below(end - 1, part) {
                    return false;
                }
            }
        }
        if *ranges == before {
            return true;
        }
    }
}
