//! Sweeps that a log holds twice.

use std::path::Path;

use super::captures::Capture;
use crate::files::read_file;
use crate::notes::Notes;

/// The sweeps without repetitions: of those of one lidar and time that hold the same bytes, one
/// stays, a key frame's if one is. Others of one lidar and time all stay. Both is noted.
pub(super) fn without_copies<'a>(
    sweeps: &[Capture<'a>],
    root: &Path,
    notes: &mut Notes,
) -> Vec<Capture<'a>> {
    let mut kept = Vec::with_capacity(sweeps.len());
    for moment in sweeps.chunk_by(|a, b| (a.time, a.channel) == (b.time, b.channel)) {
        match moment {
            [only] => kept.push(*only),
            _ => kept.extend(distinct(moment, root, notes)),
        }
    }
    kept
}

/// Of the sweeps of one lidar and time those that hold different bytes, in order. Key sweeps of two
/// samples both stay, whatever they hold.
fn distinct<'a>(moment: &[Capture<'a>], root: &Path, notes: &mut Notes) -> Vec<Capture<'a>> {
    let mut kept: Vec<(Payload<'a>, Capture<'a>)> = Vec::new();
    let (keys, others): (Vec<Capture<'a>>, Vec<Capture<'a>>) =
        moment.iter().copied().partition(|sweep| sweep.row.is_key_frame);
    let mut warn = |rule, sweep: &Capture<'a>, found: &str| {
        notes.warn(sweep.row.fault(rule, "one sweep of a lidar at a time", found));
    };
    for sweep in keys.into_iter().chain(others) {
        let payload = payload(root, &sweep);
        let is_known = kept.iter().any(|(known, _)| *known == payload);
        if is_known && !sweep.row.is_key_frame {
            warn("sweep-copied", &sweep, "another of the same bytes, which is left out");
            continue;
        }
        if !kept.is_empty() {
            warn("time-repeated", &sweep, "another: both are kept");
        }
        kept.push((payload, sweep));
    }
    kept.sort_by_key(|(_, sweep)| sweep.order());
    kept.into_iter().map(|(_, sweep)| sweep).collect()
}

/// What tells a sweep's bytes from others': their hash, or the name of a file that cannot be read.
type Payload<'a> = Result<blake3::Hash, &'a str>;

fn payload<'a>(root: &Path, sweep: &Capture<'a>) -> Payload<'a> {
    let file = sweep.row.filename.as_str();
    read_file(root, file).map(|bytes| blake3::hash(&bytes)).map_err(|_| file)
}
