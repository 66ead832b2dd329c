//! Who is known by their surface: meshes in world, moved onto their points (labels.md section 9a).

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Point3;
use occlabel_annotate::{BoxSource, box_at};
use occlabel_core::{
    AggregatedScene, Body, BodyMotion, BoxTrack, ClassId, Fault, Keyframe, LoggedMesh, ObjectSweep,
    Pose, Scene, TrackId, TriangleMesh,
};
use occlabel_meshes::{View, align, motion_between};
use rayon::prelude::*;

use crate::{MeshFrame, Rules};

/// The meshes of a keyframe as the log has them.
#[derive(Clone, Debug)]
pub struct KeyframeMeshes<'a> {
    /// The keyframe.
    pub keyframe: &'a Keyframe,
    /// One for each body, in the frame of `meshes.frame`.
    pub meshes: Vec<LoggedMesh>,
}

/// The numbers that the bodies of a scene's meshes have, by the names of the meshes' tracks: those of
/// the tracks, and for others numbers after these, in byte order.
pub type MeshTracks = BTreeMap<String, TrackId>;

/// What became of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFit {
    /// The keyframe's token.
    pub keyframe: String,
    /// The mesh's track.
    pub track: String,
    /// How many points there are of it.
    pub points: usize,
    /// How it stands to them.
    pub fit: Fit,
}

/// How a mesh stands to the points of its track.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fit {
    /// It stays where it was: there are too few points, or it is not asked for.
    AsGiven,
    /// It was moved onto them, which leaves the mean distance of a point, metres.
    Aligned(f64),
    /// They lie too far off, metres: it is not used.
    Refused(f64),
}

/// Numbers the bodies of a scene.
///
/// # Errors
/// If there are more than 65 535 tracks and bodies, or a mesh without a track has no class.
pub fn mesh_tracks(
    scene: &Scene,
    names: &BTreeSet<String>,
    rules: &Rules,
) -> Result<MeshTracks, Fault> {
    let mut tracks: MeshTracks =
        scene.tracks.iter().map(|track| (track.source_id.clone(), track.id)).collect();
    for name in names {
        let next = tracks.len() + 1;
        if tracks.contains_key(name) {
            continue;
        }
        if rules.meshes.class.is_none() {
            let expected = "a class for a mesh without a track";
            return Err(Fault::new("mesh-class", "meshes.class", expected, "none").record(name));
        }
        let Ok(number) = u16::try_from(next) else {
            return Err(Fault::new("tracks", &scene.name, "at most 65535 tracks", "more"));
        };
        tracks.insert(name.clone(), TrackId(number));
    }
    Ok(tracks)
}

/// Gives a scene its bodies: its keyframes' meshes, in order of time, moved onto the points of their
/// tracks, with how they move. Tells what became of each. Parallel over meshes.
///
/// # Panics
/// If a mesh has a track that is not numbered.
pub fn embody(
    scene: &Scene,
    aggregated: &mut AggregatedScene<ClassId>,
    keyframes: Vec<KeyframeMeshes>,
    tracks: &MeshTracks,
    rules: &Rules,
) -> Vec<MeshFit> {
    let bench = Bench { scene, objects: objects(aggregated), tracks, rules };
    let meshes: Vec<(&Keyframe, LoggedMesh)> = keyframes
        .into_iter()
        .flat_map(|of| of.meshes.into_iter().map(move |mesh| (of.keyframe, mesh)))
        .collect();
    let fitted: Vec<_> =
        meshes.into_par_iter().filter_map(|(keyframe, mesh)| bench.fit(keyframe, mesh)).collect();
    let (bodies, fits): (Vec<_>, Vec<_>) = fitted.into_iter().unzip();
    let mut bodies: Vec<Body> = bodies.into_iter().flatten().collect();
    bodies.sort_by_key(|body| (body.time, body.track));
    set_motions(&mut bodies, rules.boxes.max_gap_s);
    aggregated.bodies = bodies;
    fits
}

/// What all meshes are fitted by.
struct Bench<'a> {
    scene: &'a Scene,
    objects: BTreeMap<TrackId, Vec<&'a ObjectSweep>>,
    tracks: &'a MeshTracks,
    rules: &'a Rules,
}

/// The points of each track, sweep by sweep.
fn objects(aggregated: &AggregatedScene<ClassId>) -> BTreeMap<TrackId, Vec<&ObjectSweep>> {
    let mut objects: BTreeMap<TrackId, Vec<&ObjectSweep>> = BTreeMap::new();
    for object in aggregated.objects.iter().filter(|object| !object.cloud.is_empty()) {
        objects.entry(object.track).or_default().push(object);
    }
    objects
}

