//! A file of records, each with its kind and length.

use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use mcap::records::Record;
use occlabel_core::Fault;
use occlabel_disk::File;

use super::record::parse;
use crate::files::{open_file, unreadable};

/// Kind and length.
const FRAMING_BYTES: u64 = 9;

/// An open file of records. Nothing is read of a record that is not asked for, and nothing is
/// reserved that the file does not hold.
#[derive(Debug)]
pub(super) struct RecordFile {
    file: BufReader<File>,
    name: String,
    end: u64,
    max_record_bytes: u64,
}

/// Where a record's body stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub(super) kind: u8,
    /// The record's first byte.
    start: u64,
    length: u64,
}

impl Span {
    /// The first byte after it.
    pub(super) fn end(&self) -> u64 {
        self.start + FRAMING_BYTES + self.length
    }
}

impl RecordFile {
    /// Opens a file below the root.
    ///
    /// # Errors
    /// If it cannot be read, or does not begin as MCAP does.
    pub(super) fn open(root: &Path, name: &str, max_record_bytes: u64) -> Result<Self, Fault> {
        let file = open_file(&root.join(name), name)?;
        let end = file.size_bytes().map_err(|error| unreadable(name, &error))?;
        let file = BufReader::new(file);
        let mut file = Self { file, name: name.to_owned(), end, max_record_bytes };
        file.check_magic(0, "an MCAP file")?;
        Ok(file)
    }

    /// The record that begins at a byte.
    ///
    /// # Errors
    /// If the file ends before it does.
    pub(super) fn span(&mut self, start: u64) -> Result<Span, Fault> {
        let left = self.end.saturating_sub(start);
        let [kind, length @ ..] = self.take::<9>(start)?;
        let length = u64::from_le_bytes(length);
        if length > left - FRAMING_BYTES {
            return Err(self.cut_off(start));
        }
        Ok(Span { kind, start, length })
    }

    /// The number of the channel with which a message or an index begins.
    ///
    /// # Errors
    /// If the record is shorter.
    pub(super) fn channel_number(&mut self, span: Span) -> Result<u16, Fault> {
        match span.length {
            0..2 => Err(self.fault(span.start, "mcap-record", "the number of a channel", "none")),
            _ => Ok(u16::from_le_bytes(self.take(span.start + FRAMING_BYTES)?)),
        }
    }

    /// A record's body.
    ///
    /// # Errors
    /// If it is too long, or cannot be read.
    pub(super) fn body(&mut self, span: Span) -> Result<Vec<u8>, Fault> {
        self.check_length(span.start, span.length)?;
        self.seek(span.start + FRAMING_BYTES)?;
        let mut body = vec![0; span.length as usize];
        self.file.read_exact(&mut body).map_err(|error| unreadable(&self.name, &error))?;
        Ok(body)
    }

    /// What a body says.
    ///
    /// # Errors
    /// If it is not laid out as its kind is.
    pub(super) fn parse<'a>(&self, span: Span, body: &'a [u8]) -> Result<Record<'a>, Fault> {
        parse(span.kind, body)
            .map_err(|found| self.fault(span.start, "mcap-record", "a record as specified", found))
    }

    /// Whether a record or chunk may have so many bytes.
    ///
    /// # Errors
    /// If it may not.
    pub(super) fn check_length(&self, at: u64, bytes: u64) -> Result<(), Fault> {
        if bytes <= self.max_record_bytes {
            return Ok(());
        }
        let expected = format!("at most {} bytes in a record or chunk", self.max_record_bytes);
        let fault = self.fault(at, "mcap-length", expected, format!("{bytes}"));
        Err(fault.hint("`reader.mcap.max_record_bytes` raises the limit"))
    }

    /// Whether the magic bytes stand here.
    ///
    /// # Errors
    /// If they do not.
    pub(super) fn check_magic(&mut self, at: u64, expected: &str) -> Result<(), Fault> {
        match self.take::<8>(at) {
            Ok(magic) if magic == mcap::MAGIC => Ok(()),
            Ok(_) => Err(self.fault(at, "mcap-magic", expected, "other bytes")),
            Err(_) => Err(self.fault(at, "mcap-magic", expected, "the end of the file")),
        }
    }

    /// A fault at a byte of this file.
    pub(super) fn fault(
        &self,
        at: u64,
        rule: &'static str,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> Fault {
        Fault::new(rule, &self.name, expected, found).offset(at)
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

    /// What is buffered is kept.
    fn seek(&mut self, at: u64) -> Result<(), Fault> {
        let here = self.file.stream_position().map_err(|error| unreadable(&self.name, &error))?;
        let near = i64::try_from(at).ok().zip(i64::try_from(here).ok()).map(|(at, here)| at - here);
        let sought = match near {
            Some(step) => self.file.seek_relative(step),
            None => self.file.seek(SeekFrom::Start(at)).map(drop),
        };
        sought.map_err(|error| unreadable(&self.name, &error))
    }

    fn cut_off(&self, at: u64) -> Fault {
        self.fault(at, "mcap-cut-off", "whole records up to a footer", "the end of the file")
    }
}
