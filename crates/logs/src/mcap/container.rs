//! An MCAP file, record by record.
//!
//! The file is stepped through from record to record without reading what they hold: a chunk is
//! decompressed only if its message index says that it has what is wanted, one at a time. The
//! summary is not believed: it repeats what the records say. Source: mcap.dev, "Format
//! Specification".

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::Arc;

use mcap::McapResult;
use mcap::records::{self, Metadata, Record, SchemaHeader, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use occlabel_core::Fault;

use crate::files::{open_file, unreadable};

/// A record or a decompressed chunk longer than this is refused.
const MAX_RECORD_BYTES: u64 = 1 << 30;
/// Kind and length.
const FRAMING_BYTES: u64 = 9;

/// What a file holds, besides its messages.
#[derive(Debug, Default)]
pub(super) struct Contents {
    /// By number.
    pub(super) channels: BTreeMap<u16, Arc<Channel>>,
    pub(super) metadata: Vec<Metadata>,
    /// In the file's order.
    pub(super) blocks: Vec<Block>,
    schemas: BTreeMap<u16, Schema>,
}

/// Messages of one topic and schema.
#[derive(Debug)]
pub(super) struct Channel {
    pub(super) topic: String,
    pub(super) encoding: String,
    pub(super) schema: Schema,
}

/// How messages are laid out.
#[derive(Clone, Debug, Default)]
pub(super) struct Schema {
    pub(super) name: String,
    pub(super) data: Vec<u8>,
}

/// A chunk, or a message that stands in none.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// The record's first byte.
    pub(super) start: u64,
    /// The channels that its index names; none if it has no index.
    pub(super) channels: BTreeSet<u16>,
}

/// A message, and where it stands.
#[derive(Debug)]
pub(super) struct Message {
    pub(super) channel: Arc<Channel>,
    pub(super) log_time_ns: u64,
    pub(super) data: Vec<u8>,
    pub(super) at: MessageAt,
}

/// Where a message stands: its block's first byte, and its place among the block's records.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct MessageAt {
    pub(super) block: u64,
    pub(super) place: usize,
}

/// An open file.
#[derive(Debug)]
pub(super) struct Container {
    file: BufReader<File>,
    name: String,
    end: u64,
}

impl Container {
    /// Opens a file below the root.
    ///
    /// # Errors
    /// If it cannot be read, or does not begin as MCAP does.
    pub(super) fn open(root: &Path, name: &str) -> Result<Self, Fault> {
        let file = open_file(&root.join(name), name)?;
        let end = file.metadata().map_err(|error| unreadable(name, &error))?.len();
        let mut container = Self { file: BufReader::new(file), name: name.to_owned(), end };
        container.check_magic(0, "an MCAP file")?;
        Ok(container)
    }

    /// Steps through the file. With what stands before it comes what is wrong with its end.
    pub(super) fn contents(&mut self) -> (Contents, Option<Fault>) {
        let mut contents = Contents::default();
        let fault = self.step_through(&mut contents).err();
        let is_known = |number: &u16| contents.channels.contains_key(number);
        let is_told =
            |block: &Block| !block.channels.is_empty() && block.channels.iter().all(&is_known);
        if !contents.blocks.iter().all(is_told) {
            self.define(&mut contents);
        }
        (contents, fault)
    }

    /// Looks for channels in all chunks; one that is broken will be told of when it is read.
    fn define(&mut self, contents: &mut Contents) {
        for start in contents.blocks.iter().map(|block| block.start).collect::<Vec<_>>() {
            let records = self.records(start).unwrap_or_default();
            records.into_iter().for_each(|record| contents.add(record));
        }
    }

    fn step_through(&mut self, contents: &mut Contents) -> Result<(), Fault> {
        let mut at = mcap::MAGIC.len() as u64;
        loop {
            let (kind, length) = self.framing(at)?;
            match kind {
                op::CHUNK => contents.blocks.push(Block { start: at, channels: BTreeSet::new() }),
                op::MESSAGE => {
                    let channels = BTreeSet::from([self.channel_number(at, length)?]);
                    contents.blocks.push(Block { start: at, channels });
                }
                op::MESSAGE_INDEX => {
                    let channel = self.channel_number(at, length)?;
                    contents.blocks.last_mut().map(|block| block.channels.insert(channel));
                }
                op::SCHEMA | op::CHANNEL | op::METADATA => {
                    let body = self.body(at, length)?;
                    contents.add(self.parse(at, kind, &body)?);
                }
                _ => {}
            }
            at += FRAMING_BYTES + length;
            if kind == op::FOOTER {
                return self.check_magic(at, "the end of an MCAP file");
            }
        }
    }

