//! Section 8 of labels.md in plain loops, one ray after the other.

use nalgebra::Point3;
use occlabel_core::{
    ClassId, GridSpec, Instant, Level, PlacedObject, RayCounts, RigidMap, Timestamp, VoxelGrid,
    VoxelIndex, traverse,
};
use occlabel_pipeline::Rules;
use occlabel_raycast::{ObjectRays, Outside, RayRules};

/// In the grid of both presets: 200 x 200 x 16.
const VOXELS: u64 = 640_000;

/// What was compared, and what was in it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) keyframes: u64,
    /// Voxels, at every level and by every kernel.
    pub(crate) compared: u64,
    pub(crate) hits: u64,
    pub(crate) crossings: u64,
    /// Crossings that a near rule forbids.
    pub(crate) too_near: u64,
    /// Crossings in the boxes of tracks, at another time.
    pub(crate) forgotten: u64,
    /// Rays of the points of tracks, whole or in parts.
    pub(crate) of_tracks: u64,
}

impl Tally {
    /// That so many keyframes were compared, each voxel by each kernel at each level, and that every
    /// rule had something to say.
    pub(crate) fn assert_of(&self, keyframes: u64) {
        let kernels = 2 * Level::all().len() as u64;
        assert_eq!(self.keyframes, keyframes);
        assert_eq!(self.compared, keyframes * kernels * VOXELS);
        assert!(self.hits > 200_000, "{} hits", self.hits);
        assert!(self.crossings > 7_000_000, "{} crossings", self.crossings);
        assert!(self.too_near > 1_000_000, "{} too near", self.too_near);
        assert!(self.forgotten > 20_000, "{} forgotten", self.forgotten);
        assert!(self.of_tracks > 20_000, "{} rays of tracks", self.of_tracks);
    }
}

/// Counts the rays of an instant.
pub(crate) struct Oracle<'a> {
    spec: &'a GridSpec,
    rules: RayRules<'a>,
    instant: &'a Instant<'a>,
    /// Whether a voxel's centre lies in the box of a track that stands.
    in_boxes: Vec<bool>,
    counts: RayCounts,
    tally: &'a mut Tally,
}

/// A way to walk, and the ray that it is of. Grid frame.
struct Way {
    from: Point3<f64>,
    to: Point3<f64>,
    point: Point3<f64>,
    origin: Point3<f64>,
    class: ClassId,
    /// When its air was seen; `None` where it moves with a track.
    air: Option<Timestamp>,
}

impl<'a> Oracle<'a> {
    pub(crate) fn count(instant: &Instant, rules: &Rules, tally: &mut Tally) -> RayCounts {
        let spec = &rules.spec;
        let (hits, crossings) = (VoxelGrid::filled(spec, 0), VoxelGrid::filled(spec, 0));
        let counts = RayCounts { hits, crossings };
        let in_boxes = in_boxes(instant, spec);
        let mut oracle = Oracle { spec, rules: rules.rays(), instant, in_boxes, counts, tally };
        oracle.background();
        instant.objects.iter().for_each(|placed| oracle.object(placed));
        oracle.counts
    }

    fn background(&mut self) {
        let place = RigidMap::from(&self.instant.grid_from_world);
        for sweep in &self.instant.background {
            for (i, position) in sweep.cloud.positions.iter().enumerate() {
                let (point, origin) = (place.apply(position), place.apply(&sweep.cloud.origin(i)));
                let way = whole(point, origin, sweep.cloud.labels[i]);
                self.hit(&point);
                self.cross(&Way { air: sweep.time, ..way });
            }
        }
    }

    fn object(&mut self, placed: &PlacedObject) {
        let now = placed.grid_from_box.as_ref().map(RigidMap::from);
        let cloud = &placed.object.cloud;
        for (i, position) in cloud.positions.iter().enumerate() {
            let (origin, class) = (cloud.origin(i), cloud.labels[i]);
            self.tally.of_tracks += 1;
            match (self.rules.settings.object_rays, &now) {
                (ObjectRays::Own, now) => {
                    self.object_part(placed, now.as_ref(), position, &origin, class);
                    self.world_part(placed, position, &origin, class);
                }
                (_, None) => {}
                (ObjectRays::Current, Some(now)) => {
                    let point = now.apply(position);
                    self.hit(&point);
                    self.cross(&whole(point, self.instant.reference_lidar, class));
                }
                (ObjectRays::Hits, Some(now)) => self.hit(&now.apply(position)),
            }
        }
    }

