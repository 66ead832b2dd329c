//! MCAP logs with faults, and how the program ends on them.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use mcap::Compression;
use serde_json::{Value, json};

use crate::drive::{Drive, rewrite};
use crate::support::{
    Ended, SMALL, TestLog, files_under, gts_files, manifest, occlabel, occlabel_within, report,
    text,
};

/// What is too large is refused at once; this leaves room for a slow machine.
const SOON: Duration = Duration::from_secs(5);
/// All the address space that the program may take: less than what is declared.
const MEMORY_KIB: u32 = 1_000_000;
const SMALL_CHUNK: u64 = 20_000;

fn keyframes(output: &Path) -> Value {
    manifest(output)["scenes"]["street"]["keyframes"].clone()
}

fn listed(output: &Path, list: &str, rule: &str) -> usize {
    let report = report(output);
    let list = report[list].as_array().expect("a list").clone();
    list.iter().filter(|fault| fault["rule"] == rule).count()
}

#[track_caller]
fn assert_nothing_written(output: &Path) {
    let files = files_under(output);
    assert!(!files.keys().any(|name| name.starts_with("gts/") || name.starts_with("manifest")));
}

#[test]
fn fault_17_the_header_s_time_counts_unless_the_log_s_is_asked_for() {
    let drive = Drive::new();
    let log = drive.simulate("mcap");
    rewrite(&log, 2_000_000_000, 1 << 20, None);
    drive.label("mcap", &log, "header", &[]).exits(0).tells(&["2.000 s", "`--time-source log`"]);
    assert_eq!(listed(&drive.path("header"), "warnings", "mcap-clock"), 1);
    // The drive begins at 0, which is no time: there the log's stands in.
    let kept = json!(["500000000", "1000000000", "2000000000"]);
    assert_eq!(keyframes(&drive.path("header")), kept);
    let ended = drive.label("mcap", &log, "log", &["--time-source", "log"]).exits(0);
    ended.tells_nothing_of("--time-source");
    let later = json!(["2000000000", "2500000000", "3000000000"]);
    assert_eq!(keyframes(&drive.path("log")), later);
}

/// Asserts that a broken log is refused with its byte, and that with `--recover` so many keyframes are
/// left, the loss in the report.
#[track_caller]
fn assert_recovered(drive: &Drive, log: &Path, rule: &str, left: std::ops::Range<usize>) {
    let ended = drive.label("mcap", log, "strict", &[]).exits(1);
    ended.tells(&["street.mcap (at byte ", "expected", "found", "`--recover`"]);
    assert_nothing_written(&drive.path("strict"));
    drive.label("mcap", log, "recovered", &["--recover"]).exits(3);
    let output = drive.path("recovered");
    let line = ["check", "--format", "mcap", "--input", text(log), "--recover"];
    let told = occlabel(&line).exits(3).stdout;
    assert!(told.contains(&format!("warning [{rule}]")) && !told.contains("`--recover`"), "{told}");
    assert_eq!(listed(&output, "skipped_or_degraded", rule), 1, "{}", report(&output));
    let found = gts_files(&output).len() / 2;
    assert!(left.contains(&found), "{found} keyframes");
}

#[test]
fn fault_33_a_truncated_log_is_refused_or_read_to_its_last_whole_chunk() {
    let drive = Drive::new();
    let log = drive.simulate("mcap");
    let file = rewrite(&log, 0, SMALL_CHUNK, Some(Compression::Zstd));
    let whole = fs::read(&file).expect("a log");
    fs::write(&file, &whole[..whole.len() * 3 / 5]).expect("written");
    assert_recovered(&drive, &log, "mcap-cut-off", 1..3);
}

#[test]
fn fault_33_a_log_without_its_footer_is_refused_or_read_whole() {
    let drive = Drive::new();
    let log = drive.simulate("mcap");
    let file = rewrite(&log, 0, SMALL_CHUNK, Some(Compression::Lz4));
    let whole = fs::read(&file).expect("a log");
    fs::write(&file, &whole[..whole.len() - 40]).expect("written");
    assert_recovered(&drive, &log, "mcap-cut-off", 3..4);
}

#[test]
fn fault_33_a_chunk_with_another_checksum_is_refused_or_ends_the_log() {
    let drive = Drive::new();
    let log = drive.simulate("mcap");
    let file = rewrite(&log, 0, SMALL_CHUNK, None);
    let mut bytes = fs::read(&file).expect("a log");
    let middle = bytes.len() * 3 / 5;
    bytes[middle] ^= 1;
    fs::write(&file, bytes).expect("written");
    assert_recovered(&drive, &log, "mcap-chunk", 1..3);
}

