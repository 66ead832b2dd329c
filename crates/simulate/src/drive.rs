//! The drive through a world, as a reader would give it had it been logged.

use nalgebra::Point3;
use occlabel_core::{
    ClassId, ClassSet, Exposure, Fault, Keyframe, LIDAR_ORIGIN, PointCloud, PointLabel, PointsOf,
    Pose, Scene, SweepHeader, Taxonomy, Timestamp, TrackId,
};

use crate::annotator::{Boxes, LabelledSweeps, LoggedPoses, Sightings};
use crate::check::in_file;
use crate::labels::Labels;
use crate::lidar::{Lidar, Return};
use crate::schedule::{
    SweepKey, exposure, exposure_times, keyframe_keys, nearest_exposures, sweep_keys,
};
use crate::{Instant, What, World};

/// A drive through a world, bound to a taxonomy.
///
/// [`Self::scene`] and [`Self::points`] are what the log says, with all that the world's annotator
/// gets wrong; [`Self::world`], [`Self::instant`] and [`Self::label_of`] are the truth.
#[derive(Clone, Debug)]
pub struct Drive {
    world: World,
    scene: Scene,
    sweeps: Vec<SweepKey>,
    labels: Labels,
    deformable: ClassSet,
    poses: LoggedPoses,
    sightings: Sightings,
    /// Of each mover, in the order of the world's.
    tracks: Vec<Option<TrackId>>,
}

impl Drive {
    /// Drives through a world.
    ///
    /// # Errors
    /// If the taxonomy does not know one of the world's raw names, or `keyframe_hz` is no whole
    /// part of the reference lidar's rate: the fault's record is the key.
    pub fn new(world: World, taxonomy: &Taxonomy) -> Result<Self, Fault> {
        let place = world.place.clone();
        Self::through(world, taxonomy).map_err(|fault| in_file(&place, fault))
    }

    fn through(world: World, taxonomy: &Taxonomy) -> Result<Self, Fault> {
        let labels = Labels::new(&world, taxonomy)?;
        let sweeps = sweep_keys(&world);
        let keyframes = keyframe_keys(&world, &sweeps)?;
        let poses = LoggedPoses::new(&world);
        let sightings = Sightings::new(&world, &keyframes);
        let boxes =
            Boxes { world: &world, poses: &poses, sightings: &sightings, keyframes: &keyframes };
        let scene = Scene {
            name: world.name.clone(),
            sweeps: headers(&world, &poses, &sweeps, &keyframes),
            tracks: boxes.tracks(taxonomy)?,
            cameras: world.cameras.iter().map(|camera| camera.named.clone()).collect(),
            keyframes: logged_keyframes(&world, &poses, &sweeps, &keyframes),
            ..Scene::default()
        };
        let tracks = world.movers.iter().map(|mover| track_named(&scene, &mover.name)).collect();
        let deformable = taxonomy.deformable;
        Ok(Self { world, scene, sweeps, labels, deformable, poses, sightings, tracks })
    }

    /// The world that is driven through.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// Everything of the drive but its points, as logged.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Poses as logged, at any time.
    pub fn poses(&self) -> &LoggedPoses {
        &self.poses
    }

    /// The returns of a sweep of the scene as its lidar measured them.
    pub fn returns(&self, sweep: usize) -> Vec<Return> {
        self.lidar(sweep).sweep(&self.world, self.sweeps[sweep].number)
    }

    /// The points of a sweep of the scene in its lidar's frame at the sweep's time, one for each of
    /// [`Self::returns`].
    ///
    /// Points of a rolling sweep and their rays' origins are moved there from where the lidar truly
    /// was at their own time, unless its `deskew` is off: then they are as measured. Boxes stand
    /// where movers truly were either way.
    pub fn points(&self, sweep: usize) -> PointCloud<PointLabel> {
        self.points_of(sweep, &self.returns(sweep))
    }

    /// The points of a sweep whose returns are known already.
    pub(crate) fn points_of(&self, sweep: usize, returns: &[Return]) -> PointCloud<PointLabel> {
        let lidar = self.lidar(sweep);
        let together = |a: &Return, b: &Return| a.time == b.time || !lidar.deskew;
        let mut cloud = PointCloud::with_origins(Vec::new());
        for shots in returns.chunk_by(together) {
            let now_from_then = self.sweep_from_shot(sweep, shots[0].time).unwrap_or_default();
            cloud.origins.push(now_from_then * LIDAR_ORIGIN);
            let origin = (cloud.origins.len() - 1) as u32;
            for found in shots {
                let position: Point3<f64> = now_from_then * found.position_m;
                cloud.push(position, self.logged_label(sweep, found), origin);
            }
        }
        cloud
    }