    /// From the entry into its box to the point, where the track stands now.
    fn object_part(
        &mut self,
        placed: &PlacedObject,
        now: Option<&RigidMap>,
        position: &Point3<f64>,
        origin: &Point3<f64>,
        class: ClassId,
    ) {
        let Some(now) = now else { return };
        let entry = now.apply(&placed.seen.entry(origin, position));
        let (point, origin) = (now.apply(position), now.apply(origin));
        self.hit(&point);
        self.cross(&Way { to: entry, ..whole(point, origin, class) });
    }

    /// From the origin to the entry, where the sweep saw it.
    fn world_part(
        &mut self,
        placed: &PlacedObject,
        position: &Point3<f64>,
        origin: &Point3<f64>,
        class: ClassId,
    ) {
        if placed.seen.contains(origin) {
            return;
        }
        let then = RigidMap::from(&placed.grid_from_seen_box);
        let entry = then.apply(&placed.seen.entry(origin, position));
        let way = whole(then.apply(position), then.apply(origin), class);
        self.cross(&Way { from: entry, air: placed.object.time, ..way });
    }

    fn hit(&mut self, point: &Point3<f64>) {
        if let Some(flat) = self.spec.flat(self.voxel(point)) {
            self.counts.hits.values_mut()[flat] += 1;
            self.tally.hits += 1;
        }
    }

    fn cross(&mut self, way: &Way) {
        let is_inside = self.spec.flat(self.voxel(&way.point)).is_some();
        if self.rules.settings.outside == Outside::Drop && !is_inside {
            return;
        }
        for voxel in traverse(self.spec.snap(&way.from), self.spec.snap(&way.to)) {
            let Some(flat) = self.spec.flat(voxel) else { continue };
            if self.is_too_near(voxel, way) {
                self.tally.too_near += 1;
            } else if self.in_boxes[flat] && self.is_of_another_time(way) {
                self.tally.forgotten += 1;
            } else {
                self.counts.crossings.values_mut()[flat] += 1;
                self.tally.crossings += 1;
            }
        }
    }

    fn is_too_near(&self, voxel: VoxelIndex, way: &Way) -> bool {
        let RayRules { settings, flat } = self.rules;
        let (point, origin) = (self.voxel(&way.point), self.voxel(&way.origin));
        let is_within =
            |limit_m: f64, end| limit_m > 0.0 && self.l1_m(voxel, end) <= limit_m + 1e-9;
        let dz_m = (voxel.0[2] - point.0[2]).abs() as f64 * self.spec.size_m().z;
        is_within(settings.ignore_near_hit_m, point)
            || is_within(settings.ignore_near_origin_m, origin)
            || flat.contains(way.class) && dz_m < settings.flat_ignore_dz_m - 1e-9
    }

    fn is_of_another_time(&self, way: &Way) -> bool {
        let settings = self.rules.settings;
        let is_far = |air: Timestamp| air.seconds_apart(self.instant.time) > settings.same_time_s;
        settings.object_rays == ObjectRays::Own && way.air.is_some_and(is_far)
    }

    fn voxel(&self, point: &Point3<f64>) -> VoxelIndex {
        self.spec.snap(point).voxel()
    }

    fn l1_m(&self, a: VoxelIndex, b: VoxelIndex) -> f64 {
        let size_m = self.spec.size_m();
        (0..3).map(|axis| (a.0[axis] - b.0[axis]).abs() as f64 * size_m[axis]).sum()
    }
}

fn whole(point: Point3<f64>, origin: Point3<f64>, class: ClassId) -> Way {
    Way { from: point, to: origin, point, origin, class, air: None }
}

fn in_boxes(instant: &Instant, spec: &GridSpec) -> Vec<bool> {
    let boxes: Vec<_> = (instant.standing.iter())
        .map(|stands| (stands.grid_from_box.inverse(), &stands.grown))
        .collect();
    let is_in_one = |voxel| {
        let centre = spec.centre(voxel);
        boxes.iter().any(|(box_from_grid, grown)| grown.contains(&(box_from_grid * centre)))
    };
    spec.voxels().map(is_in_one).collect()
}
