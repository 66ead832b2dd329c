//! v1 of the format: TFRecord files of `Frame` messages.
//!
//! Opened, a file is stepped through record by record, reading of each only whose frame it is and of
//! what time. A frame is read again when its scene is built, without images and range images, and
//! once more, whole and with its checksum verified, when points are asked for.

use std::collections::BTreeMap;
use std::io::{BufReader, Cursor};
use std::path::{Path, PathBuf};

use occlabel_core::{Fault, SweepHeader, Timestamp};
use occlabel_disk::File;

use super::calibration::Context;
use super::compressed::{floats, integers};
use super::frame::{broken, frame_place, laser, read_frame, read_head, read_lidars};
use super::matrix::MAX_PIXELS;
use super::range_image::{LABEL, PIXEL, POSE, RangeImages, Return};
use super::segment::{Frame, Lidar, LidarCalibration, Place, Segment, is_near};
use super::sweep_id::SweepId;
use super::tfrecord::{index_records, read_record};
use crate::files::open_file;
use crate::wire::{Fields, Span};

/// The frames of a folder's TFRecord files, by segment.
#[derive(Debug)]
pub(super) struct TfRecords {
    root: PathBuf,
    segments: BTreeMap<String, SegmentIndex>,
}

/// Where the frames of a segment stand.
#[derive(Debug, Default)]
struct SegmentIndex {
    /// In order of time, file, place.
    frames: Vec<FrameAt>,
    /// What is wrong with a file of it.
    fault: Option<Fault>,
}

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct FrameAt {
    micros: i64,
    file: String,
    start: u64,
    end: u64,
}

impl FrameAt {
    fn record(&self) -> Span {
        Span { start: self.start, end: self.end }
    }
}

impl TfRecords {
    /// Finds the frames in these files below the root. A file that is broken spoils the segments
    /// that were found in it, or a segment of its own name.
    pub(super) fn open(root: &Path, files: &[String]) -> Self {
        let mut segments = BTreeMap::new();
        for file in files {
            let mut names = Vec::new();
            if let Err(fault) = index_file(root, file, &mut segments, &mut names) {
                if names.is_empty() {
                    names.push(file.split(".tfrecord").next().unwrap_or(file).to_owned());
                }
                names.into_iter().for_each(|name| {
                    segments.entry(name).or_default().fault.get_or_insert_with(|| fault.clone());
                });
            }
        }
        segments.values_mut().for_each(|segment: &mut SegmentIndex| segment.frames.sort());
        Self { root: root.to_owned(), segments }
    }

    /// The segments' names.
    pub(super) fn names(&self) -> impl Iterator<Item = &String> {
        self.segments.keys()
    }

    /// The lidars of the first frame that can be read.
    ///
    /// # Errors
    /// If there is none.
    pub(super) fn any_lidars(&self) -> Result<Vec<LidarCalibration>, Fault> {
        let mut fault = Fault::new("frame-message", ".", "a frame", "none");
        for segment in self.segments.values() {
            for frame in &segment.frames {
                match self.frame(frame) {
                    Ok((_, context)) => return Ok(context.lidars),
                    Err(broken) => fault = broken,
                }
            }
            fault = segment.fault.clone().unwrap_or(fault);
        }
        Err(fault)
    }

    /// Everything of a segment but its points; `None` if there is no such segment.
    ///
    /// # Errors
    /// If a file of it is broken, or every frame.
    pub(super) fn segment(&self, name: &str) -> Option<Result<Segment, Fault>> {
        let index = self.segments.get(name)?;
        Some(match &index.fault {
            Some(fault) => Err(fault.clone()),
            None => self.read_segment(index),
        })
    }

    fn read_segment(&self, index: &SegmentIndex) -> Result<Segment, Fault> {
        let (mut copies, mut once) = (Vec::new(), Vec::new());
        for (i, frame) in index.frames.iter().enumerate() {
            let is_copy = i > 0 && self.is_copy(&index.frames[i - 1], frame)?;
            if is_copy { copies.push(frame) } else { once.push(frame) }
        }
        let warnings = copies.into_iter().map(copied).collect();
        let frames: Vec<_> = once.into_iter().map(|frame| self.frame(frame)).collect();
        let context = frames.iter().flatten().next().map(|(_, context)| context.clone());
        let Some(Context { lidars, cameras }) = context else {
            let none = || Fault::new("frame-message", ".", "a frame", "none");
            return Err(frames.into_iter().find_map(Result::err).unwrap_or_else(none));
        };
        let frames = frames.into_iter().map(|frame| same_lidars(frame?, &lidars)).collect();
        Ok(Segment { lidars, cameras, frames, warnings })
    }

    /// Whether a frame is the same as the one before it, byte for byte.
    fn is_copy(&self, before: &FrameAt, frame: &FrameAt) -> Result<bool, Fault> {
        let alike = |at: &FrameAt| (at.micros, at.record().len());
        Ok(alike(before) == alike(frame) && self.data(before)? == self.data(frame)?)
    }

    fn data(&self, at: &FrameAt) -> Result<Vec<u8>, Fault> {
        let mut file = open_file(&self.root.join(&at.file), &at.file)?;
        read_record(&mut file, at.record(), &at.file)
    }

    fn frame(&self, at: &FrameAt) -> Result<(Frame, Context), Fault> {
        let mut file = BufReader::new(open_file(&self.root.join(&at.file), &at.file)?);
        read_frame(&mut file, at.record(), (&at.file, at.micros))
    }