    /// What moves points of a shot to where the lidar was as their sweep began; none if nothing does.
    pub(crate) fn sweep_from_shot(&self, sweep: usize, time: Timestamp) -> Option<Pose> {
        let (lidar, now) = (self.lidar(sweep), self.sweeps[sweep].time);
        let world_from_lidar = |time| lidar.world_from_lidar(&self.world, time);
        let moves = lidar.deskew && time != now;
        moves.then(|| world_from_lidar(now).inverse() * world_from_lidar(time))
    }

    /// All exposures of a camera, as logged.
    pub fn exposures(&self, camera: usize) -> Vec<Exposure> {
        let times = self.world.cameras[camera].clock.ticks(self.world.duration_s);
        times.map(|time| exposure(&self.world, &self.poses, camera, time)).collect()
    }

    /// The number of a sweep of the scene, by its time and lidar.
    pub fn sweep_number(&self, header: &SweepHeader) -> Option<usize> {
        let known =
            |sweep: &SweepHeader| (sweep.time, &sweep.lidar).cmp(&(header.time, &header.lidar));
        self.scene.sweeps.binary_search_by(known).ok()
    }

    /// The keyframe that a log of the drive names so: any sweep of the reference lidar can be one.
    /// Tokens of keyframes and of sweeps end in their time in nanoseconds, in every format.
    pub fn keyframe(&self, token: &str) -> Option<Keyframe> {
        let time = Self::time_of(token)?;
        let lidar = &self.scene.reference_sweep(self.scene.keyframes.first()?).lidar;
        let is_it = |sweep: &SweepHeader| sweep.time == time && sweep.lidar == *lidar;
        let key = self.sweeps[self.scene.sweeps.iter().position(is_it)?];
        logged_keyframes(&self.world, &self.poses, &self.sweeps, &[key]).pop()
    }

    /// The time that a token of a keyframe or a sweep ends in.
    pub fn time_of(token: &str) -> Option<Timestamp> {
        let digits =
            token.rfind(|c: char| !c.is_ascii_digit()).map_or(token, |at| &token[at + 1..]);
        digits.parse().ok().map(Timestamp)
    }

    /// When a mover stands where an annotator without jitter draws its box at a keyframe: seconds.
    ///
    /// At a sweep between annotated keyframes, where a box drawn straight between theirs stands.
    pub fn mover_time_s(&self, keyframe: &Keyframe, mover: usize) -> f64 {
        self.sightings.box_time(keyframe.time, mover).seconds_since(Timestamp(0))
    }

