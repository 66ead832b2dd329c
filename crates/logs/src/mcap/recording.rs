//! What a file says, its points and pixels aside.

use std::collections::BTreeMap;
use std::path::Path;

use blake3::Hash;
use occlabel_core::{Fault, Loss, McapSettings, Timestamp};

use super::container::{Container, Message, MessageAt, RECOVER_HINT};
use super::contents::Contents;
use super::dispatch::{Decoded, decode};
use super::frames::{Frames, checked_pose};
use super::messages::{Cloud, Cube, Defect, Header, Link, Optics, RawPose};
use super::options::{McapOptions, Purpose, TimeSource, purpose};
use crate::notes::Notes;

/// Header and log time farther apart than this are worth a word, seconds.
const CLOCKS_APART_S: f64 = 1.0;

/// All that was recorded, but for points and pixels.
#[derive(Debug, Default)]
pub(super) struct Recording {
    pub(super) file: String,
    pub(super) contents: Contents,
    pub(super) frames: Frames,
    /// In the file's order.
    pub(super) clouds: Vec<CloudHead>,
    /// With their topics.
    pub(super) optics: Vec<(String, Optics)>,
    pub(super) cubes: Vec<Cube>,
    /// Times at which boxes were looked for, though there may be none.
    pub(super) annotated: Vec<Timestamp>,
    /// By frame: a file of pixels.
    pub(super) masks: BTreeMap<String, Vec<u8>>,
    /// When images were taken.
    pub(super) pictures: Vec<Header>,
    /// Where its file is broken, although it is read.
    broken: Vec<Fault>,
}

/// A cloud without its points.
#[derive(Clone, Debug)]
pub(super) struct CloudHead {
    pub(super) at: MessageAt,
    pub(super) topic: String,
    pub(super) header: Header,
    pub(super) pose: RawPose,
    /// Names of the points' numbers.
    pub(super) fields: Vec<String>,
    pub(super) points: u64,
    /// Of all its bytes.
    pub(super) digest: Hash,
}

impl CloudHead {
    /// Of a cloud.
    pub(super) fn new(message: &Message, cloud: Cloud) -> Self {
        Self {
            at: message.at,
            topic: message.channel.topic.clone(),
            header: cloud.header,
            pose: cloud.pose,
            points: (cloud.data.len() / cloud.point_step.max(1)) as u64,
            fields: cloud.fields.into_iter().map(|field| field.name).collect(),
            digest: blake3::hash(&message.data),
        }
    }
}

impl Recording {
    /// Nothing of a file yet.
    pub(super) fn new(file: &str, settings: &McapSettings) -> Self {
        let frames = Frames::new(settings.max_transform_gap_s);
        Self { file: file.to_owned(), frames, ..Self::default() }
    }

    /// Reads a file below the root.
    ///
    /// # Errors
    /// If it is broken and not to be recovered.
    pub(super) fn read(
        root: &Path,
        file: &str,
        options: &McapOptions,
        notes: &mut Notes,
    ) -> Result<Self, Fault> {
        let mut container = Container::open(root, file, options.settings.max_record_bytes)?;
        let (contents, cut) = container.contents();
        let mut recording = Self::new(file, &options.settings);
        recording.lose(cut.map_or(Ok(()), Err), options, notes)?;
        let first = |purpose| purpose != Purpose::Pictures;
        recording.gather(&mut container, &contents, options, first, notes)?;
        if recording.has_latched_optics() {
            let then = |purpose| purpose == Purpose::Pictures;
            recording.gather(&mut container, &contents, options, then, notes)?;
        }
        recording.frames.finish();
        recording.frames.ambiguous(file).into_iter().for_each(|fault| notes.warn(fault));
        Ok(Self { contents, ..recording })
    }

    fn gather(
        &mut self,
        container: &mut Container,
        contents: &Contents,
        options: &McapOptions,
        wanted: impl Fn(Purpose) -> bool,
        notes: &mut Notes,
    ) -> Result<(), Fault> {
        let purpose = |channel: &_| purpose(&options.settings, channel).filter(|&p| wanted(p));
        let each = |message: Message| {
            if let Some(purpose) = purpose(&message.channel) {
                self.take(&message, purpose, options, notes);
            }
            Ok(())
        };
        let visited = container.visit(contents, |channel| purpose(channel).is_some(), each);
        self.lose(visited, options, notes)
    }

