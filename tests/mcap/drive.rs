//! A drive that is simulated, labelled, and may be bent.

use std::collections::BTreeMap;
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use mcap::read::LinearReader;
use mcap::records::{MessageHeader, Record};
use mcap::{Compression, MessageStream, WriteOptions};
use tempfile::TempDir;

use crate::support::{Ended, SMALL, occlabel, text};

/// A street with a car that drives by, seen by a lidar and a camera.
const WORLD: &str = include_str!("../fixtures/mcap_world.toml");

/// A simulated drive, and room beside it.
pub(crate) struct Drive(TempDir);

impl Drive {
    pub(crate) fn new() -> Self {
        let drive = Self(tempfile::tempdir().expect("a folder"));
        fs::write(drive.path("street.toml"), WORLD).expect("a world");
        drive
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn simulate(&self, format: &str) -> PathBuf {
        let (log, world) = (self.path(format), self.path("street.toml"));
        let line =
            ["simulate", "--world", text(&world), "--format", format, "--output", text(&log)];
        occlabel(&[&line[..], &["--images", "none"]].concat()).exits(0);
        log
    }

    /// Labels a log of a format into a folder.
    pub(crate) fn label(&self, format: &str, log: &Path, output: &str, args: &[&str]) -> Ended {
        let output = self.path(output);
        let line = ["label", "--format", format, "--input", text(log), "--output", text(&output)];
        occlabel(&[&line[..], &SMALL, &["--evidence"], args].concat())
    }
}

/// The drive's only file, written anew: log times `late_ns` later, chunks of about so many bytes.
pub(crate) fn rewrite(
    log: &Path,
    late_ns: u64,
    chunk_bytes: u64,
    compression: Option<Compression>,
) -> PathBuf {
    let file = log.join("street.mcap");
    let bytes = fs::read(&file).expect("a log");
    let mut written = Cursor::new(Vec::new());
    let options = WriteOptions::new().chunk_size(Some(chunk_bytes)).compression(compression);
    let mut writer = options.create(&mut written).expect("a writer");
    for record in LinearReader::new(&bytes).expect("a log") {
        if let Record::Metadata(metadata) = record.expect("a record") {
            writer.write_metadata(&metadata).expect("written");
        }
    }
    for message in MessageStream::new(&bytes).expect("a log") {
        let mcap::Message { channel, data, log_time, .. } = message.expect("a message");
        let schema = channel.schema.as_ref().expect("a schema");
        let schema = writer.add_schema(&schema.name, &schema.encoding, &schema.data);
        let (topic, encoding) = (&channel.topic, &channel.message_encoding);
        let channel_id =
            writer.add_channel(schema.expect("added"), topic, encoding, &BTreeMap::new());
        let (channel_id, time) = (channel_id.expect("added"), log_time + late_ns);
        let header = MessageHeader { channel_id, sequence: 0, log_time: time, publish_time: time };
        writer.write_to_known_channel(&header, &data).expect("written");
    }
    writer.finish().expect("finished");
    drop(writer);
    fs::write(&file, written.into_inner()).expect("written");
    file
}
