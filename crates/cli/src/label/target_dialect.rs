//! A label set in another dialect than our own.

use std::collections::BTreeMap;

use occlabel_core::{
    AggregatedScene, ClassId, Fault, Keyframe, OccupancyLabels, Scene, Taxonomy, VoxelGrid,
};
use occlabel_dialects::{Class, ClassMap, ClassTable, Dialect, Encoded, Holds, KeyframeLabels};
use occlabel_labels::NumberArray;
use occlabel_pipeline::{Rules, own_points, own_view};

use crate::label::targets::frame_name;

/// What a keyframe is labelled from.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) aggregated: &'a AggregatedScene<ClassId>,
    pub(crate) keyframe: &'a Keyframe,
    pub(crate) rules: &'a Rules,
}

/// A dialect to write, and what our classes become in it.
pub(crate) struct TargetDialect {
    pub(crate) dialect: Dialect,
    map: ClassMap,
    /// Our own free id.
    free: u8,
}

impl TargetDialect {
    pub(crate) fn new(dialect: Dialect, taxonomy: &Taxonomy) -> Result<Self, Fault> {
        let map = ClassMap::between(&class_table(taxonomy), &dialect.classes, &[])?;
        Ok(Self { dialect, map, free: taxonomy.free })
    }

    /// Whether it says what only evidence knows.
    pub(crate) fn needs_evidence(&self) -> bool {
        self.dialect.can_say(&Holds::Instances) || self.dialect.can_say(&Holds::Flow)
    }

    /// What the files do not say as our labels do.
    pub(crate) fn notes(&self, rules: &Rules) -> Result<Vec<String>, Fault> {
        let spec = &rules.spec;
        let mask = || Some(VoxelGrid::filled(spec, 0));
        let free = VoxelGrid::filled(spec, self.dialect.classes.free_index());
        let labels = KeyframeLabels {
            mask_lidar: mask(),
            mask_camera: mask(),
            instances: self.needs_evidence().then(|| VoxelGrid::filled(spec, 0)),
            flow: self.needs_evidence().then(|| VoxelGrid::filled(spec, [0.0; 3])),
            extras: self.extras_like(
                |_| NumberArray::new(&spec.shape(), &vec![0_u8; spec.len()]),
                || NumberArray::new(&[4, 4], &[0.0_f64; 16]),
            ),
            ..KeyframeLabels::of_semantics(spec.clone(), free)
        };
        let encoded = self.dialect.encode(&labels, "scene", "token")?;
        let remarks = self.map.remarks().iter().map(ToString::to_string);
        let mut notes: Vec<String> =
            remarks.chain(encoded.notes.iter().map(ToString::to_string)).collect();
        if !self.dialect.can_say(&Holds::MaskLidar) {
            notes.push("unobserved: what nobody observed is free here".to_owned());
        }
        if self.dialect.can_say(&Holds::Flow) {
            notes.push("flow: not a number where an object's next box is not known".to_owned());
        }
        let frame = frame_name(rules.frame);
        notes.extend(self.dialect.grid_notes(frame, spec));
        Ok(notes)
    }

    /// The files of a keyframe.
    pub(crate) fn encode(
        &self,
        source: &Source,
        labels: &OccupancyLabels,
    ) -> Result<Encoded, Fault> {
        let labels = self.labels(source, labels);
        self.dialect.encode(&labels, &source.scene.name, &source.keyframe.token)
    }

    fn labels(&self, source: &Source, labels: &OccupancyLabels) -> KeyframeLabels {
        let free = self.dialect.classes.free_index();
        let table = self.map.table();
        let index = |id: &u8| if *id == self.free { free } else { table[usize::from(*id)] };
        let evidence = labels.evidence.as_ref().filter(|_| self.needs_evidence());
        KeyframeLabels {
            mask_lidar: Some(labels.mask_lidar.clone()),
            mask_camera: Some(labels.mask_camera.clone()),
            instances: evidence.map(|evidence| evidence.instances.clone()),
            flow: evidence.map(|evidence| evidence.flow.clone()),
            extras: self.extras(source, &labels.mask_camera),
            ..KeyframeLabels::of_semantics(source.rules.spec.clone(), labels.semantics.map(index))
        }
    }

    /// What only some dialects know, as far as we do. What a camera sees it has in view, be it by an edge.
    fn extras(&self, source: &Source, seen: &VoxelGrid<u8>) -> BTreeMap<String, NumberArray> {
        let Source { scene, aggregated, keyframe, rules } = *source;
        let voxels = |name: &str| {
            let grid = match name {
                INFOV => own_view(scene, keyframe, rules).zip_map(seen, |view, seen| view | seen),
                _ => own_points(scene, aggregated, keyframe, rules),
            };
            NumberArray::new(&grid.shape(), grid.values())
        };
        let pose = || {
            let pose = scene.reference_sweep(keyframe).world_from_ego.to_homogeneous();
            NumberArray::new(&[4, 4], pose.transpose().as_slice())
        };
        self.extras_like(voxels, pose)
    }

    fn extras_like(
        &self,
        voxels: impl Fn(&str) -> NumberArray,
        pose: impl Fn() -> NumberArray,
    ) -> BTreeMap<String, NumberArray> {
        let is_asked = |name: &&str| self.dialect.can_say(&Holds::Extra((*name).to_owned()));
        let of_voxels = [INFOV, INPUT].into_iter().filter(is_asked);
        let of_voxels = of_voxels.map(|name| (name.to_owned(), voxels(name)));
        let of_pose = POSES.into_iter().filter(is_asked).map(|name| (name.to_owned(), pose()));
        of_voxels.chain(of_pose).collect()
    }
}

/// Extras that we know: in view of a camera, hit by the keyframe's own sweep, the ego's pose.
const INFOV: &str = "infov";
const INPUT: &str = "input";
const POSES: [&str; 2] = ["ego2global", "ego_to_world_transformation"];

/// The classes of a taxonomy.
fn class_table(taxonomy: &Taxonomy) -> ClassTable {
    let class = |(id, name): (usize, &String)| Class {
        id: id as u16,
        name: name.clone(),
        ..Class::default()
    };
    ClassTable {
        free: u16::from(taxonomy.free),
        no_label: None,
        list: taxonomy.names.iter().enumerate().map(class).collect(),
    }
}
