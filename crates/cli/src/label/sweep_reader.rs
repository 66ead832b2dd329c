//! Reading a scene's sweeps, and keeping book of what was odd about them.

use std::collections::BTreeMap;
use std::sync::Mutex;

use occlabel_core::{Fault, Keyframe, PointCloud, PointLabel, Scene, SweepHeader, is_finite};

use crate::interrupt::Interrupt;
use crate::label::findings::Findings;
use crate::label::job::Job;
use crate::label::tally::SweepCounts;

/// Reads sweeps, from any thread.
pub(crate) struct SweepReader<'a> {
    job: &'a Job<'a>,
    interrupt: &'a Interrupt,
    book: Mutex<Book>,
}

/// What reading brought to light.
#[derive(Default)]
pub(crate) struct Book {
    /// Sweeps that were read.
    read: u64,
    /// Their points.
    pub(crate) points: u64,
    warnings: Vec<Fault>,
    /// Sweeps that were left out, by their id.
    lost: BTreeMap<String, Fault>,
    /// Masks that were left out.
    lost_masks: Vec<Fault>,
    /// Points without finite coordinates, by the file of their sweeps.
    not_finite: BTreeMap<String, usize>,
}

impl<'a> SweepReader<'a> {
    pub(crate) fn new(job: &'a Job<'a>, interrupt: &'a Interrupt) -> Self {
        Self { job, interrupt, book: Mutex::default() }
    }

    /// The points of a sweep; none if it is left out, or if the scene will not be labelled any more.
    pub(crate) fn read(
        &self,
        sweep: &SweepHeader,
    ) -> Result<Option<PointCloud<PointLabel>>, Fault> {
        if self.interrupt.is_raised() {
            return Ok(None);
        }
        let read = self.job.opened.source.read_sweep(sweep);
        let not_finite = read.as_ref().map_or(0, |points| count_not_finite(&points.cloud));
        let mut book = self.book.lock().expect("no reader panicked");
        if not_finite > 0 {
            *book.not_finite.entry(sweep.file.clone()).or_default() += not_finite;
        }
        match read {
            Ok(points) => {
                book.read += 1;
                book.points += points.cloud.len() as u64;
                book.warnings.extend(points.warnings);
                Ok(Some(points.cloud))
            }
            Err(fault) if self.may_lose(&fault) => {
                book.lost.insert(sweep.source_id.clone(), fault);
                Ok(None)
            }
            Err(fault) => Err(fault),
        }
    }

    fn may_lose(&self, fault: &Fault) -> bool {
        let is_missing = fault.rule == "missing-file";
        self.job.skips() || (is_missing && self.job.args.allow_missing_sweeps)
    }

    /// The book, in an order that does not depend on threads, with the masks that were left out.
    pub(crate) fn close(self, lost_masks: Vec<Fault>) -> Book {
        let book = self.book.into_inner().expect("no reader panicked");
        let mut book = Book { lost_masks, ..book };
        book.warnings
            .sort_by(|a, b| (&a.place, a.rule, &a.record).cmp(&(&b.place, b.rule, &b.record)));
        book
    }
}

impl Book {
    /// The sweeps, whose files have so many bytes.
    pub(crate) fn sweeps(&self, file_bytes: u64) -> SweepCounts {
        SweepCounts { read: self.read, left_out: self.lost.len() as u64, file_bytes }
    }

    /// Points without finite coordinates, by the file of their sweeps.
    pub(crate) fn not_finite(&self) -> BTreeMap<String, usize> {
        self.not_finite.clone()
    }

    /// Tells of everything. Absent files were told of before any sweep was read.
    pub(crate) fn tell(&self, job: &Job, scene: &str, findings: &mut Findings) {
        let lost = self.lost.values().filter(|fault| fault.rule != "missing-file");
        self.warnings.iter().for_each(|fault| findings.warn(job.console, scene, fault));
        lost.chain(&self.lost_masks).for_each(|fault| findings.lose(job.console, scene, fault));
    }

    /// What a keyframe lost with its reference sweep, if that was left out.
    pub(crate) fn refusal_of(&self, scene: &Scene, keyframe: &Keyframe) -> Option<Fault> {
        let cause = self.lost.get(&scene.reference_sweep(keyframe).source_id)?;
        let expected = "the reference sweep of a keyframe";
        let fault = Fault::new("keyframe", &cause.place, expected, &cause.found);
        Some(fault.record(format!("keyframe {}, which is not labelled", keyframe.token)))
    }
}

fn count_not_finite(cloud: &PointCloud<PointLabel>) -> usize {
    cloud.positions.iter().filter(|position| !is_finite(position)).count()
}
