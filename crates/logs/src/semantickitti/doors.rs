//! Whole logs in SemanticKITTI's layout, for whoever throws bytes at them.

use occlabel_testkit::in_folder;

use super::SemanticKittiLog;
use crate::SceneSource;
use crate::doors::read_options;

/// The files of a sound sequence of two sweeps.
const FILES: [(&str, &[u8]); 7] = [
    ("sequences/00/calib.txt", b"P2: 7 0 6 4 0 7 1 0 0 0 1 0\nTr: 0 -1 0 1 0 0 -1 2 1 0 0 3\n"),
    ("sequences/00/poses.txt", b"1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 1.5\n"),
    ("sequences/00/times.txt", b"0\n1.03736e-01\n"),
    ("sequences/00/velodyne/000000.bin", &[0; 16]),
    ("sequences/00/velodyne/000001.bin", &[64; 32]),
    ("sequences/00/labels/000000.label", &[10, 0, 3, 0]),
    ("sequences/00/labels/000001.label", &[40, 0, 0, 0, 252, 0, 1, 0]),
];

/// The sequence with other bytes in the file that the first byte tells; whether all of it was read.
pub(crate) fn sequence(bytes: &[u8]) -> bool {
    let Some((&place, bytes)) = bytes.split_first() else { return false };
    let mut files = FILES;
    files[usize::from(place) % FILES.len()].1 = bytes;
    in_folder(&files, |root| {
        let Ok(log) = SemanticKittiLog::open(root, read_options()) else { return false };
        log.load("00").is_ok_and(|scene| {
            let read = scene.sweeps.iter().filter(|sweep| log.read_sweep(sweep).is_ok()).count();
            scene.refused.is_empty() && read == 2
        })
    })
}

/// Every file, behind its number.
pub(crate) fn files() -> Vec<Vec<u8>> {
    (0..).zip(FILES).map(|(place, (_, bytes))| [&[place], bytes].concat()).collect()
}
