//! What a file holds, its messages aside.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use mcap::records::{self, Metadata, Record, SchemaHeader};

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

impl Contents {
    /// Takes note of a schema, channel or metadata record; of several of one number the first counts.
    pub(super) fn add(&mut self, record: Record<'_>) {
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

    /// Whether every block's index names channels that are known.
    pub(super) fn is_indexed(&self) -> bool {
        let is_known = |number: &u16| self.channels.contains_key(number);
        let is_told =
            |block: &Block| !block.channels.is_empty() && block.channels.iter().all(is_known);
        self.blocks.iter().all(is_told)
    }
}

impl Block {
    /// Whether it may hold a message of such a channel; one without an index may hold any.
    pub(super) fn may_hold(&self, contents: &Contents, wanted: impl Fn(&Channel) -> bool) -> bool {
        let is_wanted = |number| contents.channels.get(number).is_some_and(|c| wanted(c));
        self.channels.is_empty() || self.channels.iter().any(is_wanted)
    }
}
