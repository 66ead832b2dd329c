//! An MCAP file, chunk by chunk.
//!
//! The file is stepped through from record to record without reading what they hold: a chunk is
//! decompressed only if its message index says that it has what is wanted, one at a time. The
//! summary is not believed: it repeats what the records say. Source: mcap.dev, "Format
//! Specification".

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use mcap::records::{Record, op};
use occlabel_core::Fault;

use super::chunk;
use super::contents::{Block, Channel, Contents};
use super::record_file::RecordFile;

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
    file: RecordFile,
}

impl Container {
    /// Opens a file below the root; a longer record or chunk is refused.
    ///
    /// # Errors
    /// If it cannot be read, or does not begin as MCAP does.
    pub(super) fn open(root: &Path, name: &str, max_record_bytes: u64) -> Result<Self, Fault> {
        Ok(Self { file: RecordFile::open(root, name, max_record_bytes)? })
    }

    /// Steps through the file. With what stands before it comes what is wrong with its end.
    pub(super) fn contents(&mut self) -> (Contents, Option<Fault>) {
        let mut contents = Contents::default();
        let fault = self.step_through(&mut contents).err();
        if let Some(last) = contents.blocks.last_mut().filter(|_| fault.is_some()) {
            // Its index may be cut off.
            last.channels.clear();
        }
        let broken = match contents.is_indexed() {
            true => None,
            false => self.define(&mut contents),
        };
        (contents, fault.map(recoverable).or(broken))
    }

    /// Looks for channels in all chunks, and tells what is wrong with the first that is broken.
    fn define(&mut self, contents: &mut Contents) -> Option<Fault> {
        let mut fault = None;
        for start in contents.blocks.iter().map(|block| block.start).collect::<Vec<_>>() {
            if let Err(broken) = self.each_record(start, |_, record| contents.add(record)) {
                fault.get_or_insert(broken);
            }
        }
        fault
    }

    fn step_through(&mut self, contents: &mut Contents) -> Result<(), Fault> {
        let mut at = mcap::MAGIC.len() as u64;
        loop {
            let span = self.file.span(at)?;
            match span.kind {
                op::CHUNK => contents.blocks.push(Block { start: at, channels: BTreeSet::new() }),
                op::MESSAGE => {
                    let channels = BTreeSet::from([self.file.channel_number(span)?]);
                    contents.blocks.push(Block { start: at, channels });
                }
                op::MESSAGE_INDEX => {
                    let channel = self.file.channel_number(span)?;
                    contents.blocks.last_mut().map(|block| block.channels.insert(channel));
                }
                op::SCHEMA | op::CHANNEL | op::METADATA => {
                    let body = self.file.body(span)?;
                    contents.add(self.file.parse(span, &body)?);
                }
                _ => {}
            }
            at = span.end();
            if span.kind == op::FOOTER {
                return self.file.check_magic(at, "the end of an MCAP file");
            }
        }
    }

    /// Hands on, in the file's order, every message of the wanted channels.
    ///
    /// # Errors
    /// If a block is broken, of which nothing is handed on, or `each` fails.
    pub(super) fn visit(
        &mut self,
        contents: &Contents,
        wanted: impl Fn(&Channel) -> bool,
        mut each: impl FnMut(Message) -> Result<(), Fault>,
    ) -> Result<(), Fault> {
        for block in contents.blocks.iter().filter(|block| block.may_hold(contents, &wanted)) {
            for message in self.messages(contents, block.start, &wanted)? {
                each(message)?;
            }
        }
        Ok(())
    }

    /// Offers the messages of each wanted topic, in the file's order, until one is taken.
    ///
    /// # Errors
    /// What is wrong with the block that ended the search.
    pub(super) fn first_of_each(
        &mut self,
        contents: &Contents,
        wanted: impl Fn(&Channel) -> bool,
        mut takes: impl FnMut(&Message) -> bool,
    ) -> Result<(), Fault> {
        let mut left: BTreeSet<&str> =
            contents.channels.values().filter(|c| wanted(c)).map(|c| c.topic.as_str()).collect();
        for block in &contents.blocks {
            let is_new = |c: &Channel| wanted(c) && left.contains(c.topic.as_str());
            if left.is_empty() || !block.may_hold(contents, is_new) {
                continue;
            }
            for message in self.messages(contents, block.start, &wanted)? {
                let topic = message.channel.topic.as_str();
                if left.contains(topic) && takes(&message) {
                    left.remove(topic);
                }
            }
        }
        Ok(())
    }

    /// The message at a place.
    ///
    /// # Errors
    /// If its block is broken, or holds no such message.
    pub(super) fn message(&mut self, contents: &Contents, at: MessageAt) -> Result<Message, Fault> {
        let messages = self.messages(contents, at.block, |_| true)?;
        let found = messages.into_iter().find(|message| message.at == at);
        found.ok_or_else(|| {
            self.file.fault(at.block, "mcap-message", "the message that was here", "none")
        })
    }

    fn messages(
        &mut self,
        contents: &Contents,
        start: u64,
        wanted: impl Fn(&Channel) -> bool,
    ) -> Result<Vec<Message>, Fault> {
        let (mut messages, mut unknown) = (Vec::new(), None);
        self.each_record(start, |place, record| {
            let Record::Message { header, data } = record else { return };
            match contents.channels.get(&header.channel_id) {
                None => unknown = Some(header.channel_id),
                Some(channel) if wanted(channel) => messages.push(Message {
                    channel: channel.clone(),
                    log_time_ns: header.log_time,
                    data: data.into_owned(),
                    at: MessageAt { block: start, place },
                }),
                Some(_) => {}
            }
        })?;
        let Some(number) = unknown else { return Ok(messages) };
        let (expected, found) =
            ("a channel before its messages", format!("a message of channel {number}"));
        Err(self.file.fault(start, "mcap-channel", expected, found))
    }

    /// Hands on the records of a chunk, or the message itself: all of them or none.
    fn each_record(
        &mut self,
        start: u64,
        mut each: impl FnMut(usize, Record<'_>),
    ) -> Result<(), Fault> {
        let span = self.file.span(start)?;
        let body = self.file.body(span)?;
        let (header, packed) = match self.file.parse(span, &body)? {
            Record::Chunk { header, data } => (header, data),
            record => {
                each(0, record);
                return Ok(());
            }
        };
        self.file.check_length(start, header.uncompressed_size)?;
        let broken =
            |found| recoverable(self.file.fault(start, "mcap-chunk", "a sound chunk", found));
        let bytes = chunk::unpack(&header, &packed).map_err(broken)?;
        chunk::records(&bytes).try_for_each(|record| record.map(drop)).map_err(broken)?;
        let sound = chunk::records(&bytes).flatten().enumerate();
        sound.for_each(|(place, record)| each(place, record));
        Ok(())
    }
}

/// What could be done about a broken file.
pub(super) const RECOVER_HINT: &str = "`--recover` reads what stands before it";

/// The fault of a file that is broken, but not all through.
fn recoverable(fault: Fault) -> Fault {
    match fault.hint {
        None => fault.hint(RECOVER_HINT),
        Some(_) => fault,
    }
}
