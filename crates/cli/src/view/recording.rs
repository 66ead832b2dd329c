//! A scene of labels, and what its log has beside them, as an MCAP file on one time line.

use std::io::BufWriter;

use occlabel_core::{Exposure, Fault, Palette, Pose, SweepHeader, Timestamp};
use occlabel_dialects::KeyframeKey;
use occlabel_disk::File;
use occlabel_labels::write_pieces;
use occlabel_pipeline::standing_at;
use occlabel_view::{EGO, GRID, Recording, ShownBox, ShownScene, WORLD};

use crate::args::ViewArgs;
use crate::console::Console;
use crate::exit::Stop;
use crate::logged_scene::LoggedScene;
use crate::shown_set::ShownSet;

/// Seconds between keyframes of which nothing tells the times.
const STEP_S: i64 = 1;

pub(crate) fn make(args: &ViewArgs, labels: &ShownSet, console: &Console) -> Result<(), Stop> {
    let scene = labels.scene(args.scene.as_deref()).map_err(Stop::usage)?;
    let keys = labels.keyframes(&scene.name, &args.keyframes).map_err(Stop::usage)?;
    let open = |log| LoggedScene::open(log, &args.config, labels, &scene.name);
    let logged = args.log.as_ref().map(open).transpose()?;
    let times = match known_times(labels, logged.as_ref(), &keys)? {
        Some(times) => times,
        None => {
            console.info("nothing tells when the keyframes were: they stand 1 s apart");
            (0..keys.len() as i64).map(|at| Timestamp(at * STEP_S * 1_000_000_000)).collect()
        }
    };
    let shown = Shown { labels, scene, keys, times, logged };
    let events = shown.events(args.all_sweeps, !args.keyframes.is_empty());
    let place = args.output.display().to_string();
    write_pieces(&args.output, |to| Ok(shown.record(&events, to, &place)?))
}

/// When the keyframes were, by the log or else by the manifest of the labels.
fn known_times(
    labels: &ShownSet,
    logged: Option<&LoggedScene>,
    keys: &[KeyframeKey],
) -> Result<Option<Vec<Timestamp>>, Fault> {
    match logged {
        Some(logged) => {
            let time = |key: &KeyframeKey| Ok(logged.keyframe(&key.token)?.time);
            keys.iter().map(time).collect::<Result<_, _>>().map(Some)
        }
        None => Ok(keys.iter().map(|key| labels.time(key)).collect()),
    }
}

/// What stands on the time line.
struct Shown<'a> {
    labels: &'a ShownSet,
    scene: ShownScene,
    keys: Vec<KeyframeKey>,
    /// Of the keyframes.
    times: Vec<Timestamp>,
    logged: Option<LoggedScene>,
}

/// Something that happens at a time; of several at one time that goes first which stands first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Event {
    /// A sweep of the log.
    Sweep(usize),
    /// A keyframe, and which of its exposures.
    Exposure(usize, usize),
    Keyframe(usize),
}

type To<'a, 'b> = Recording<&'a mut BufWriter<&'b mut File>>;

