//! An MCAP file that grows by messages.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::PathBuf;

use mcap::records::{MessageHeader, Metadata};
use mcap::{McapError, WriteOptions, Writer};
use occlabel_core::{Fault, Timestamp};

use crate::write::files::OutputFile;

use super::schemas::descriptor_set;
use crate::write::wire::Wire;

/// The writer, with a channel a topic.
pub(super) struct Recorder {
    path: PathBuf,
    writer: Writer<BufWriter<File>>,
    /// By topic: the channel, and the number of its next message.
    channels: BTreeMap<String, (u16, u32)>,
}

impl Recorder {
    pub(super) fn create(file: OutputFile) -> Result<Self, Fault> {
        let (path, file) = file.into_parts();
        let options = WriteOptions::new().compression(None).library("occlabel");
        let writer = options.create(file).map_err(|error| refused(&path, &error))?;
        Ok(Self { path, writer, channels: BTreeMap::new() })
    }

    /// Names the numbers of the point labels.
    pub(super) fn name_labels(&mut self, names: &[&str]) -> Result<(), Fault> {
        let numbered = names.iter().enumerate();
        let metadata = numbered.map(|(raw, name)| (raw.to_string(), name.to_string())).collect();
        let record = Metadata { name: "point_labels".into(), metadata };
        self.writer.write_metadata(&record).map_err(|error| refused(&self.path, &error))
    }

    /// Adds a message of a Foxglove schema.
    pub(super) fn write(
        &mut self,
        topic: &str,
        schema: &str,
        time: Timestamp,
        message: &Wire,
    ) -> Result<(), Fault> {
        self.try_write(topic, schema, time, message).map_err(|error| refused(&self.path, &error))
    }

    fn try_write(
        &mut self,
        topic: &str,
        schema: &str,
        time: Timestamp,
        message: &Wire,
    ) -> Result<(), McapError> {
        if !self.channels.contains_key(topic) {
            let name = format!("foxglove.{schema}");
            let schema = self.writer.add_schema(&name, "protobuf", descriptor_set().bytes())?;
            let channel = self.writer.add_channel(schema, topic, "protobuf", &BTreeMap::new())?;
            self.channels.insert(topic.to_owned(), (channel, 0));
        }
        let (channel_id, sequence) = self.channels[topic];
        self.channels.insert(topic.to_owned(), (channel_id, sequence + 1));
        let time = u64::try_from(time.0).unwrap_or_default();
        let header = MessageHeader { channel_id, sequence, log_time: time, publish_time: time };
        self.writer.write_to_known_channel(&header, message.bytes())
    }

    pub(super) fn finish(mut self) -> Result<(), Fault> {
        self.writer.finish().map_err(|error| refused(&self.path, &error))?;
        let flushed = self.writer.into_inner().flush();
        flushed.map_err(|error| refused(&self.path, &error.into()))
    }
}

fn refused(path: &std::path::Path, error: &McapError) -> Fault {
    Fault::new("write", path.display().to_string(), "to write here", error.to_string())
}
