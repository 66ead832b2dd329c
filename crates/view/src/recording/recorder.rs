//! An MCAP file that grows by messages.

use std::collections::BTreeMap;
use std::io::{ErrorKind, Seek, Write};

use foxglove::Encode;
use mcap::records::{MessageHeader, Metadata};
use mcap::{Compression, McapError, WriteOptions, Writer};
use occlabel_core::{Fault, Timestamp};

/// The writer, with a channel a topic.
pub(super) struct Recorder<W: Write + Seek> {
    place: String,
    writer: Writer<W>,
    /// By topic: the channel, and the number of its next message.
    channels: BTreeMap<String, (u16, u32)>,
    /// Of the last message.
    bytes: Vec<u8>,
}

impl<W: Write + Seek> Recorder<W> {
    /// Begins a file, which faults call `place`.
    pub(super) fn begin(to: W, place: &str) -> Result<Self, Fault> {
        // The library's name would be its version.
        let options = WriteOptions::new().compression(Some(Compression::Lz4)).library("occlabel");
        let writer = options.create(to).map_err(|error| refused(place, &error))?;
        Ok(Self { place: place.to_owned(), writer, channels: BTreeMap::new(), bytes: Vec::new() })
    }

    /// Adds texts by name.
    pub(super) fn metadata(
        &mut self,
        name: &str,
        texts: impl Iterator<Item = (String, String)>,
    ) -> Result<(), Fault> {
        let record = Metadata { name: name.to_owned(), metadata: texts.collect() };
        self.writer.write_metadata(&record).map_err(|error| refused(&self.place, &error))
    }

    /// Adds a message; all of a topic are of one schema.
    pub(super) fn write<M: Encode>(
        &mut self,
        topic: &str,
        time: Timestamp,
        message: &M,
    ) -> Result<(), Fault> {
        self.bytes.clear();
        message.encode(&mut self.bytes).expect("a vector takes any message");
        self.write_bytes::<M>(topic, time).map_err(|error| refused(&self.place, &error))
    }

    fn write_bytes<M: Encode>(&mut self, topic: &str, time: Timestamp) -> Result<(), McapError> {
        let (channel_id, sequence) = match self.channels.get(topic) {
            Some(&known) => known,
            None => (self.channel::<M>(topic)?, 0),
        };
        self.channels.insert(topic.to_owned(), (channel_id, sequence + 1));
        let time = u64::try_from(time.0).unwrap_or_default();
        let header = MessageHeader { channel_id, sequence, log_time: time, publish_time: time };
        self.writer.write_to_known_channel(&header, &self.bytes)
    }

    fn channel<M: Encode>(&mut self, topic: &str) -> Result<u16, McapError> {
        let schema = M::get_schema().expect("Foxglove's messages have schemas");
        let schema = self.writer.add_schema(&schema.name, &schema.encoding, &schema.data)?;
        self.writer.add_channel(schema, topic, &M::get_message_encoding(), &BTreeMap::new())
    }

    /// Ends the file.
    pub(super) fn finish(mut self) -> Result<(), Fault> {
        self.writer.finish().map_err(|error| refused(&self.place, &error))?;
        let flushed = self.writer.into_inner().flush();
        flushed.map_err(|error| refused(&self.place, &error.into()))
    }
}

fn refused(place: &str, error: &McapError) -> Fault {
    let fault = Fault::new("write", place, "to write here", error.to_string());
    match error {
        McapError::Io(error) if error.kind() == ErrorKind::StorageFull => {
            fault.hint("make room, then give the same command again")
        }
        _ => fault,
    }
}