impl Shown<'_> {
    /// All events in order of time. Of some keyframes alone all sweeps are those between them.
    fn events(&self, all_sweeps: bool, is_part: bool) -> Vec<(Timestamp, Event)> {
        let keyframes = self.times.iter().copied().zip((0..).map(Event::Keyframe));
        let mut events: Vec<_> = keyframes.collect();
        let Some(logged) = &self.logged else { return events };
        for (at, key) in self.keys.iter().enumerate() {
            let Ok(keyframe) = logged.keyframe(&key.token) else { continue };
            let exposures = keyframe.exposures.iter().map(|exposure| exposure.time);
            events.extend(exposures.zip((0..).map(|exposure| Event::Exposure(at, exposure))));
            events.push((keyframe.time, Event::Sweep(keyframe.sweep)));
        }
        let (first, last) = (self.times.iter().min(), self.times.iter().max());
        let is_between = |time| !is_part || (Some(time) >= first && Some(time) <= last);
        for (sweep, header) in logged.scene.sweeps.iter().enumerate() {
            if all_sweeps && is_between(&header.time) {
                events.push((header.time, Event::Sweep(sweep)));
            }
        }
        events.sort();
        events.dedup();
        events
    }

    fn record(
        &self,
        events: &[(Timestamp, Event)],
        to: &mut BufWriter<&mut File>,
        place: &str,
    ) -> Result<(), Fault> {
        let mut to = Recording::begin(to, place, &self.scene)?;
        if let Some(logged) = &self.logged {
            to.name_point_labels(&logged.rules.taxonomy.names)?;
        }
        for &(time, event) in events {
            match (event, &self.logged) {
                (Event::Keyframe(at), _) => self.keyframe(at, time, &mut to)?,
                (Event::Sweep(sweep), Some(logged)) => {
                    record_sweep(logged, &logged.scene.sweeps[sweep], &mut to)?;
                }
                (Event::Exposure(at, exposure), Some(logged)) => {
                    let keyframe = logged.keyframe(&self.keys[at].token)?;
                    record_exposure(logged, &keyframe.exposures[exposure], &mut to)?;
                }
                (_, None) => {}
            }
        }
        to.finish()
    }

    fn keyframe(&self, at: usize, time: Timestamp, to: &mut To) -> Result<(), Fault> {
        let keyframe = self.labels.read(&self.keys[at])?;
        let mut world_from_grid = keyframe.world_from_grid;
        if let Some(logged) = &self.logged {
            world_from_grid = Some(logged.world_from_grid(logged.keyframe(&keyframe.token)?));
        }
        if let Some(world_from_grid) = world_from_grid {
            to.place(time, WORLD, GRID, &world_from_grid)?;
            if self.scene.frame == "ego" {
                to.place(time, WORLD, EGO, &world_from_grid)?;
            }
        }
        to.keyframe(time, &keyframe, &self.scene)?;
        match &self.logged {
            Some(logged) if !logged.scene.tracks.is_empty() => to.boxes(time, &boxes(logged, time)),
            _ => Ok(()),
        }
    }
}

fn record_sweep(logged: &LoggedScene, header: &SweepHeader, to: &mut To) -> Result<(), Fault> {
    // What is odd about a sweep was told when it was labelled.
    let points = logged.source.read_sweep(header)?;
    to.place(header.time, WORLD, EGO, &header.world_from_ego)?;
    to.place(header.time, EGO, &header.lidar, &header.ego_from_lidar)?;
    to.sweep(header, &points.cloud, &Palette::of(&logged.rules.taxonomy.names))
}

fn record_exposure(logged: &LoggedScene, exposure: &Exposure, to: &mut To) -> Result<(), Fault> {
    let camera = &logged.scene.cameras[exposure.camera];
    to.place(exposure.time, WORLD, &camera.name, &exposure.world_from_camera)?;
    to.camera(exposure.time, camera)?;
    match logged.source.read_image(&logged.scene, exposure)? {
        Some(bytes) => to.image(exposure.time, &camera.name, bytes),
        None => Ok(()),
    }
}

/// The boxes of the tracks that stand at a time, annotated or interpolated.
fn boxes(logged: &LoggedScene, time: Timestamp) -> Vec<ShownBox> {
    let (tracks, names) = (&logged.scene.tracks, &logged.rules.taxonomy.names);
    let palette = Palette::of(names);
    let standing = standing_at(&logged.scene, time, &Pose::identity(), &logged.rules);
    let shown = standing.into_iter().map(|standing| {
        let track = &tracks[usize::from(standing.track.0) - 1];
        let class =
            track.class().map(|class| (names[class.index()].clone(), palette.color(class.0)));
        ShownBox {
            id: track.source_id.clone(),
            category: track.category.clone(),
            track: track.id.0,
            class,
            boxed: standing.boxed,
        }
    });
    shown.collect()
}
