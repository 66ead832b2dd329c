//! What will be labelled, found out from the tables alone: before any sweep is read, every fault
//! that the tables and the folders show is known.

use std::collections::BTreeSet;

use occlabel_core::Fault;

use crate::args::Shard;
use crate::console::Console;
use crate::exit::Stop;
use crate::interrupt::Interrupt;
use crate::label::findings::Findings;
use crate::label::job::Job;
use crate::label::planned_scene::{PlannedScene, Refused};
use crate::label::scene_run::Finished;

/// The scenes of a run.
pub(crate) struct Plan {
    pub(crate) scenes: Vec<PlannedScene>,
}

/// Scenes that cannot be labelled, with what is wrong.
#[derive(Default)]
struct Unfit {
    unsettled: Vec<(String, Fault)>,
    broken: Vec<(String, Fault)>,
}

impl Plan {
    /// Looks at every wanted scene, until it is interrupted.
    pub(crate) fn make(
        job: &Job,
        shard: Option<Shard>,
        findings: &mut Findings,
        interrupt: &Interrupt,
    ) -> Result<Self, Stop> {
        let mut tokens: BTreeSet<&str> = job.args.keyframes.iter().map(String::as_str).collect();
        let (mut scenes, mut unfit) = (Vec::new(), Unfit::default());
        for name in wanted(job, shard) {
            if interrupt.is_raised() {
                return Ok(Self { scenes });
            }
            match PlannedScene::plan(job, &name, &mut tokens, findings) {
                Ok(scene) => scenes.extend(scene),
                Err(refused) => unfit.add(&name, refused),
            }
        }
        if let Some(token) = tokens.first().filter(|_| unfit.is_empty()) {
            return Err(Stop::usage(unknown_keyframe(token)));
        }
        unfit.settle(job, scenes.is_empty(), findings)?;
        Ok(Self { scenes })
    }

    /// How many keyframes there are to label.
    pub(crate) fn keyframes(&self) -> usize {
        self.scenes.iter().map(|scene| scene.wanted.len()).sum()
    }

    /// The files of all sweeps, relative to the log's root, with their sizes.
    pub(crate) fn files(&self) -> impl Iterator<Item = &(String, u64)> {
        self.scenes.iter().flat_map(|scene| &scene.files)
    }

    /// The files of the scene after that one, if anything of it is left to do.
    pub(crate) fn files_after(
        &self,
        at: usize,
        finished: &Finished,
    ) -> impl Iterator<Item = &(String, u64)> + Clone + Send {
        let next = self.scenes.get(at + 1).filter(|next| !next.is_finished(finished));
        next.into_iter().flat_map(|next| &next.files)
    }

    /// `--dry-run`.
    pub(crate) fn print(&self, console: &Console) {
        self.scenes.iter().for_each(|scene| console.result(&scene.line()));
        let bytes: u64 = self.files().map(|(_, bytes)| bytes).sum();
        let (scenes, keyframes) = (self.scenes.len(), self.keyframes());
        console.result(&format!(
            "{scenes} scenes, {keyframes} keyframes, {bytes} bytes of sweeps; nothing written"
        ));
    }
}

impl Unfit {
    fn add(&mut self, name: &str, refused: Refused) {
        match refused {
            Refused::Configuration(fault) => self.unsettled.push((name.to_owned(), fault)),
            Refused::Broken(faults) => {
                self.broken.extend(faults.into_iter().map(|fault| (name.to_owned(), fault)));
            }
        }
    }

    fn is_empty(&self) -> bool {
        self.unsettled.is_empty() && self.broken.is_empty()
    }

    /// Ends the run, or goes on without these scenes.
    fn settle(self, job: &Job, is_nothing_left: bool, findings: &mut Findings) -> Result<(), Stop> {
        let faults_of =
            |list: Vec<(String, Fault)>| list.into_iter().map(|(_, fault)| fault).collect();
        if is_nothing_left && self.broken.is_empty() && !self.unsettled.is_empty() {
            return Err(Stop::Usage(faults_of(self.unsettled)));
        }
        let all: Vec<_> = self.broken.into_iter().chain(self.unsettled).collect();
        if !job.skips() && !all.is_empty() {
            return Err(Stop::Failed(faults_of(all)));
        }
        all.iter().for_each(|(scene, fault)| findings.lose(job.console, scene, fault));
        Ok(())
    }
}

/// The scenes of this run's shard.
fn wanted(job: &Job, shard: Option<Shard>) -> Vec<String> {
    let names = job.opened.source.scene_names();
    match shard {
        None => names,
        Some(shard) => names.into_iter().skip(shard.index).step_by(shard.count).collect(),
    }
}

fn unknown_keyframe(token: &str) -> Fault {
    let expected = "tokens of keyframes of the wanted scenes";
    Fault::new("keyframes", "--keyframes", expected, format!("`{token}`"))
        .hint("`occlabel inspect` lists them")
}
