//! The configuration: every key of labels.md section 14, under its name there.

use occlabel_annotate::{BoxSettings, GhostClasses, PaintSettings};
use occlabel_core::{
    CloudSettings, Fault, GridSpec, KeyframeSettings, MaskClasses, McapSettings, Taxonomy,
};
use occlabel_occlusion::OcclusionSettings;
use occlabel_raycast::{RaySettings, StateSettings};
use occlabel_voxelize::VoteSettings;
use serde::{Deserialize, Serialize};

use crate::{check, layers};

/// All that decides a label.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// Which moments get a grid.
    pub keyframes: KeyframeSettings,
    /// Where the grid stands.
    pub grid: GridTable,
    /// How boxes are carried between annotations.
    pub boxes: BoxSettings,
    /// How sweeps are sorted and summed.
    pub aggregate: AggregateTable,
    /// How masks of images give points a class.
    pub paint: PaintTable,
    /// How unlabelled points get a class.
    pub relabel: RelabelTable,
    /// How a voxel gets its class.
    pub voxelize: VoteSettings,
    /// Which crossings count.
    pub raycast: RaySettings,
    /// How counts are judged.
    pub states: StateSettings,
    /// Whose surface is known.
    pub meshes: MeshTable,
    /// What cameras see.
    pub occlusion: OcclusionSettings,
    /// What the classes are.
    pub taxonomy: TaxonomyTable,
    /// How to read what a format leaves open.
    #[serde(default, skip_serializing_if = "ReaderTables::say_nothing")]
    pub reader: ReaderTables,
}

/// The tables `[reader.*]`: how to read a log, not what a label means. They may be absent.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ReaderTables {
    /// Clouds of reconstructions.
    pub cloud: CloudSettings,
    /// MCAP logs.
    pub mcap: McapSettings,
}

impl ReaderTables {
    /// Whether everything is as it is without these tables.
    fn say_nothing(&self) -> bool {
        *self == Self::default()
    }
}

/// The `[grid]` table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GridTable {
    /// The frame in which the grid stands.
    pub frame: GridFrame,
    /// Lower corner, metres.
    pub min_m: [f64; 3],
    /// Upper corner, metres.
    pub max_m: [f64; 3],
    /// Voxel size, metres.
    pub voxel_size_m: VoxelSize,
}

/// A voxel's size: a cube's, or along x, y, z; metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "neither a number nor three")]
pub enum VoxelSize {
    /// The same along all axes.
    Cube(f64),
    /// One for each axis.
    Sides([f64; 3]),
}

/// The frame in which a keyframe's grid stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GridFrame {
    /// The reference sweep's ego frame (Occ3D).
    Ego,
    /// The reference sweep's lidar frame (SurroundOcc).
    Lidar,
}

/// The `[aggregate]` table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AggregateTable {
    /// The ego vehicle's body, ego frame.
    pub ego_box_m: EgoBox,
    /// Points farther from their lidar are dropped, metres.
    pub max_range_m: f64,
    /// Factor on the sides of boxes.
    pub box_scale: f64,
    /// Added to the faces of boxes, metres.
    pub box_margin_m: f64,
    /// Sweeps at most this far from a keyframe serve it, seconds.
    pub window_s: f64,
    /// The same for tracks whose shape changes, seconds.
    pub deformable_window_s: f64,
    /// Background points farther from a keyframe's pose do not serve it, metres, or `"none"`.
    pub radius_m: Limit,
}

/// The ego vehicle's body: `"auto"`, `"none"`, or `{ min, max }` in the ego frame, metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "neither \"auto\", \"none\" nor { min = [x, y, z], max = [x, y, z] }"
)]
pub enum EgoBox {
    /// By name.
    Word(EgoWord),
    /// By its corners.
    Corners {
        /// Lower corner.
        min: [f64; 3],
        /// Upper corner.
        max: [f64; 3],
    },
}

/// An ego body by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EgoWord {
    /// The reader's own.
    Auto,
    /// Nothing is dropped.
    None,
}

/// The `[paint]` table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PaintTable {
    /// The folder of class masks, below the log's root unless absolute; `"none"`, or `"auto"`: the
    /// folder `masks` of the log if there is one.
    pub masks: String,
    /// What their pixels mean.
    pub classes: MaskClasses,
    /// Pixels within so many of one of another class give no point a class.
    pub borders_px: u32,
    /// An exposure paints the sweeps that are at most so far from it in time, seconds.
    pub max_dt_s: f64,
    /// What is farther behind the nearest return of its pixel is hidden, metres.
    pub occlusion_m: f64,
    /// A return hides what is behind it in so many pixels to each side of its own.
    pub splat_px: u32,
}