    /// The true world of a keyframe: the ego at its time, each mover at [`Self::mover_time_s`].
    pub fn instant(&self, keyframe: &Keyframe) -> Instant<'_> {
        let time_s = keyframe.time.seconds_since(Timestamp(0));
        Instant::new(&self.world, time_s, |mover| self.mover_time_s(keyframe, mover))
    }

    /// Where the camera of an exposure truly stood; the scene's own pose may have drifted.
    pub fn world_from_camera(&self, exposure: &Exposure) -> Pose {
        let time_s = exposure.time.seconds_since(Timestamp(0));
        self.world.world_from_ego(time_s) * self.world.cameras[exposure.camera].ego_from_camera
    }

    /// A sweep of the scene with its true poses.
    pub fn true_header(&self, sweep: &SweepHeader) -> SweepHeader {
        let time_s = sweep.time.seconds_since(Timestamp(0));
        let mounting = self.world.lidars.iter().find(|lidar| lidar.name == sweep.lidar);
        SweepHeader {
            world_from_ego: self.world.world_from_ego(time_s),
            ego_from_lidar: mounting.map_or(sweep.ego_from_lidar, |lidar| lidar.ego_from_lidar),
            ..sweep.clone()
        }
    }

    /// The track that a mover of the world is in the scene; none if it has no box there.
    pub fn track_of(&self, mover: usize) -> Option<TrackId> {
        self.tracks[mover]
    }

    /// What a part of the world truly is.
    pub fn label_of(&self, what: What) -> PointLabel {
        self.labels.of(what)
    }

    /// The true class of a part of the world; none if its label is ignored.
    pub(crate) fn class_of(&self, what: What) -> Option<ClassId> {
        match self.label_of(what) {
            PointLabel::Class(class) => Some(class),
            PointLabel::Unlabelled | PointLabel::Ignored => None,
        }
    }

    /// The raw label of a point of a part of the world that is logged with a label; none if it is
    /// unlabelled.
    pub fn raw_label(&self, what: What, logged: PointLabel) -> Option<&str> {
        match logged {
            PointLabel::Unlabelled => None,
            PointLabel::Class(class) if logged != self.label_of(what) => {
                self.labels.raw_name(class)
            }
            PointLabel::Class(_) | PointLabel::Ignored => Some(self.world.class_of(what)),
        }
    }

    /// The lidar of a sweep of the scene, and the how many-th of its sweeps it is.
    pub(crate) fn taken_by(&self, sweep: usize) -> (&Lidar, usize) {
        (self.lidar(sweep), self.sweeps[sweep].number)
    }

    /// Whether a mover's class is one whose shape changes.
    pub(crate) fn is_deformable(&self, mover: usize) -> bool {
        self.class_of(What::Mover(mover)).is_some_and(|class| self.deformable.contains(class))
    }

    pub(crate) fn colour(&self, class: ClassId) -> [u8; 3] {
        self.labels.colour(class)
    }

    fn lidar(&self, sweep: usize) -> &Lidar {
        &self.world.lidars[self.sweeps[sweep].lidar]
    }

    /// A return's label as the annotator gives it.
    fn logged_label(&self, sweep: usize, found: &Return) -> PointLabel {
        match self.labels.of(found.hit.what) {
            _ if !self.scene.sweeps[sweep].labelled => PointLabel::Unlabelled,
            PointLabel::Class(class) => PointLabel::Class(self.logged_class(sweep, found, class)),
            label => label,
        }
    }

    fn logged_class(&self, sweep: usize, found: &Return, class: ClassId) -> ClassId {
        let share = self.world.annotator.mislabelled_points;
        if share == 0.0 {
            return class;
        }
        let chance = self.lidar(sweep).chance(&self.world, self.sweeps[sweep].number, found);
        let mistaken = chance.uniform(3) < share;
        if mistaken { self.labels.mistaken_for(class, chance.uniform(4)) } else { class }
    }
}

fn headers(
    world: &World,
    poses: &LoggedPoses,
    sweeps: &[SweepKey],
    keyframes: &[SweepKey],
) -> Vec<SweepHeader> {
    let header = |key: &SweepKey| {
        let name = &world.lidars[key.lidar].name;
        let source_id = format!("{name}-{:06}", key.number);
        SweepHeader {
            time: key.time,
            lidar: name.clone(),
            file: source_id.clone(),
            source_id,
            world_from_ego: poses.world_from_ego(world, key.time),
            ego_from_lidar: poses.ego_from_lidar[key.lidar],
            labelled: match world.annotator.point_labels {
                LabelledSweeps::Keyframes => keyframes.binary_search(key).is_ok(),
                LabelledSweeps::All => true,
                LabelledSweeps::None => false,
            },
            points_of: PointsOf::Moment,
        }
    };
    sweeps.iter().map(header).collect()
}

fn logged_keyframes(
    world: &World,
    poses: &LoggedPoses,
    sweeps: &[SweepKey],
    keyframes: &[SweepKey],
) -> Vec<Keyframe> {
    let times = exposure_times(world);
    let keyframe = |key: &SweepKey| Keyframe {
        token: key.time.0.to_string(),
        time: key.time,
        sweep: sweeps.partition_point(|sweep| sweep < key),
        exposures: nearest_exposures(&times, key.time)
            .map(|(camera, time)| exposure(world, poses, camera, time))
            .collect(),
    };
    keyframes.iter().map(keyframe).collect()
}

fn track_named(scene: &Scene, name: &str) -> Option<TrackId> {
    let at = scene.tracks.binary_search_by(|track| track.source_id.as_str().cmp(name)).ok()?;
    Some(scene.tracks[at].id)
}
