//! The drive through a world, as a reader would give it had it been logged.

use nalgebra::Point3;
use occlabel_core::{
    BoxTrack, Exposure, Fault, Keyframe, LIDAR_ORIGIN, Meaning, PointCloud, PointLabel, Scene,
    SweepHeader, Taxonomy, Timestamp, TrackId,
};

use crate::check::{each, need};
use crate::lidar::{Lidar, Return};
use crate::{Instant, What, World};

/// A keyframe has the exposures that are this near in time (labels.md section 2), seconds.
const EXPOSURE_WITHIN_S: f64 = 0.1;

/// A drive through a world, bound to a taxonomy.
///
/// Every sweep's points are labelled, and every mover has a true box at every keyframe: what a
/// perfect annotator would give.
#[derive(Clone, Debug)]
pub struct Drive {
    world: World,
    scene: Scene,
    sweeps: Vec<SweepKey>,
    labels: Labels,
}

/// Which lidar took a sweep, and the how many-th of its sweeps it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct SweepKey {
    time: Timestamp,
    lidar: usize,
    number: usize,
}

/// What the labels of the world's parts mean.
#[derive(Clone, Debug)]
struct Labels {
    ground: Vec<PointLabel>,
    statics: Vec<PointLabel>,
    movers: Vec<PointLabel>,
    ego: PointLabel,
}

impl Drive {
    /// Drives through a world.
    ///
    /// # Errors
    /// If the taxonomy does not know one of the world's raw names, or `keyframe_hz` is no whole
    /// part of the reference lidar's rate: the fault's place is the key.
    pub fn new(world: World, taxonomy: &Taxonomy) -> Result<Self, Fault> {
        let labels = Labels::new(&world, taxonomy)?;
        let sweeps = sweep_keys(&world);
        let keyframes = keyframes(&world, &sweeps)?;
        let scene = Scene {
            name: world.name.clone(),
            sweeps: sweeps.iter().map(|key| header(&world, key)).collect(),
            tracks: tracks(&world, taxonomy, &keyframes)?,
            cameras: world.cameras.iter().map(|camera| camera.named.clone()).collect(),
            keyframes,
            ..Scene::default()
        };
        Ok(Self { world, scene, sweeps, labels })
    }

    /// The world that is driven through.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// Everything of the drive but its points.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The returns of a sweep of the scene as its lidar measured them.
    pub fn returns(&self, sweep: usize) -> Vec<Return> {
        self.lidar(sweep).sweep(&self.world, self.sweeps[sweep].number)
    }

    /// The points of a sweep of the scene in its lidar's frame at the sweep's time.
    ///
    /// Points of a rolling sweep are moved there from where the lidar was at their own time, and so
    /// are their rays' origins.
    pub fn points(&self, sweep: usize) -> PointCloud<PointLabel> {
        let (lidar, key) = (self.lidar(sweep), self.sweeps[sweep]);
        let sweep_from_world = lidar.world_from_lidar(&self.world, key.time).inverse();
        let mut cloud = PointCloud::with_origins(Vec::new());
        for shots in self.returns(sweep).chunk_by(|a, b| a.time == b.time) {
            let now_from_then = if shots[0].time == key.time {
                nalgebra::one()
            } else {
                sweep_from_world * lidar.world_from_lidar(&self.world, shots[0].time)
            };
            cloud.origins.push(now_from_then * LIDAR_ORIGIN);
            let origin = (cloud.origins.len() - 1) as u32;
            for found in shots {
                let position: Point3<f64> = now_from_then * found.position_m;
                cloud.push(position, self.labels.of(found.hit.what), origin);
            }
        }
        cloud
    }

    /// The number of a sweep of the scene, by its time and lidar.
    pub fn sweep_number(&self, header: &SweepHeader) -> Option<usize> {
        let known =
            |sweep: &SweepHeader| (sweep.time, &sweep.lidar).cmp(&(header.time, &header.lidar));
        self.scene.sweeps.binary_search_by(known).ok()
    }

    /// The scene's keyframe of that token. Every log of the drive names its keyframes so that the
    /// token ends in their time in nanoseconds.
    pub fn keyframe(&self, token: &str) -> Option<&Keyframe> {
        let digits =
            token.rfind(|c: char| !c.is_ascii_digit()).map_or(token, |at| &token[at + 1..]);
        let time = Timestamp(digits.parse().ok()?);
        self.scene.keyframes.iter().find(|keyframe| keyframe.time == time)
    }

    /// When a mover stands where its annotated box says, for a keyframe: seconds.
    pub fn mover_time_s(&self, keyframe: &Keyframe, _mover: usize) -> f64 {
        keyframe.time.seconds_since(Timestamp(0))
    }

    /// The true world of a keyframe: the ego at its time, each mover at [`Self::mover_time_s`].
    pub fn instant(&self, keyframe: &Keyframe) -> Instant<'_> {
        let time_s = keyframe.time.seconds_since(Timestamp(0));
        Instant::new(&self.world, time_s, |mover| self.mover_time_s(keyframe, mover))
    }

    /// What a return from a part of the world is labelled.
    pub fn label_of(&self, what: What) -> PointLabel {
        self.labels.of(what)
    }

    /// The lidar of a sweep of the scene, and the how many-th of its sweeps it is.
    pub(crate) fn taken_by(&self, sweep: usize) -> (&Lidar, usize) {
        (self.lidar(sweep), self.sweeps[sweep].number)
    }

    fn lidar(&self, sweep: usize) -> &Lidar {
        &self.world.lidars[self.sweeps[sweep].lidar]
    }
}

