//! Bodies that are known by their surface: solids within triangles.

use std::sync::Arc;

use nalgebra::Point3;

use crate::{ClassId, Fault, Pose, Timestamp, TrackId, is_finite};

/// A surface of triangles, corners counter-clockwise seen from outside. It may pass through itself, as
/// the parts of a fitted body do.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleMesh {
    vertices: Vec<Point3<f64>>,
    /// Shared by all meshes of one topology.
    faces: Arc<[[u32; 3]]>,
}

/// A mesh as a log has it, in a frame that the configuration tells.
#[derive(Clone, Debug, PartialEq)]
pub struct LoggedMesh {
    /// The log's own name of the track whose body it is.
    pub track: String,
    /// The surface.
    pub mesh: TriangleMesh,
}

/// Somebody at a keyframe, known by their surface.
#[derive(Clone, Debug)]
pub struct Body {
    /// The keyframe's time.
    pub time: Timestamp,
    /// Whose body it is: a track of the scene, or a number after those of tracks.
    pub track: TrackId,
    /// What it is.
    pub class: ClassId,
    /// The surface, in world.
    pub mesh: TriangleMesh,
    /// How it moves; none if nothing tells.
    pub motion: Option<BodyMotion>,
}

/// How a body stands at the times around a keyframe, seen from how it stands there; world.
///
/// ```text
///   earlier_from_now <--- now ---> later_from_now       seconds from the earlier to the later
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyMotion {
    /// What moves it to where it stands later.
    pub later_from_now: Pose,
    /// What moves it to where it stood earlier.
    pub earlier_from_now: Pose,
    /// Between the two times, above 0.
    pub seconds: f64,
}

/// What is larger is no body, but a broken vertex or another unit, metres.
const LARGEST_M: f64 = 20.0;

/// From corner to corner of the box around points, metres.
fn across_m(points: &[Point3<f64>]) -> f64 {
    let reach = |axis: usize| {
        let along = points.iter().map(|point| point[axis]);
        let ends = along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| {
            [low.min(at), high.max(at)]
        });
        ends[1] - ends[0]
    };
    (reach(0) * reach(0) + reach(1) * reach(1) + reach(2) * reach(2)).sqrt()
}

impl TriangleMesh {
    /// A surface of vertices, metres, and of triangles between them.
    ///
    /// # Errors
    /// If there is no triangle, a triangle names no vertex, a coordinate is no finite number, or the
    /// surface is larger than any body.
    pub fn new(
        vertices: Vec<Point3<f64>>,
        faces: impl Into<Arc<[[u32; 3]]>>,
    ) -> Result<Self, Fault> {
        let faces = faces.into();
        let fault = |expected: &str, found| Fault::new("mesh", "a mesh", expected, found);
        if faces.is_empty() {
            return Err(fault("triangles", "none".to_owned()));
        }
        let count = vertices.len();
        if let Some(stray) = faces.as_flattened().iter().find(|&&at| at as usize >= count) {
            return Err(fault(
                &format!("faces of its {count} vertices"),
                format!("vertex {stray}"),
            ));
        }
        if let Some(at) = vertices.iter().position(|vertex| !is_finite(vertex)) {
            return Err(fault("finite coordinates", format!("vertex {at}: {}", vertices[at])));
        }
        match across_m(&vertices) {
            across_m if across_m <= LARGEST_M => Ok(Self { vertices, faces }),
            across_m => Err(fault(
                &format!("a body of at most {LARGEST_M} m across"),
                format!("{across_m:.3e} m"),
            )),
        }
    }

    /// The vertices, metres.
    pub fn vertices(&self) -> &[Point3<f64>] {
        &self.vertices
    }

    /// Of each triangle the numbers of its vertices.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// The corners of each triangle.
    pub fn triangles(&self) -> impl Iterator<Item = [Point3<f64>; 3]> + '_ {
        self.faces.iter().map(|face| face.map(|at| self.vertices[at as usize]))
    }

    /// The same surface elsewhere.
    pub fn moved(&self, dst_from_src: &Pose) -> Self {
        let vertices = self.vertices.iter().map(|vertex| dst_from_src * vertex).collect();
        Self { vertices, faces: self.faces.clone() }
    }

    /// The mean of its vertices.
    pub fn centre(&self) -> Point3<f64> {
        let sum: nalgebra::Vector3<f64> = self.vertices.iter().map(|vertex| vertex.coords).sum();
        Point3::from(sum / self.vertices.len() as f64)
    }

    /// Whether vertex by vertex it is the same thing in another pose or place.
    pub fn is_like(&self, other: &Self) -> bool {
        self.vertices.len() == other.vertices.len() && self.faces == other.faces
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners() -> Vec<Point3<f64>> {
        vec![Point3::origin(), Point3::new(1.0, 0.0, 0.0), Point3::new(0.0, 1.0, 0.0)]
    }

    #[test]
    fn a_mesh_is_refused_at_the_door() {
        let refused = |vertices, faces: &[[u32; 3]]| {
            TriangleMesh::new(vertices, faces).unwrap_err().to_string()
        };
        assert!(refused(corners(), &[]).contains("triangles"));
        assert!(refused(corners(), &[[0, 1, 2], [0, 1, 3]]).contains("vertex 3"));
        let mut broken = corners();
        broken[1].y = f64::NAN;
        assert!(refused(broken, &[[0, 1, 2]]).contains("vertex 1"));
    }

    #[test]
    fn what_is_moved_is_alike_and_its_centre_moves_along() {
        let mesh = TriangleMesh::new(corners(), [[0, 1, 2]]).unwrap();
        let moved = mesh.moved(&Pose::translation(3.0, 0.0, -1.0));
        assert!(mesh.is_like(&moved) && mesh != moved);
        let way = moved.centre() - mesh.centre();
        assert!((way - nalgebra::Vector3::new(3.0, 0.0, -1.0)).norm() < 1e-12, "{way}");
    }
}
