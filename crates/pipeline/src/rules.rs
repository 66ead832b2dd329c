//! A configuration bound to a taxonomy: what the stages run by.

use std::sync::Arc;

use nalgebra::Point3;
use occlabel_aggregate::{SplitSettings, WindowSettings};
use occlabel_annotate::{BoxSettings, GhostClasses, PaintSettings, RelabelSettings};
use occlabel_core::{BoxGrowth, ClassId, Fault, GridSpec, Pose, Scene, SweepHeader, Taxonomy};
use occlabel_meshes::AlignSettings;
use occlabel_occlusion::OcclusionSettings;
use occlabel_raycast::{RayRules, RaySettings, RaySource, StateSettings};
use occlabel_voxelize::{Vote, VoteRules};

use crate::config::{EgoBox, MeshTable, RelabelTable};
use crate::{Config, GridFrame, MeshFrame};

/// The settings of every stage, resolved.
#[derive(Clone, Debug)]
pub struct Rules {
    /// The grid.
    pub spec: GridSpec,
    /// The frame it stands in.
    pub frame: GridFrame,
    /// The classes.
    pub taxonomy: Arc<Taxonomy>,
    /// Section 3.
    pub boxes: BoxSettings,
    /// Section 4, once per sweep.
    pub split: SplitSettings,
    /// Section 4, once per keyframe.
    pub window: WindowSettings,
    /// Section 5, from masks; `None` if there are none.
    pub paint: Option<PaintSettings>,
    /// Section 9.
    pub states: StateSettings,
    /// Section 9a.
    pub meshes: MeshRules,
    /// Section 10.
    pub occlusion: OcclusionSettings,
    relabel: RelabelTable,
    unknown: Option<ClassId>,
    vote: Vote,
    rays: RaySettings,
}

/// What is made of meshes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshRules {
    /// The frame of their vertices.
    pub frame: MeshFrame,
    /// The class of one without a track; none if the taxonomy has nothing that changes shape.
    pub class: Option<ClassId>,
    /// How they are moved onto points; none if they stay.
    pub align: Option<AlignSettings>,
    /// Meshes with fewer points stay.
    pub min_points: usize,
    /// Meshes whose points lie farther off in the mean are refused, metres.
    pub max_residual_m: f64,
}

impl Rules {
    /// Binds a resolved configuration to its taxonomy.
    ///
    /// # Errors
    /// If the grid is impossible, or `unknown_class` or `meshes.class` names no class.
    pub fn new(config: &Config, taxonomy: Arc<Taxonomy>) -> Result<Self, Fault> {
        let aggregate = &config.aggregate;
        let growth = BoxGrowth { scale: aggregate.box_scale, margin_m: aggregate.box_margin_m };
        Ok(Self {
            spec: config.grid_spec()?,
            frame: config.grid.frame,
            boxes: config.boxes,
            split: SplitSettings {
                ego_box_m: corners(&aggregate.ego_box_m),
                max_range_m: aggregate.max_range_m,
                growth,
            },
            window: WindowSettings {
                window_s: aggregate.window_s,
                deformable_window_s: aggregate.deformable_window_s,
                radius_m: aggregate.radius_m.value(),
                deformable: taxonomy.deformable,
                growth,
            },
            paint: config.paint.settings(),
            states: config.states,
            meshes: mesh_rules(&config.meshes, &taxonomy)?,
            occlusion: config.occlusion,
            relabel: config.relabel.clone(),
            unknown: unknown_class(&config.relabel.unknown_class, &taxonomy)?,
            vote: config.voxelize.vote,
            rays: config.raycast,
            taxonomy,
        })
    }

    /// Section 5, for a scene.
    pub fn relabel(&self, scene: &Scene) -> RelabelSettings {
        let ghosts: GhostClasses = self.relabel.drop_ghosts;
        RelabelSettings {
            k: self.relabel.k,
            max_distance_m: self.relabel.max_distance_m.value(),
            unknown: self.unknown,
            ghosts: ghosts.of(&self.taxonomy, !scene.tracks.is_empty()),
        }
    }