impl Bench<'_> {
    /// A mesh as a body; none if it is refused. Nothing at all of a track that is ignored.
    fn fit(&self, keyframe: &Keyframe, logged: LoggedMesh) -> Option<(Option<Body>, MeshFit)> {
        let number = self.tracks[&logged.track];
        let track = self.scene.tracks.get(usize::from(number.0) - 1);
        let class = track.map_or(self.rules.meshes.class, BoxTrack::class)?;
        let mesh = logged.mesh.moved(&self.world_from_mesh(keyframe));
        let views = self.views(keyframe, track);
        let points = views.iter().map(|view| view.points.len()).sum();
        let (fit, mesh) = self.aligned(mesh, &views, points);
        let astray_m = self.astray_m(&mesh, keyframe, track).filter(|_| fit == Fit::AsGiven);
        let fit = astray_m.map_or(fit, Fit::Refused);
        let body = Body { time: keyframe.time, track: number, class, mesh, motion: None };
        let body = (!matches!(fit, Fit::Refused(_))).then_some(body);
        let keyframe = keyframe.token.clone();
        Some((body, MeshFit { keyframe, track: logged.track, points, fit }))
    }

    fn aligned(&self, mesh: TriangleMesh, views: &[View], points: usize) -> (Fit, TriangleMesh) {
        let rules = &self.rules.meshes;
        let Some(settings) = rules.align.as_ref().filter(|_| points >= rules.min_points) else {
            return (Fit::AsGiven, mesh);
        };
        let found = align(&mesh, views, settings);
        match found.residual_m <= rules.max_residual_m {
            true => (Fit::Aligned(found.residual_m), mesh.moved(&found.aligned_from_given)),
            false => (Fit::Refused(found.residual_m), mesh),
        }
    }

    /// How far a mesh lies off the box of its track, metres, if that is farther than points may be.
    fn astray_m(
        &self,
        mesh: &TriangleMesh,
        keyframe: &Keyframe,
        track: Option<&BoxTrack>,
    ) -> Option<f64> {
        let (boxed, _) = box_at(track?, keyframe.time, &self.rules.boxes)?;
        let centre = Point3::from(boxed.world_from_box.translation.vector);
        let off_m = (mesh.centre() - centre).norm() - boxed.size_m.norm() / 2.0;
        let most_m = self.rules.meshes.align.as_ref()?.max_pair_m;
        (off_m > most_m).then_some(off_m)
    }

    fn world_from_mesh(&self, keyframe: &Keyframe) -> Pose {
        let reference = self.scene.reference_sweep(keyframe);
        match self.rules.meshes.frame {
            MeshFrame::World => Pose::identity(),
            MeshFrame::Ego => reference.world_from_ego,
            MeshFrame::Lidar => reference.world_from_lidar(),
        }
    }

    /// What was seen of a track at the time of a keyframe, world: its points move with its box.
    fn views(&self, keyframe: &Keyframe, track: Option<&BoxTrack>) -> Vec<View> {
        let Some(track) = track else { return Vec::new() };
        let boxed = box_at(track, keyframe.time, &self.rules.boxes);
        let boxed = boxed.filter(|(_, source)| *source != BoxSource::Extrapolated);
        let (Some((boxed, _)), Some(seen)) = (boxed, self.objects.get(&track.id)) else {
            return Vec::new();
        };
        let same_time_s = self.rules.rays().settings.same_time_s;
        let is_now = |seen: &&&ObjectSweep| {
            seen.time.is_some_and(|time| time.seconds_apart(keyframe.time) <= same_time_s)
        };
        seen.iter().filter(is_now).map(|seen| placed(seen, &boxed.world_from_box)).collect()
    }
}

/// What a sweep saw of a track, where its box stands so.
fn placed(seen: &ObjectSweep, world_from_box: &Pose) -> View {
    let points = seen.cloud.positions.iter().map(|point| world_from_box * point).collect();
    View { from: world_from_box * seen.origin(0), points }
}

/// Has each body move as its neighbours in time say.
fn set_motions(bodies: &mut [Body], max_gap_s: f64) {
    let mut of_track: BTreeMap<TrackId, Vec<usize>> = BTreeMap::new();
    for (at, body) in bodies.iter().enumerate() {
        of_track.entry(body.track).or_default().push(at);
    }
    let motions: Vec<_> = of_track
        .values()
        .flat_map(|track| (0..track.len()).map(move |at| (track, at)))
        .map(|(track, at)| (track[at], motion(bodies, track, at, max_gap_s)))
        .collect();
    motions.into_iter().for_each(|(at, motion)| bodies[at].motion = motion);
}

/// From the body before to the body after, as far as there are any within the gap: half of the error of
/// a fit to one side alone.
fn motion(bodies: &[Body], track: &[usize], at: usize, max_gap_s: f64) -> Option<BodyMotion> {
    let now = &bodies[track[at]];
    let near = |other: &&Body| other.time.seconds_apart(now.time) <= max_gap_s;
    let earlier = at.checked_sub(1).map(|at| &bodies[track[at]]).filter(near);
    let later = track.get(at + 1).map(|&at| &bodies[at]).filter(near);
    let way =
        |to: Option<&Body>| to.map_or(Pose::identity(), |to| motion_between(&now.mesh, &to.mesh));
    let times = [earlier, later].map(|other| other.map_or(now.time, |other| other.time));
    (times[0] < times[1]).then(|| BodyMotion {
        later_from_now: way(later),
        earlier_from_now: way(earlier),
        seconds: times[1].seconds_since(times[0]),
    })
}