impl PaintTable {
    /// The word for no masks.
    pub const NONE: &str = "none";

    /// How masks paint; `None` if there are none.
    pub(crate) fn settings(&self) -> Option<PaintSettings> {
        let Self { max_dt_s, occlusion_m, splat_px, .. } = *self;
        let settings = PaintSettings { max_dt_s, occlusion_m, splat_px };
        (self.masks != Self::NONE).then_some(settings)
    }
}

/// The `[relabel]` table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RelabelTable {
    /// How many neighbours vote.
    pub k: usize,
    /// How far a neighbour may be, metres, or `"none"`.
    pub max_distance_m: Limit,
    /// A class name, `"drop"`, or `"taxonomy"`.
    pub unknown_class: String,
    /// Which background points are dropped as left-overs.
    pub drop_ghosts: GhostClasses,
}

/// A limit, or none.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "neither a number nor \"none\"")]
pub enum Limit {
    /// At most this.
    AtMost(f64),
    /// Anything goes.
    Lifted(NoLimit),
}

/// The word for no limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NoLimit {
    /// Anything goes.
    None,
}

/// The `[meshes]` table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeshTable {
    /// `"none"`, `"auto"` (`meshes` below the log's root, if that is there), or a path from the root.
    pub folder: String,
    /// The frame of their vertices.
    pub frame: MeshFrame,
    /// The class of a mesh without a track: its name, or `"auto"`.
    pub class: String,
    /// Whether they are moved onto the points of their tracks.
    pub align: bool,
    /// Meshes with fewer points stay where they are.
    pub min_points: usize,
    /// Meshes whose points lie farther off in the mean are refused, metres.
    pub max_residual_m: f64,
    /// A point farther than this from a mesh has no say, metres.
    pub max_pair_m: f64,
    /// How far points lie off a right surface, metres.
    pub point_error_m: f64,
    /// How far meshes are off, metres.
    pub mesh_error_m: f64,
    /// The same of their attitude, radians.
    pub mesh_error_rad: f64,
}

/// The frame of meshes' vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MeshFrame {
    /// The log's world.
    World,
    /// The ego frame of the keyframe's reference sweep.
    Ego,
    /// The lidar frame of that sweep.
    Lidar,
}

/// The `[taxonomy]` table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TaxonomyTable {
    /// `"auto"`, a shipped taxonomy, or a path.
    pub file: String,
}

/// What a reader knows where the configuration says `"auto"`.
#[derive(Clone, Debug, PartialEq)]
pub struct Autos {
    /// The ego vehicle's body, ego frame, metres.
    pub ego_box_m: Option<([f64; 3], [f64; 3])>,
    /// The shipped taxonomy that fits the format.
    pub taxonomy: String,
    /// The lidar that keyframes refer to.
    pub reference_lidar: String,
}

impl Config {
    /// A configuration from the text of a file that states every key.
    ///
    /// # Errors
    /// If it is no TOML, a key is unknown or missing, or a value is impossible.
    pub fn parse(text: &str, place: &str) -> Result<Self, Fault> {
        Self::from_layers(place, text, None, &[])
    }

    /// A configuration from a base that states every key, a file that states some, and settings of
    /// single keys `table.key=VALUE`, each over the ones before.
    ///
    /// # Errors
    /// As for [`Config::parse`].
    pub fn from_layers(
        place: &str,
        base: &str,
        file: Option<&str>,
        settings: &[String],
    ) -> Result<Self, Fault> {
        let table = layers::merge(place, base, file, settings)?;
        let config: Self = serde_path_to_error::deserialize(table).map_err(|error| {
            let expected = "a value as `occlabel presets precise` shows";
            let (key, found) =
                (error.path().to_string(), error.inner().message().trim().to_owned());
            Fault::new("config", key, expected, found)
        })?;
        check::check(&config)?;
        Ok(config)
    }

    /// Puts what is meant in place of every `"auto"`.
    pub fn resolve(&mut self, autos: &Autos, taxonomy: &Taxonomy) {
        if self.keyframes.reference_lidar == "auto" {
            self.keyframes.reference_lidar.clone_from(&autos.reference_lidar);
        }
        if self.aggregate.ego_box_m == EgoBox::Word(EgoWord::Auto) {
            self.aggregate.ego_box_m = match autos.ego_box_m {
                Some((min, max)) => EgoBox::Corners { min, max },
                None => EgoBox::Word(EgoWord::None),
            };
        }
        if self.relabel.unknown_class == "taxonomy" {
            let name = taxonomy.unknown.map(|class| taxonomy.names[class.index()].clone());
            self.relabel.unknown_class = name.unwrap_or_else(|| "drop".into());
        }
        if self.meshes.class == "auto" {
            let name = taxonomy.first_of(&taxonomy.deformable);
            let name = name.map(|class| taxonomy.names[class.index()].clone());
            self.meshes.class = name.unwrap_or_else(|| "none".into());
        }
    }

