//! Files of the MCAP conformance suite, and broken ones.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions};
use serde_json::Value;

use super::container::{Container, Message};
use super::contents::Contents;

/// No record here is longer, bytes.
const CAP: u64 = 1 << 20;

/// What the suite says a record holds, by names.
fn fields(record: &Value) -> BTreeMap<&str, &Value> {
    let pairs = record["fields"].as_array().unwrap();
    pairs.iter().map(|pair| (pair[0].as_str().unwrap(), &pair[1])).collect()
}

fn records<'a>(expected: &'a Value, kind: &str) -> Vec<BTreeMap<&'a str, &'a Value>> {
    let all = expected["records"].as_array().unwrap().iter();
    all.filter(|record| record["type"] == kind).map(fields).collect()
}

fn bytes(value: &Value) -> Vec<u8> {
    value.as_array().unwrap().iter().map(|byte| byte.as_str().unwrap().parse().unwrap()).collect()
}

fn read(path: &Path) -> (Contents, Vec<Message>) {
    let name = path.file_name().unwrap().to_str().unwrap();
    let mut container = Container::open(path.parent().unwrap(), name, CAP).unwrap();
    let (contents, fault) = container.contents();
    assert_eq!(fault, None, "{name}");
    let mut messages = Vec::new();
    let each = |message| {
        messages.push(message);
        Ok(())
    };
    container.visit(&contents, |_| true, each).unwrap_or_else(|fault| panic!("{fault}"));
    (contents, messages)
}

fn check(path: &Path) {
    let text = std::fs::read_to_string(path.with_extension("json")).unwrap();
    let expected: Value = serde_json::from_str(&text).unwrap();
    let (contents, messages) = read(path);
    let schemas = records(&expected, "Schema");
    let told = records(&expected, "Message");
    assert_eq!(messages.len(), told.len(), "{}", path.display());
    for (message, told) in messages.iter().zip(told) {
        assert_eq!(message.data, bytes(told["data"]));
        assert_eq!(told["log_time"].as_str().unwrap(), message.log_time_ns.to_string());
        let channels = records(&expected, "Channel");
        let channel = channels.iter().find(|channel| channel["id"] == told["channel_id"]).unwrap();
        assert_eq!(channel["topic"], &Value::from(message.channel.topic.clone()));
        assert_eq!(channel["message_encoding"], &Value::from(message.channel.encoding.clone()));
        let schema = schemas.iter().find(|schema| schema["id"] == channel["schema_id"]);
        let name = schema.map_or("", |schema| schema["name"].as_str().unwrap());
        let data = schema.map_or(Vec::new(), |schema| bytes(schema["data"]));
        assert_eq!(
            (message.channel.schema.name.as_str(), &message.channel.schema.data),
            (name, &data)
        );
    }
    let told = records(&expected, "Metadata");
    assert_eq!(contents.metadata.len(), told.len());
    for (metadata, told) in contents.metadata.iter().zip(told) {
        assert_eq!(told["name"], &Value::from(metadata.name.clone()));
        assert_eq!(told["metadata"], &serde_json::to_value(&metadata.metadata).unwrap());
    }
}

/// The suite's folder; `None`, with a word, if it is not there.
fn suite() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let data = std::env::var_os("OCCLABEL_DATA").map_or(beside, PathBuf::from);
    let suite = data.join("mcap-conformance");
    if !suite.is_dir() {
        eprintln!("skipped: no mcap-conformance in OCCLABEL_DATA or ../shared/data");
        return None;
    }
    Some(suite)
}

#[test]
fn the_conformance_suite_reads_right() {
    let Some(suite) = suite() else { return };
    let mut checked = 0;
    for folder in std::fs::read_dir(suite).unwrap().map(|entry| entry.unwrap().path()) {
        for entry in std::fs::read_dir(&folder).into_iter().flatten() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|ending| ending == "mcap") {
                check(&path);
                checked += 1;
            }
        }
    }
    assert_eq!(checked, 416);
}

