//! The images of a recording, found when the first is asked for: no label needs them.

use std::path::Path;

use occlabel_core::{Fault, McapSettings, Timestamp};

use super::container::{Container, Message, MessageAt};
use super::contents::Channel;
use super::dispatch::{Decoded, Kind, decode, kind};
use super::messages::{Header, Optics};
use super::options::{McapOptions, Purpose, TimeSource, purpose};
use super::recording::Recording;

/// An image farther than this from an exposure is of another moment, seconds.
const MAX_APART_S: f64 = 0.05;

/// The images of a file, without their pixels, in its order.
#[derive(Debug)]
pub(super) struct Pictures {
    heads: Vec<PictureHead>,
    /// What is wrong with the first message that tells neither frame nor time.
    broken: Option<Fault>,
}

/// An image without its pixels.
#[derive(Debug)]
struct PictureHead {
    at: MessageAt,
    topic: String,
    header: Header,
}

impl Pictures {
    /// Finds the images of a file below the root, reading all of them once.
    ///
    /// # Errors
    /// If the file is broken, and not to be recovered.
    pub(super) fn find(
        root: &Path,
        recording: &Recording,
        options: &McapOptions,
    ) -> Result<Self, Fault> {
        let mut pictures = Self { heads: Vec::new(), broken: None };
        let mut container = open(root, recording, options)?;
        let wanted = |channel: &Channel| {
            let is_picture = purpose(&options.settings, channel) == Some(Purpose::Pictures);
            is_picture && kind(channel) == Some(Kind::CompressedPicture)
        };
        let visited = container.visit(&recording.contents, wanted, |message| {
            pictures.add(recording, &message, options);
            Ok(())
        });
        if options.recover { Ok(pictures) } else { visited.map(|()| pictures) }
    }

    fn add(&mut self, recording: &Recording, message: &Message, options: &McapOptions) {
        match decode(message, options.time_source == TimeSource::Log) {
            Ok(Some(Decoded::Picture(picture))) => self.heads.push(PictureHead {
                at: message.at,
                topic: message.channel.topic.clone(),
                header: picture.header,
            }),
            Ok(_) => {}
            Err(defect) => {
                let fault = || recording.fault("mcap-message", message, defect);
                self.broken.get_or_insert_with(fault);
            }
        }
    }

    /// The bytes of the image that a camera took at a time: among those of its frame, of the topic
    /// nearest to its calibrations', the one nearest in time.
    ///
    /// # Errors
    /// If it cannot be read.
    pub(super) fn read(
        &self,
        (root, recording, options): (&Path, &Recording, &McapOptions),
        camera: &str,
        time: Timestamp,
    ) -> Result<Option<Vec<u8>>, Fault> {
        let mut optics = recording.optics.iter();
        let told = optics.find(|(topic, optics)| name(&options.settings, topic, optics) == camera);
        let Some((topic, Optics { header, .. })) = told else { return Ok(None) };
        let apart_s = |head: &PictureHead| head.header.time.seconds_apart(time);
        let of_camera =
            |head: &&PictureHead| head.header.frame == header.frame && apart_s(head) <= MAX_APART_S;
        let nearer = |a: &&PictureHead, b: &&PictureHead| {
            let rank = |head: &PictureHead| std::cmp::Reverse(shared(&head.topic, topic));
            let times = || apart_s(a).total_cmp(&apart_s(b));
            let order = || (&a.topic, a.header.time, a.at).cmp(&(&b.topic, b.header.time, b.at));
            rank(a).cmp(&rank(b)).then_with(times).then_with(order)
        };
        match self.heads.iter().filter(of_camera).min_by(nearer) {
            Some(head) => bytes(root, recording, options, head),
            None => self.broken.clone().map_or(Ok(None), Err),
        }
    }
}

/// A camera's name, by the topic of its calibrations.
pub(super) fn name<'a>(settings: &'a McapSettings, topic: &str, optics: &'a Optics) -> &'a str {
    settings.cameras.get(topic).unwrap_or(&optics.header.frame)
}

/// How many parts two topics share from the front.
fn shared(a: &str, b: &str) -> usize {
    a.split('/').zip(b.split('/')).take_while(|(a, b)| a == b).count()
}

fn bytes(
    root: &Path,
    recording: &Recording,
    options: &McapOptions,
    head: &PictureHead,
) -> Result<Option<Vec<u8>>, Fault> {
    let mut container = open(root, recording, options)?;
    let message = container.message(&recording.contents, head.at)?;
    match decode(&message, options.time_source == TimeSource::Log) {
        Ok(Some(Decoded::Picture(picture))) => Ok(Some(picture.data)),
        Ok(_) => Ok(None),
        Err(defect) => Err(recording.fault("mcap-message", &message, defect)),
    }
}

fn open(root: &Path, recording: &Recording, options: &McapOptions) -> Result<Container, Fault> {
    Container::open(root, &recording.file, options.settings.max_record_bytes)
}
