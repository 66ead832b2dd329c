//! A mesh moved onto the points that a lidar has of it (labels.md section 9a).
//!
//! Iterative closest point (Besl & McKay 1992) with distances along normals (Chen & Medioni 1991).
//! Pairs are taken from the points' side: a return lies on the surface, but a vertex need not have a
//! return near it, as some tens of points are spread over thousands of vertices.

use nalgebra::Point3;
use occlabel_core::{Pose, TriangleMesh};

use crate::nudge::Nudge;
use crate::surface::Surface;

/// So many steps are taken at most.
const MOST_STEPS: usize = 40;
/// What is visible is found out anew after so many steps.
const STEPS_A_LOOK: usize = 8;
/// A step that moves no more than this ends the search, metres and radians.
const SETTLED: f64 = 1e-5;
/// From step to step, pairs are trusted only up to this share of the distance before.
const NARROWING: f64 = 0.85;
/// At last, pairs are trusted half at so many deviations.
const LAST_DEVIATIONS: f64 = 2.0;

/// How a mesh is moved onto points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlignSettings {
    /// A point farther than this from the visible surface has no say, metres.
    pub max_pair_m: f64,
    /// How far points lie off a right surface: their deviation, metres.
    pub point_error_m: f64,
    /// How far meshes stand off: the deviation of their place, metres.
    pub mesh_error_m: f64,
    /// The same of their attitude, radians.
    pub mesh_error_rad: f64,
}

/// Points that a lidar has of a body, and where it stood.
#[derive(Clone, Debug)]
pub struct View {
    /// The rays' origin.
    pub from: Point3<f64>,
    /// Where they end.
    pub points: Vec<Point3<f64>>,
}

/// How a mesh has to be moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alignment {
    /// What moves the mesh.
    pub aligned_from_given: Pose,
    /// The mean distance of a point from the surface that its lidar sees, where more than
    /// `max_pair_m` counts as that; metres.
    pub residual_m: f64,
}

/// Moves a mesh onto the points of views of it. Without a point it stays.
pub fn align(mesh: &TriangleMesh, views: &[View], settings: &AlignSettings) -> Alignment {
    let centre = mesh.centre();
    let Some(surface) = Surface::of(mesh, &centre) else { return Alignment::none(settings) };
    let views: Vec<View> = views.iter().map(|view| view.about(&centre)).collect();
    let mut moved = Pose::identity();
    let mut trust_m = settings.max_pair_m;
    let mut seen = look(&surface, &views, &moved);
    for step in 1..=MOST_STEPS {
        let Some(next) = nudge(&seen, &moved, trust_m, settings).solve() else { break };
        moved = next * moved;
        trust_m = (trust_m * NARROWING).max(LAST_DEVIATIONS * settings.point_error_m);
        if step % STEPS_A_LOOK == 0 {
            if is_small(&next) {
                break;
            }
            seen = look(&surface, &views, &moved);
        }
    }
    let residual_m = residual_m(&look(&surface, &views, &moved), &moved, settings.max_pair_m);
    let (there, back) = (Pose::translation(centre.x, centre.y, centre.z), -centre.coords);
    let aligned_from_given = there * moved * Pose::translation(back.x, back.y, back.z);
    Alignment { aligned_from_given, residual_m }
}

impl Alignment {
    fn none(settings: &AlignSettings) -> Self {
        Self { aligned_from_given: Pose::identity(), residual_m: settings.max_pair_m }
    }
}

impl View {
    /// The same, seen from a place.
    fn about(&self, centre: &Point3<f64>) -> Self {
        let from = self.from - centre.coords;
        Self { from, points: self.points.iter().map(|point| point - centre.coords).collect() }
    }
}

/// The points of a view, and what of the surface is visible from it.
struct Seen<'a> {
    points: &'a [Point3<f64>],
    surface: Surface,
}

/// What each view sees of a surface that has been moved so.
fn look<'a>(surface: &Surface, views: &'a [View], moved: &Pose) -> Vec<Seen<'a>> {
    let see = |view: &'a View| {
        let surface = surface.visible_from(&moved.inverse_transform_point(&view.from))?;
        Some(Seen { points: &view.points, surface })
    };
    views.iter().filter_map(see).collect()
}

/// What all points say of the next step. A pair counts the less, the farther it is apart (Geman &
/// McClure 1985).
fn nudge(seen: &[Seen], moved: &Pose, trust_m: f64, settings: &AlignSettings) -> Nudge {
    let mut nudge = Nudge::default();
    nudge.hold_back(moved, [settings.mesh_error_rad, settings.mesh_error_m]);
    let known = 1.0 / (settings.point_error_m * settings.point_error_m);
    for (point, surface) in points(seen) {
        let foot = surface.nearest(&moved.inverse_transform_point(point));
        if foot.distance_m <= settings.max_pair_m {
            let far = foot.distance_m / trust_m;
            let trust = 1.0 / ((1.0 + far * far) * (1.0 + far * far));
            let (at, along) = (moved * foot.at, moved * foot.normal);
            nudge.add(&at, &along, foot.distance_m, known * trust);
        }
    }
    nudge
}

fn points<'a>(seen: &'a [Seen]) -> impl Iterator<Item = (&'a Point3<f64>, &'a Surface)> {
    seen.iter().flat_map(|seen| seen.points.iter().map(|point| (point, &seen.surface)))
}

fn residual_m(seen: &[Seen], moved: &Pose, max_pair_m: f64) -> f64 {
    let off_m = |(point, surface): (&Point3<f64>, &Surface)| {
        surface.nearest(&moved.inverse_transform_point(point)).distance_m.min(max_pair_m)
    };
    let off_m: Vec<f64> = points(seen).map(off_m).collect();
    if off_m.is_empty() { max_pair_m } else { off_m.iter().sum::<f64>() / off_m.len() as f64 }
}

fn is_small(step: &Pose) -> bool {
    step.translation.vector.norm() < SETTLED && step.rotation.scaled_axis().norm() < SETTLED
}