    /// What is broken is an error, unless the rest is to be recovered.
    fn lose(
        &mut self,
        result: Result<(), Fault>,
        options: &McapOptions,
        notes: &mut Notes,
    ) -> Result<(), Fault> {
        match result {
            Err(fault) if options.recover => {
                // What could be done about it is done.
                let fault =
                    Fault { hint: fault.hint.filter(|hint| *hint != RECOVER_HINT), ..fault };
                if !self.broken.contains(&fault) {
                    self.broken.push(fault.clone());
                    notes.refuse(Loss::Remainder, fault);
                }
                Ok(())
            }
            result => result,
        }
    }

    /// What it costs if there is no pose: behind the end of a broken file there are none.
    pub(super) fn loss_without_pose(&self, otherwise: Loss) -> Loss {
        if self.broken.is_empty() { otherwise } else { Loss::Remainder }
    }

    /// Whether a camera's optics were told once for all its images.
    fn has_latched_optics(&self) -> bool {
        let mut told: BTreeMap<&str, usize> = BTreeMap::new();
        self.optics.iter().for_each(|(topic, _)| *told.entry(topic).or_default() += 1);
        told.values().any(|count| *count == 1)
    }

    fn take(
        &mut self,
        message: &Message,
        purpose: Purpose,
        options: &McapOptions,
        notes: &mut Notes,
    ) {
        let loss = match purpose {
            Purpose::Sweeps | Purpose::Transforms => Loss::Sweep,
            Purpose::Boxes => Loss::Annotation,
            Purpose::Optics | Purpose::BodyMask | Purpose::Pictures => Loss::Camera,
        };
        let decoded = decode(message, options.time_source == TimeSource::Log);
        let decoded = decoded.map_err(|defect| self.fault("mcap-message", message, defect));
        let Some(Some(decoded)) = notes.accept(loss, decoded) else { return };
        self.check_clock(message, &decoded, notes);
        match decoded {
            Decoded::Links(links) => self.add_links(message, &links, notes),
            Decoded::Cloud(cloud) => self.clouds.push(CloudHead::new(message, cloud)),
            Decoded::Optics(optics) => self.optics.push((message.channel.topic.clone(), optics)),
            Decoded::Boxes(boxes) => {
                self.annotated.extend(boxes.cleared);
                self.annotated.extend(boxes.cubes.iter().map(|cube| cube.header.time));
                self.cubes.extend(boxes.cubes);
            }
            Decoded::Picture(picture) if purpose == Purpose::BodyMask => {
                self.masks.entry(picture.header.frame).or_insert(picture.data);
            }
            Decoded::Picture(picture) => self.pictures.push(picture.header),
        }
    }

    /// Takes a message of transforms, whatever else is in the file.
    ///
    /// # Errors
    /// Never: what is refused is noted.
    pub(super) fn take_links(&mut self, message: &Message, notes: &mut Notes) -> Result<(), Fault> {
        if let Ok(Some(Decoded::Links(links))) = decode(message, false) {
            self.add_links(message, &links, notes);
        }
        Ok(())
    }

    fn add_links(&mut self, message: &Message, links: &[Link], notes: &mut Notes) {
        for link in links {
            let defect = |found| Defect::new(format!("a pose of frame `{}`", link.child), found);
            let pose = checked_pose(&link.parent_from_child);
            let pose = pose.map_err(|found| self.fault("transform", message, defect(found)));
            let Some((pose, norm)) = notes.accept(Loss::Sweep, pose) else { continue };
            if let Some(norm) = norm {
                let found = format!("a quaternion of norm {norm}");
                notes.warn(self.fault("quaternion-norm", message, defect(found)));
            }
            self.frames.add(&link.header.frame, &link.child, link.header.time, pose);
        }
    }

    fn check_clock(&self, message: &Message, decoded: &Decoded, notes: &mut Notes) {
        let log_time = Timestamp(i64::try_from(message.log_time_ns).unwrap_or(i64::MAX));
        let Some(time) = decoded.time() else { return };
        let apart_s = time.seconds_apart(log_time);
        if apart_s > CLOCKS_APART_S && !matches!(decoded, Decoded::Links(_)) {
            let expected = format!("times within {CLOCKS_APART_S} s of the log's");
            let defect = Defect::new(expected, format!("{apart_s:.3} s"));
            let fault = self.fault("mcap-clock", message, defect);
            notes.warn(fault.hint("`--time-source log` takes the log's"));
        }
    }

    /// A fault of a message.
    pub(super) fn fault(&self, rule: &'static str, message: &Message, defect: Defect) -> Fault {
        let MessageAt { block, place } = message.at;
        let record = format!("{}, record {place} of its chunk", message.channel.topic);
        Fault::new(rule, &self.file, defect.expected, defect.found).record(record).offset(block)
    }
}