    /// The shipped taxonomy or the path to read.
    pub fn taxonomy_file<'a>(&'a self, autos: &'a Autos) -> &'a str {
        match self.taxonomy.file.as_str() {
            "auto" => &autos.taxonomy,
            named => named,
        }
    }

    /// The grid.
    ///
    /// # Errors
    /// If it is impossible: see [`GridSpec::new`].
    pub fn grid_spec(&self) -> Result<GridSpec, Fault> {
        let grid = &self.grid;
        GridSpec::new(grid.min_m, grid.max_m, grid.voxel_size_m.sides())
    }
}

impl VoxelSize {
    /// Along x, y, z; metres.
    pub fn sides(self) -> [f64; 3] {
        match self {
            Self::Cube(side) => [side; 3],
            Self::Sides(sides) => sides,
        }
    }
}

impl Limit {
    /// The limit, if there is one.
    pub fn value(self) -> Option<f64> {
        match self {
            Self::AtMost(limit) => Some(limit),
            Self::Lifted(NoLimit::None) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset;

    fn with(settings: &[&str]) -> Result<Config, Fault> {
        let settings: Vec<String> = settings.iter().map(|s| s.to_string()).collect();
        Config::from_layers("test", preset("precise").unwrap(), None, &settings)
    }

    #[test]
    fn section_14_settings_are_toml_or_else_strings() {
        let config = with(&[
            "grid.voxel_size_m=0.2",
            "grid.min_m=[-40, -40, -1]",
            "raycast.object_rays=current",
            "relabel.max_distance_m=none",
            "taxonomy.file=my/own.toml",
            "aggregate.ego_box_m={min = [-1,-1,0], max = [1, 1, 2.5]}",
        ])
        .unwrap();
        assert_eq!(config.grid.voxel_size_m.sides(), [0.2; 3]);
        assert_eq!(config.relabel.max_distance_m.value(), None);
        assert_eq!(config.taxonomy.file, "my/own.toml");
        assert!(matches!(config.aggregate.ego_box_m, EgoBox::Corners { .. }));
    }

    #[test]
    fn section_14_an_unknown_key_is_an_error_that_names_it() {
        let fault = with(&["raycast.speed=9"]).unwrap_err().to_string();
        assert!(fault.contains("speed"), "{fault}");
        assert!(with(&["magic.key=1"]).is_err() && with(&["raycast=1"]).is_err());
    }

    #[test]
    fn section_14_reader_tables_may_be_absent_and_their_keys_are_checked() {
        assert!(!toml::to_string(&with(&[]).unwrap()).unwrap().contains("reader"));
        let config = with(&["reader.mcap.ego_frame=hull", "reader.mcap.time_unit_s=1e-6"]).unwrap();
        assert_eq!(config.reader.mcap.ego_frame, "hull");
        assert_eq!(config.reader.mcap.world_frame, "auto");
        let fault = with(&["reader.mcap.speed=9"]).unwrap_err().to_string();
        assert!(fault.contains("speed"), "{fault}");
        assert!(with(&["reader.kitti.speed=9"]).is_err());
    }

    #[test]
    fn section_14_a_file_may_state_some_keys_over_the_base() {
        let file = "[states]\noccupied_min_hits = 3\n";
        let config =
            Config::from_layers("mine", preset("precise").unwrap(), Some(file), &[]).unwrap();
        assert_eq!((config.states.occupied_min_hits, config.states.free_min_crossings), (3, 1));
    }

    #[test]
    fn section_13_no_auto_is_left_once_resolved() {
        let mut config = with(&[]).unwrap();
        let text = crate::shipped_taxonomy("occ3d-nuscenes").unwrap();
        let taxonomy = crate::parse_taxonomy(text, "test").unwrap();
        let autos = Autos {
            ego_box_m: Some(([-1.0; 3], [1.0; 3])),
            taxonomy: "occ3d-nuscenes".into(),
            reference_lidar: "TOP".into(),
        };
        config.taxonomy.file = config.taxonomy_file(&autos).to_owned();
        config.resolve(&autos, &taxonomy);
        let text = serde_json::to_string(&config).unwrap();
        assert!(
            !text.contains("\"auto\"") && !text.contains("\"taxonomy\":\"taxonomy\""),
            "{text}"
        );
        assert!(text.contains("\"unknown_class\":\"others\""), "{text}");
    }
}