/// A file of 40 messages of 100 bytes in chunks of 10, and one in no chunk's index.
fn written(compression: Option<Compression>) -> Vec<u8> {
    let mut file = std::io::Cursor::new(Vec::new());
    let options = WriteOptions::new().compression(compression).chunk_size(Some(1000));
    let mut writer = options.create(&mut file).unwrap();
    let schema = writer.add_schema("foxglove.PointCloud", "protobuf", b"").unwrap();
    let channel = writer.add_channel(schema, "/a", "protobuf", &BTreeMap::new()).unwrap();
    for number in 0..40_u8 {
        let time = u64::from(number);
        let header =
            MessageHeader { channel_id: channel, sequence: 0, log_time: time, publish_time: time };
        writer.write_to_known_channel(&header, &[number; 100]).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    file.into_inner()
}

fn saved(bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    std::fs::write(&path, bytes).unwrap();
    (folder, path)
}

#[test]
fn chunks_are_read_whatever_their_compression() {
    for compression in [None, Some(Compression::Lz4), Some(Compression::Zstd)] {
        let (_folder, path) = saved(&written(compression));
        let (contents, messages) = read(&path);
        assert!(contents.blocks.len() >= 4 && messages.len() == 40);
        let mut container = Container::open(path.parent().unwrap(), "a.mcap", CAP).unwrap();
        for message in messages.iter().step_by(7) {
            assert_eq!(container.message(&contents, message.at).unwrap().data, message.data);
        }
    }
}

/// How many messages come before the first fault, and the faults.
fn salvage(bytes: &[u8]) -> (usize, Vec<String>) {
    let (_folder, path) = saved(bytes);
    let mut container = match Container::open(path.parent().unwrap(), "a.mcap", CAP) {
        Ok(container) => container,
        Err(fault) => return (0, vec![fault.to_string()]),
    };
    let (contents, cut) = container.contents();
    let mut messages = 0;
    let each = |_| {
        messages += 1;
        Ok(())
    };
    let broken = container.visit(&contents, |_| true, each).err();
    (messages, cut.into_iter().chain(broken).map(|fault| fault.to_string()).collect())
}

#[test]
fn fault_33_a_file_cut_off_anywhere_says_so_and_gives_its_whole_chunks() {
    let whole = written(Some(Compression::Zstd));
    let (mut cuts, mut partial) = (0, 0);
    for length in 0..whole.len() {
        let (messages, faults) = salvage(&whole[..length]);
        assert!(!faults.is_empty(), "cut at {length}");
        assert!(faults.iter().all(|fault| fault.contains("at byte")), "{faults:?}");
        cuts += 1;
        partial += usize::from((1..40).contains(&messages));
    }
    assert!(cuts > 500 && partial > 100, "{cuts} {partial}");
}

#[test]
fn fault_33_a_flipped_bit_in_a_chunk_is_found_by_its_checksum() {
    let whole = written(None);
    let payload = whole.windows(100).position(|bytes| bytes == [25; 100]).unwrap();
    let mut broken = whole.clone();
    broken[payload + 50] ^= 4;
    let (messages, faults) = salvage(&broken);
    assert!(messages < 40 && faults.len() == 1, "{messages} {faults:?}");
    assert!(faults[0].contains("a sound chunk"), "{faults:?}");
}

#[test]
fn fault_34_no_mutation_panics_or_takes_its_declared_size() {
    let whole = written(Some(Compression::Lz4));
    let mut tried = 0;
    for at in (0..whole.len()).step_by(3) {
        for value in [0, 0x7f, 0xff] {
            let mut broken = whole.clone();
            broken[at..(at + 4).min(whole.len())].fill(value);
            salvage(&broken);
            tried += 1;
        }
    }
    assert!(tried > 500, "{tried}");
}

#[test]
fn fault_34_a_chunk_that_declares_too_much_is_refused() {
    let mut file = written(Some(Compression::Zstd));
    let (_folder, path) = saved(&file);
    let start = read(&path).0.blocks[0].start as usize;
    file[start + 25..start + 33].copy_from_slice(&(1_u64 << 40).to_le_bytes());
    let (messages, faults) = salvage(&file);
    assert_eq!(messages, 0);
    assert!(faults[0].contains("at most 1048576 bytes"), "{faults:?}");
}