    /// The JPEG that a camera took at a time, if it is in a frame of about that time.
    ///
    /// # Errors
    /// If a frame is broken.
    pub(super) fn jpeg(
        &self,
        segment: &str,
        camera: &str,
        time: Timestamp,
    ) -> Result<Option<Vec<u8>>, Fault> {
        let frames = self.segments.get(segment).map_or(&[][..], |segment| &segment.frames);
        for at in frames.iter().filter(|at| is_near(at.micros, time)) {
            let (frame, _) = self.frame(at)?;
            let Some(span) = frame.image(camera, time).and_then(|image| image.jpeg) else {
                continue;
            };
            let mut file = open_file(&self.root.join(&at.file), &at.file)?;
            let data = read_record(&mut file, at.record(), &at.file)?;
            let of_record = Span { start: span.start - at.start, end: span.end - at.start };
            return Ok(Some(slice(&data, of_record).to_vec()));
        }
        Ok(None)
    }

    /// What a lidar saw in a sweep, and how it is calibrated.
    ///
    /// # Errors
    /// If the record is broken, or its range images are none.
    pub(super) fn images(
        &self,
        id: &SweepId,
        sweep: &SweepHeader,
    ) -> Result<(RangeImages, LidarCalibration), Fault> {
        let frames = self.segments.get(&id.segment).map(|segment| &segment.frames);
        let at = frames.and_then(|frames| {
            frames.iter().find(|frame| frame.micros == id.micros && frame.file == sweep.file)
        });
        let Some(at) = at else {
            return Err(Fault::new("sweep-unknown", &sweep.file, "a sweep of this log", "another")
                .record(&sweep.source_id));
        };
        let mut file = open_file(&self.root.join(&at.file), &at.file)?;
        let place = frame_place(&at.file, at.record(), &sweep.source_id);
        let data = read_record(&mut file, at.record(), &at.file);
        let data = data.map_err(|fault| fault.record(&sweep.source_id))?;
        lidar_images(&data, (id.lidar, sweep.labelled), &place, at.start)
    }
}

fn copied(frame: &FrameAt) -> Fault {
    let place = frame_place(&frame.file, frame.record(), &format!("frame {}", frame.micros));
    place.fault("frame-time", "one frame at a time", "a copy")
}

/// The frame, if its lidars are those of the segment.
fn same_lidars(
    (frame, context): (Frame, Context),
    lidars: &[LidarCalibration],
) -> Result<Frame, Fault> {
    if context.lidars == lidars {
        return Ok(frame);
    }
    let expected = "the lidar calibrations of the segment's first frame";
    Err(frame.place.fault("lidar-changed", expected, "others"))
}

/// Adds a file's frames to the segments, and the names of these to `names`.
fn index_file(
    root: &Path,
    name: &str,
    segments: &mut BTreeMap<String, SegmentIndex>,
    names: &mut Vec<String>,
) -> Result<(), Fault> {
    let mut file: BufReader<File> = BufReader::new(open_file(&root.join(name), name)?);
    let (records, fault) = index_records(&mut file, name);
    for record in records {
        let (segment, micros) = read_head(&mut file, record, name)?;
        if !names.contains(&segment) {
            names.push(segment.clone());
        }
        let Span { start, end } = record;
        let frame = FrameAt { micros, file: name.to_owned(), start, end };
        segments.entry(segment).or_default().frames.push(frame);
    }
    fault.map_or(Ok(()), Err)
}

/// The range images of a lidar in a frame's message that begins at byte `start` of its file.
fn lidar_images(
    data: &[u8],
    (lidar, labelled): (Lidar, bool),
    place: &Place,
    start: u64,
) -> Result<(RangeImages, LidarCalibration), Fault> {
    let broken = |defect| broken(place, start, defect);
    let mut source = Cursor::new(data);
    let frame = Fields::read(&mut source, whole(data)).map_err(broken)?;
    let lidars = read_lidars(&mut source, &frame, place)?;
    let calibration = lidars.into_iter().find(|calibration| calibration.lidar == lidar);
    let laser = laser(&mut source, &frame, lidar).map_err(broken)?;
    let (Some(calibration), Some(laser)) = (calibration, laser) else {
        return Err(place.fault("range-image", "a calibrated lidar with range images", "none"));
    };
    let mut images = RangeImages { returns: Vec::new(), poses: None };
    for number in [2, 3] {
        let Some(span) = laser.bytes(number) else { continue };
        let one = Fields::read(&mut source, span).map_err(broken)?;
        let decoded = decode_return(data, &one, labelled, &mut images);
        decoded.map_err(|found| {
            let expected = format!("range images of return {}, {PIXEL} values a pixel", number - 1);
            place.fault("range-image", expected, found)
        })?;
    }
    Ok((images, calibration))
}

/// Adds a return, if it is there, and the pixels' poses, if these are.
fn decode_return(
    data: &[u8],
    one: &Fields,
    labelled: bool,
    images: &mut RangeImages,
) -> Result<(), String> {
    let part =
        |number| one.bytes(number).map(|span| slice(data, span)).filter(|part| !part.is_empty());
    let Some(pixels) = part(2) else { return Ok(()) };
    let pixels = floats(pixels, PIXEL, MAX_PIXELS)?;
    let (rows, columns) = pixels.size();
    let labels = part(6).filter(|_| labelled);
    let labels = labels.map(|labels| integers(labels, LABEL, rows * columns)).transpose()?;
    if let (Some(poses), None) = (part(4), &images.poses) {
        images.poses = Some(floats(poses, POSE, rows * columns)?);
    }
    images.returns.push(Return { pixels, labels });
    Ok(())
}

fn slice(data: &[u8], span: Span) -> &[u8] {
    &data[span.start as usize..span.end as usize]
}

fn whole(data: &[u8]) -> Span {
    Span { start: 0, end: data.len() as u64 }
}
