//! The meshes of a scene's bodies: found as it is planned, read and fitted as it is labelled.

use std::collections::BTreeSet;

use occlabel_core::{AggregatedScene, ClassId, Fault, Keyframe, LoggedMesh, Scene};
use occlabel_labels::TrackRecord;
use occlabel_logs::{MeshFile, MeshFolder};
use occlabel_pipeline::{Fit, KeyframeMeshes, MeshFit, MeshTracks, embody, mesh_tracks};
use rayon::prelude::*;
use serde::Serialize;

use crate::label::findings::Findings;
use crate::label::job::Job;

/// Read, a mesh takes at most so many times the bytes of its file: a face of six letters takes twelve
/// bytes, once in the log's frame and once in world.
const BYTES_A_FILE_BYTE: u64 = 4;

/// The meshes of a scene that will be labelled.
#[derive(Debug, Default)]
pub(crate) struct PlannedMeshes {
    files: Vec<MeshFile>,
    tracks: MeshTracks,
}

/// What became of the meshes of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct MeshCounts {
    /// Moved onto their points.
    pub(crate) aligned: u64,
    /// Left where they were.
    pub(crate) as_given: u64,
    /// Too far off their points.
    pub(crate) refused: u64,
}

impl PlannedMeshes {
    /// Finds the meshes of a scene, and tells if there are none.
    pub(crate) fn plan(job: &Job, scene: &Scene, findings: &mut Findings) -> Result<Self, Fault> {
        let Some(folder) = &job.opened.meshes else { return Ok(Self::default()) };
        let files = folder.files(&scene.name, &scene.keyframes)?;
        if files.is_empty() {
            let place = format!("{}/{}", folder.name(), scene.name);
            let fault = Fault::new("no-meshes", place, "meshes of the scene's keyframes", "none");
            findings.warn(job.console, &scene.name, &fault);
        }
        let mut names = BTreeSet::new();
        for file in &files {
            names.extend(folder.tracks(file)?);
        }
        let tracks = mesh_tracks(scene, &names, &job.opened.rules)?;
        Ok(Self { files, tracks })
    }

    /// The memory that they take at most.
    pub(crate) fn memory_bytes(&self) -> u64 {
        BYTES_A_FILE_BYTE * self.files.iter().map(|file| file.bytes).sum::<u64>()
    }

    /// Their files, from what holds the folder of meshes.
    pub(crate) fn paths(&self) -> impl Iterator<Item = &String> {
        self.files.iter().map(|file| &file.path)
    }

    /// How many numbers the tracks of the scene and the bodies after them have.
    pub(crate) fn numbered(&self, scene: &Scene) -> usize {
        let highest = self.tracks.values().map(|id| usize::from(id.0)).max();
        highest.unwrap_or_default().max(scene.tracks.len())
    }

    /// Bodies that are numbered after the scene's tracks, as the manifest lists them.
    pub(crate) fn own_tracks(
        &self,
        scene: &Scene,
        names: &[String],
        job: &Job,
    ) -> Vec<TrackRecord> {
        let own = self.tracks.iter().filter(|(_, id)| usize::from(id.0) > scene.tracks.len());
        let class = job.opened.rules.meshes.class.map(|class| names[class.index()].clone());
        let record = |(name, id): (&String, &occlabel_core::TrackId)| TrackRecord {
            index: id.0,
            id: name.clone(),
            class: class.clone(),
            category: String::new(),
        };
        own.map(record).collect()
    }

    /// Reads the meshes, gives the scene its bodies, and tells what became of them.
    pub(crate) fn embody(
        &self,
        job: &Job,
        scene: &Scene,
        aggregated: &mut AggregatedScene<ClassId>,
        findings: &mut Findings,
    ) -> Result<MeshCounts, Fault> {
        let Some(folder) = &job.opened.meshes else { return Ok(MeshCounts::default()) };
        let read = |keyframe| (keyframe, self.read(folder, keyframe));
        let read: Vec<_> = scene.keyframes.par_iter().map(read).collect();
        let mut meshes = Vec::new();
        for (keyframe, read) in read {
            match read {
                Ok(read) => meshes.push(KeyframeMeshes { keyframe, meshes: read }),
                Err(fault) if job.skips() => findings.lose(job.console, &scene.name, &fault),
                Err(fault) => return Err(fault),
            }
        }
        let fits = embody(scene, aggregated, meshes, &self.tracks, &job.opened.rules);
        let warnings = [refused(&fits), self.without_track(scene, &fits)];
        warnings.iter().flatten().for_each(|told| findings.warn(job.console, &scene.name, told));
        Ok(MeshCounts::of(&fits))
    }

    fn read(&self, folder: &MeshFolder, keyframe: &Keyframe) -> Result<Vec<LoggedMesh>, Fault> {
        let of_keyframe = self.files.iter().filter(|file| file.keyframe == keyframe.token);
        folder.read(&of_keyframe.collect::<Vec<_>>())
    }

    fn without_track(&self, scene: &Scene, fits: &[MeshFit]) -> Option<Fault> {
        let is_own = |fit: &&MeshFit| usize::from(self.tracks[&fit.track].0) > scene.tracks.len();
        let own: Vec<_> = fits.iter().filter(is_own).collect();
        let first = own.first()?;
        let found =
            format!("{} of {} meshes without one: they stay as given", own.len(), fits.len());
        let fault = Fault::new("mesh-track", &scene.name, "a track of each mesh's name", found);
        Some(fault.record(format!("{} at {}", first.track, first.keyframe)))
    }
}

/// What is told of meshes that stand too far off their points.
fn refused(fits: &[MeshFit]) -> Option<Fault> {
    let off = |fit: &MeshFit| match fit.fit {
        Fit::Refused(residual_m) => Some((fit.clone(), residual_m)),
        Fit::AsGiven | Fit::Aligned(_) => None,
    };
    let refused: Vec<_> = fits.iter().filter_map(off).collect();
    let (first, residual_m) = refused.first()?;
    let found = format!(
        "{} of {} meshes farther off, the first by {residual_m:.3} m: points stand for them",
        refused.len(),
        fits.len()
    );
    let expected = "meshes on their points, up to meshes.max_residual_m";
    let fault = Fault::new("mesh-residual", "meshes", expected, found);
    Some(fault.record(format!("{} at {}", first.track, first.keyframe)))
}

impl MeshCounts {
    fn of(fits: &[MeshFit]) -> Self {
        let mut counts = Self::default();
        for fit in fits {
            match fit.fit {
                Fit::Aligned(_) => counts.aligned += 1,
                Fit::AsGiven => counts.as_given += 1,
                Fit::Refused(_) => counts.refused += 1,
            }
        }
        counts
    }

    pub(crate) fn add(&mut self, other: &Self) {
        self.aligned += other.aligned;
        self.as_given += other.as_given;
        self.refused += other.refused;
    }
}