    /// Hands on, in the file's order, every message of the wanted channels.
    ///
    /// # Errors
    /// If a block is broken, or `each` fails.
    pub(super) fn visit(
        &mut self,
        contents: &Contents,
        wanted: impl Fn(&Channel) -> bool,
        mut each: impl FnMut(Message) -> Result<(), Fault>,
    ) -> Result<(), Fault> {
        for block in &contents.blocks {
            let may_hold =
                |number| contents.channels.get(number).is_some_and(|channel| wanted(channel));
            if !block.channels.is_empty() && !block.channels.iter().any(may_hold) {
                continue;
            }
            for message in self.messages(contents, block.start, &wanted)? {
                each(message)?;
            }
        }
        Ok(())
    }

    /// The first message of each wanted channel.
    ///
    /// # Errors
    /// If a block on the way is broken.
    pub(super) fn first_of_each(
        &mut self,
        contents: &Contents,
        wanted: impl Fn(&Channel) -> bool,
    ) -> Result<Vec<Message>, Fault> {
        let is_wanted = |number: &u16| contents.channels.get(number).is_some_and(|c| wanted(c));
        let mut left: BTreeSet<&str> =
            contents.channels.values().filter(|c| wanted(c)).map(|c| c.topic.as_str()).collect();
        let mut first = Vec::new();
        for block in &contents.blocks {
            let has_new = |number: &u16| {
                is_wanted(number) && left.contains(contents.channels[number].topic.as_str())
            };
            if block.channels.is_empty() || block.channels.iter().any(has_new) {
                let messages = self.messages(contents, block.start, &wanted)?;
                first
                    .extend(messages.into_iter().filter(|m| left.remove(m.channel.topic.as_str())));
            }
        }
        Ok(first)
    }

    /// The message at a place.
    ///
    /// # Errors
    /// If its block is broken, or holds no such message.
    pub(super) fn message(&mut self, contents: &Contents, at: MessageAt) -> Result<Message, Fault> {
        let messages = self.messages(contents, at.block, |_| true)?;
        let found = messages.into_iter().find(|message| message.at == at);
        found.ok_or_else(|| {
            self.fault(at.block, "mcap-message", "the message that was here", "none")
        })
    }

    fn messages(
        &mut self,
        contents: &Contents,
        start: u64,
        wanted: impl Fn(&Channel) -> bool,
    ) -> Result<Vec<Message>, Fault> {
        let mut messages = Vec::new();
        for (place, record) in self.records(start)?.into_iter().enumerate() {
            let Record::Message { header, data } = record else { continue };
            let Some(channel) = contents.channels.get(&header.channel_id) else {
                let found = format!("a message of channel {}", header.channel_id);
                return Err(self.fault(
                    start,
                    "mcap-channel",
                    "a channel before its messages",
                    found,
                ));
            };
            if wanted(channel) {
                messages.push(Message {
                    channel: channel.clone(),
                    log_time_ns: header.log_time,
                    data: data.into_owned(),
                    at: MessageAt { block: start, place },
                });
            }
        }
        Ok(messages)
    }