impl Labels {
    fn new(world: &World, taxonomy: &Taxonomy) -> Result<Self, Fault> {
        let label = |key: &str, raw: &str| match taxonomy.points.get(raw) {
            Some(Meaning::Class(class)) => Ok(PointLabel::Class(*class)),
            Some(Meaning::Ignore) => Ok(PointLabel::Ignored),
            None => Err(unknown(key, "a point label of the taxonomy", raw)),
        };
        Ok(Self {
            ground: each("ground.bands", &world.ground.bands, |band| label("class", &band.class))?,
            statics: each("static", &world.static_classes, |class| label("class", class))?,
            movers: world
                .movers
                .iter()
                .map(|mover| label(&format!("mover {}.category", mover.name), &mover.category))
                .collect::<Result<_, Fault>>()?,
            ego: match &world.ego.body {
                Some(body) => label("ego.body.class", &body.class)?,
                None => PointLabel::Ignored,
            },
        })
    }

    fn of(&self, what: What) -> PointLabel {
        match what {
            What::Ground(at) => self.ground[at],
            What::Static(at) => self.statics[at],
            What::Mover(at) => self.movers[at],
            What::Ego => self.ego,
        }
    }
}

fn unknown(key: &str, expected: &str, raw: &str) -> Fault {
    Fault::new("world", key, expected, format!("`{raw}`"))
}

/// Every sweep of the drive, ordered by (time, lidar).
fn sweep_keys(world: &World) -> Vec<SweepKey> {
    let of_lidar = |(lidar, sensor): (usize, &Lidar)| {
        let ticks = sensor.clock.ticks(world.duration_s).enumerate();
        ticks.map(move |(number, time)| SweepKey { time, lidar, number })
    };
    let mut keys: Vec<_> = world.lidars.iter().enumerate().flat_map(of_lidar).collect();
    keys.sort();
    keys
}

fn header(world: &World, key: &SweepKey) -> SweepHeader {
    let lidar = &world.lidars[key.lidar];
    let source_id = format!("{}-{:06}", lidar.name, key.number);
    SweepHeader {
        time: key.time,
        lidar: lidar.name.clone(),
        file: source_id.clone(),
        source_id,
        world_from_ego: world.world_from_ego(key.time.seconds_since(Timestamp(0))),
        ego_from_lidar: lidar.ego_from_lidar,
        labelled: true,
    }
}

/// The lidar that keyframes refer to (labels.md section 2).
fn reference_lidar(world: &World) -> usize {
    let named = |name: &str| world.lidars.iter().position(|lidar| lidar.name == name);
    named("LIDAR_TOP").or_else(|| named("TOP")).unwrap_or(0)
}

/// Every so many-th sweep of the reference lidar, with the exposures nearest to it.
fn keyframes(world: &World, sweeps: &[SweepKey]) -> Result<Vec<Keyframe>, Fault> {
    let reference = reference_lidar(world);
    let rate_hz = world.lidars[reference].clock.rate_hz();
    let stride = (rate_hz / world.keyframe_hz).round();
    let whole = stride >= 1.0 && (stride * world.keyframe_hz / rate_hz - 1.0).abs() < 1e-6;
    let expected = format!("a whole part of the reference lidar's {rate_hz} Hz");
    need("keyframe_hz", whole, &expected, world.keyframe_hz)?;
    let is_key =
        |key: &SweepKey| key.lidar == reference && key.number.is_multiple_of(stride as usize);
    let exposures = exposure_times(world);
    let keyframe = |(sweep, key): (usize, &SweepKey)| Keyframe {
        token: key.time.0.to_string(),
        time: key.time,
        sweep,
        exposures: exposures_near(world, &exposures, key.time),
    };
    Ok(sweeps.iter().enumerate().filter(|(_, key)| is_key(key)).map(keyframe).collect())
}

fn exposure_times(world: &World) -> Vec<Vec<Timestamp>> {
    world.cameras.iter().map(|camera| camera.clock.ticks(world.duration_s).collect()).collect()
}

/// Of each camera the exposure nearest to a time, the earlier on ties, if it is near enough.
fn exposures_near(world: &World, times: &[Vec<Timestamp>], time: Timestamp) -> Vec<Exposure> {
    let of_camera = |(camera, times): (usize, &Vec<Timestamp>)| {
        let next = times.partition_point(|known| *known < time);
        let around = &times[next.saturating_sub(1)..times.len().min(next + 1)];
        let nearest = *around
            .iter()
            .min_by(|a, b| a.seconds_apart(time).total_cmp(&b.seconds_apart(time)))?;
        let seconds = nearest.seconds_since(Timestamp(0));
        let world_from_camera =
            world.world_from_ego(seconds) * world.cameras[camera].ego_from_camera;
        (nearest.seconds_apart(time) <= EXPOSURE_WITHIN_S).then_some(Exposure {
            camera,
            time: nearest,
            world_from_camera,
        })
    };
    times.iter().enumerate().filter_map(of_camera).collect()
}

/// Every mover's true boxes at the keyframes.
fn tracks(
    world: &World,
    taxonomy: &Taxonomy,
    keyframes: &[Keyframe],
) -> Result<Vec<BoxTrack>, Fault> {
    let track = |(at, mover): (usize, &crate::Mover)| {
        let key = format!("mover {}.category", mover.name);
        let meaning = taxonomy.boxes.get(&mover.category).copied();
        let box_at =
            |time: Timestamp| mover.box_at(time.seconds_since(Timestamp(0)), &world.ground);
        Ok(BoxTrack {
            id: TrackId(at as u16 + 1),
            source_id: mover.name.clone(),
            category: mover.category.clone(),
            meaning: meaning
                .ok_or_else(|| unknown(&key, "a box category of the taxonomy", &mover.category))?,
            boxes: keyframes.iter().map(|key| (key.time, box_at(key.time))).collect(),
        })
    };
    world.movers.iter().enumerate().map(track).collect()
}