    /// Section 7.
    pub fn votes(&self) -> VoteRules<'_> {
        VoteRules { vote: self.vote, movers: &self.taxonomy.movers, rank: &self.taxonomy.rank }
    }

    /// Section 8.
    pub fn rays(&self) -> RayRules<'_> {
        RayRules { settings: &self.rays, flat: &self.taxonomy.flat }
    }

    /// Whether lidar rays tell what is free, and not the cameras'.
    pub fn casts_lidar_rays(&self) -> bool {
        self.rays.source == RaySource::Lidar
    }

    /// Where the grid of a keyframe stands, by its reference sweep.
    pub fn world_from_grid(&self, reference: &SweepHeader) -> Pose {
        match self.frame {
            GridFrame::Ego => reference.world_from_ego,
            GridFrame::Lidar => reference.world_from_lidar(),
        }
    }

    /// Refuses a scene that would come out empty: without point labels, masks or a class for such
    /// points, or without the rays that are asked for.
    ///
    /// # Errors
    /// If so, with what to set.
    pub fn check(&self, scene: &Scene) -> Result<(), Fault> {
        self.check_rays(scene)?;
        self.check_labels(scene)
    }

    fn check_rays(&self, scene: &Scene) -> Result<(), Fault> {
        if !self.casts_lidar_rays() || !scene.has_timeless_points() {
            return Ok(());
        }
        let expected = "rays of a lidar, as raycast.source = \"lidar\" asks for";
        let fault = Fault::new("no-rays", &scene.name, expected, "points that no lidar measured");
        Err(fault
            .hint("--preset gs-occ3d, or --set raycast.source=camera, goes by the cameras' rays"))
    }

    fn check_labels(&self, scene: &Scene) -> Result<(), Fault> {
        if scene.has_point_labels() || self.paint.is_some() || self.unknown.is_some() {
            return Ok(());
        }
        Err(Fault::new(
            "no-labels",
            &scene.name,
            "point labels, or a class for what has none",
            "neither",
        )
        .hint("name a class with --set relabel.unknown_class=CLASS"))
    }
}

fn mesh_rules(table: &MeshTable, taxonomy: &Taxonomy) -> Result<MeshRules, Fault> {
    let class = match table.class.as_str() {
        "auto" => taxonomy.first_of(&taxonomy.deformable),
        "none" => None,
        name => Some(class_named(name, "meshes.class", "\"auto\"", taxonomy)?),
    };
    let align = AlignSettings {
        max_pair_m: table.max_pair_m,
        point_error_m: table.point_error_m,
        mesh_error_m: table.mesh_error_m,
        mesh_error_rad: table.mesh_error_rad,
    };
    Ok(MeshRules {
        frame: table.frame,
        class,
        align: table.align.then_some(align),
        min_points: table.min_points,
        max_residual_m: table.max_residual_m,
    })
}

fn corners(ego_box: &EgoBox) -> Option<(Point3<f64>, Point3<f64>)> {
    match ego_box {
        EgoBox::Corners { min, max } => Some(((*min).into(), (*max).into())),
        EgoBox::Word(_) => None,
    }
}

fn unknown_class(name: &str, taxonomy: &Taxonomy) -> Result<Option<ClassId>, Fault> {
    match name {
        "drop" => Ok(None),
        "taxonomy" => Ok(taxonomy.unknown),
        name => {
            class_named(name, "relabel.unknown_class", "\"taxonomy\", \"drop\"", taxonomy).map(Some)
        }
    }
}

/// The class that a key names, where no other `words` stand for one.
fn class_named(name: &str, key: &str, words: &str, taxonomy: &Taxonomy) -> Result<ClassId, Fault> {
    taxonomy.class_named(name).ok_or_else(|| {
        let expected = format!("{words}, or one of {}", taxonomy.names.join(", "));
        Fault::new("config", key, expected, format!("\"{name}\""))
    })
}