/// The first byte of the first chunk that says how long it is unpacked.
fn unpacked_size_at(bytes: &[u8]) -> usize {
    const CHUNK: u8 = 6;
    let mut at = 8;
    loop {
        let length = u64::from_le_bytes(bytes[at + 1..at + 9].try_into().expect("8 bytes"));
        if bytes[at] == CHUNK {
            return at + 9 + 16;
        }
        at += 9 + length as usize;
    }
}

/// Labels in less memory than what is declared, and asserts that it is refused soon.
#[track_caller]
fn refused_soon(format: &str, log: &Path, output: &Path, args: &[&str]) -> Ended {
    let begun = Instant::now();
    let line = ["label", "--format", format, "--input", text(log), "--output", text(output)];
    let ended = occlabel_within(MEMORY_KIB, &[&line[..], &SMALL, args].concat()).exits(1);
    assert!(begun.elapsed() < SOON, "{:?}", begun.elapsed());
    ended
}

#[test]
fn fault_34_a_chunk_that_declares_too_much_is_refused_at_once() {
    for compression in [None, Some(Compression::Zstd), Some(Compression::Lz4)] {
        let drive = Drive::new();
        let log = drive.simulate("mcap");
        let file = rewrite(&log, 0, SMALL_CHUNK, compression);
        let mut bytes = fs::read(&file).expect("a log");
        let at = unpacked_size_at(&bytes);
        bytes[at..at + 8].copy_from_slice(&(1_u64 << 40).to_le_bytes());
        fs::write(&file, &bytes).expect("written");
        let ended = refused_soon("mcap", &log, &drive.path("a"), &[]);
        ended.tells(&["at byte", "at most 1073741824 bytes", "found 1099511627776"]);
        bytes[at..at + 8].copy_from_slice(&(1_u64 << 30).to_le_bytes());
        fs::write(&file, &bytes).expect("written");
        let ended = refused_soon("mcap", &log, &drive.path("a"), &[]);
        ended.tells(&["at byte", "fewer than the 1073741824 bytes"]);
        assert_nothing_written(&drive.path("a"));
    }
}

#[test]
fn fault_34_the_cap_is_a_key() {
    let drive = Drive::new();
    let log = drive.simulate("mcap");
    let small = ["--set", "reader.mcap.max_record_bytes=1000"];
    let ended = refused_soon("mcap", &log, &drive.path("a"), &small);
    ended.tells(&["at most 1000 bytes", "`reader.mcap.max_record_bytes`"]);
    let zero = ["--set", "reader.mcap.max_record_bytes=0"];
    drive.label("mcap", &log, "a", &zero).exits(2).tells(&["reader.mcap.max_record_bytes"]);
}

#[test]
fn fault_34_a_body_mask_that_declares_too_much_is_refused_at_once() {
    /// 60000 x 60000 grey pixels, of which there are none.
    const HEAD: &[u8] =
        b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\xea\x60\0\0\xea\x60\x08\0\0\0\0\xa5\xb9\x2a\x9e";
    let log = TestLog::nano();
    log.edit("calibrated_sensor", |rows| {
        rows.iter_mut().for_each(|row| row["mask"] = json!("mask.png"));
    });
    fs::write(log.file("mask.png"), HEAD).expect("written");
    let ended = refused_soon("nuscenes", &log.root(), &log.beside("out"), &[]);
    ended.tells(&["mask.png", "expected a mask of"]);
    assert_nothing_written(&log.beside("out"));
}

#[test]
fn fault_34_a_tfrecord_that_declares_too_much_is_refused_at_once() {
    /// A length of 2^40 with its checksum.
    const HEAD: [u8; 12] = [0, 0, 0, 0, 0, 1, 0, 0, 0xaa, 0x3d, 0x6b, 0xe4];
    let drive = Drive::new();
    let log = drive.path("waymo");
    fs::create_dir(&log).expect("a folder");
    fs::write(log.join("a.tfrecord"), HEAD).expect("written");
    let ended = refused_soon("waymo", &log, &drive.path("a"), &[]);
    ended.tells(&["a.tfrecord", "at byte 0", "at most 1073741824", "found 1099511627776"]);
}