    /// The records of a chunk, or the message itself.
    fn records(&mut self, start: u64) -> Result<Vec<Record<'static>>, Fault> {
        let (kind, length) = self.framing(start)?;
        let body = self.body(start, length)?;
        let Record::Chunk { header, data } = self.parse(start, kind, &body)? else {
            return Ok(vec![self.parse(start, kind, &body)?.into_owned()]);
        };
        if header.uncompressed_size > MAX_RECORD_BYTES {
            return Err(self.too_long(start, header.uncompressed_size));
        }
        let whole = 40 + header.compression.len() + data.len();
        let records = chunk_records(&body[..whole], header.uncompressed_size as usize);
        records.map_err(|error| self.fault(start, "mcap-chunk", "a sound chunk", error.to_string()))
    }

    /// Kind and length of the record at a byte.
    fn framing(&mut self, at: u64) -> Result<(u8, u64), Fault> {
        let left = self.end.saturating_sub(at);
        let [kind, length @ ..] = self.take::<9>(at)?;
        let length = u64::from_le_bytes(length);
        if length > left - FRAMING_BYTES {
            return Err(self.cut_off(at));
        }
        Ok((kind, length))
    }

    fn channel_number(&mut self, at: u64, length: u64) -> Result<u16, Fault> {
        match length {
            0..2 => Err(self.fault(at, "mcap-record", "the number of a channel", "none")),
            _ => Ok(u16::from_le_bytes(self.take(at + FRAMING_BYTES)?)),
        }
    }

    fn body(&mut self, at: u64, length: u64) -> Result<Vec<u8>, Fault> {
        if length > MAX_RECORD_BYTES {
            return Err(self.too_long(at, length));
        }
        self.seek(at + FRAMING_BYTES)?;
        let mut body = vec![0; length as usize];
        self.file.read_exact(&mut body).map_err(|error| unreadable(&self.name, &error))?;
        Ok(body)
    }

    fn take<const N: usize>(&mut self, at: u64) -> Result<[u8; N], Fault> {
        if self.end.saturating_sub(at) < N as u64 {
            return Err(self.cut_off(at));
        }
        self.seek(at)?;
        let mut bytes = [0; N];
        self.file.read_exact(&mut bytes).map_err(|error| unreadable(&self.name, &error))?;
        Ok(bytes)
    }

    fn seek(&mut self, at: u64) -> Result<(), Fault> {
        let here = self.file.stream_position().map_err(|error| unreadable(&self.name, &error))?;
        let near = i64::try_from(at).ok().zip(i64::try_from(here).ok()).map(|(at, here)| at - here);
        let sought = match near {
            Some(step) => self.file.seek_relative(step),
            None => self.file.seek(SeekFrom::Start(at)).map(drop),
        };
        sought.map_err(|error| unreadable(&self.name, &error))
    }

    fn parse<'a>(&self, at: u64, kind: u8, body: &'a [u8]) -> Result<Record<'a>, Fault> {
        mcap::parse_record(kind, body).map_err(|error| {
            self.fault(at, "mcap-record", "a record as specified", error.to_string())
        })
    }

    fn check_magic(&mut self, at: u64, expected: &str) -> Result<(), Fault> {
        match self.take::<8>(at) {
            Ok(magic) if magic == mcap::MAGIC => Ok(()),
            Ok(_) => Err(self.fault(at, "mcap-magic", expected, "other bytes")),
            Err(_) => Err(self.fault(at, "mcap-magic", expected, "the end of the file")),
        }
    }

    fn cut_off(&self, at: u64) -> Fault {
        let fault =
            self.fault(at, "mcap-cut-off", "whole records up to a footer", "the end of the file");
        fault.hint("`--recover` reads what stands before it")
    }

    fn too_long(&self, at: u64, bytes: u64) -> Fault {
        let expected = format!("at most {MAX_RECORD_BYTES} bytes in a record or chunk");
        self.fault(at, "mcap-length", expected, format!("{bytes}"))
    }

    fn fault(
        &self,
        at: u64,
        rule: &'static str,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> Fault {
        Fault::new(rule, &self.name, expected, found).offset(at)
    }
}

/// The records of a chunk whose body this is, without what fills it up; its checksum is verified.
/// No record in it is believed to be longer than the chunk.
fn chunk_records(body: &[u8], uncompressed_bytes: usize) -> McapResult<Vec<Record<'static>>> {
    const ROOM_FOR_BLOCKS: usize = 1 << 18;
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_validate_chunk_crcs(true)
        .with_record_length_limit(uncompressed_bytes.max(ROOM_FOR_BLOCKS));
    let mut reader = LinearReader::new_with_options(options);
    let framing = [&[op::CHUNK][..], &(body.len() as u64).to_le_bytes()].concat();
    let mut source = framing.as_slice().chain(body);
    let mut records = Vec::new();
    while let Some(event) = reader.next_event() {
        match event? {
            LinearReadEvent::ReadRequest(need) => {
                let read = source.read(reader.insert(need))?;
                reader.notify_read(read);
            }
            LinearReadEvent::Record { data, opcode } => {
                records.push(mcap::parse_record(opcode, data)?.into_owned());
            }
        }
    }
    Ok(records)
}

impl Contents {
    /// Takes note of a schema, channel or metadata record; of several of one number the first counts.
    fn add(&mut self, record: Record<'_>) {
        match record {
            Record::Schema { header: SchemaHeader { id, name, .. }, data } => {
                let schema = || Schema { name, data: data.into_owned() };
                self.schemas.entry(id).or_insert_with(schema);
            }
            Record::Channel(channel) => self.add_channel(channel),
            Record::Metadata(metadata) => self.metadata.push(metadata),
            _ => {}
        }
    }

    /// A summary may repeat channels without their schemas: such a channel waits for its own record.
    fn add_channel(&mut self, channel: records::Channel) {
        let records::Channel { id, schema_id, topic, message_encoding: encoding, .. } = channel;
        let schema = match schema_id {
            0 => Schema::default(),
            _ => match self.schemas.get(&schema_id) {
                Some(schema) => schema.clone(),
                None => return,
            },
        };
        let channel = || Arc::new(Channel { topic, encoding, schema });
        self.channels.entry(id).or_insert_with(channel);
    }
}
