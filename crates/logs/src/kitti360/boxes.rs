//! The boxes of a drive: an XML file of objects, each a hull that a matrix puts into the world.
//!
//! ```text
//!   <object><semanticId/><instanceId/><start_frame/><end_frame/>
//!     <timestamp/>            the frame, or -1: it stands still from start_frame to end_frame
//!     <transform/><vertices/> each with rows, cols, data
//!   </object>
//! ```

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use occlabel_core::{Box3, Fault, Pose};
use roxmltree::{Document, Node};

use crate::transform::is_place;

/// Columns of a transform that are farther from square than this make no box.
const LARGEST_SKEW: f64 = 1e-2;

/// An object at a frame, or at a span of frames.
#[derive(Debug)]
pub(super) struct Object {
    /// Its class, by the number that boxes have.
    pub(super) class: u16,
    pub(super) instance: i64,
    pub(super) frames: Frames,
    /// In world; what was found in place of one that is none.
    pub(super) boxed: Result<Box3, String>,
}

/// When an object stands where its box says.
#[derive(Debug)]
pub(super) enum Frames {
    At(usize),
    From(usize, usize),
}

/// The objects of a file that have a class.
///
/// # Errors
/// If it is no such file.
pub(super) fn read_objects(bytes: &[u8], file: &str) -> Result<Vec<Object>, Fault> {
    let broken = |found: String| Fault::new("boxes", file, "an XML file of objects", found);
    let text = std::str::from_utf8(bytes).map_err(|error| broken(error.to_string()))?;
    let document = Document::parse(text).map_err(|error| broken(error.to_string()))?;
    let objects =
        document.root_element().children().filter(|node| child(node, "transform").is_some());
    let object = |node| {
        object(&node).ok_or_else(|| {
            let at = document.text_pos_at(node.range().start);
            let expected = "semanticId, instanceId, frames and timestamp of an object";
            Fault::new("boxes", file, expected, "none").record(format!("line {}", at.row))
        })
    };
    objects.map(object).collect()
}

fn object(node: &Node) -> Option<Object> {
    let whole = |name| text(node, name)?.trim().parse::<i64>().ok();
    let frame = |name| usize::try_from(whole(name)?).ok();
    let frames = match whole("timestamp")? {
        -1 => Frames::From(frame("start_frame")?, frame("end_frame")?),
        at => Frames::At(usize::try_from(at).ok()?),
    };
    Some(Object {
        class: u16::try_from(whole("semanticId")?).ok()?,
        instance: whole("instanceId")?,
        frames,
        boxed: boxed(node),
    })
}

/// The box around the vertices along the columns of the transform.
fn boxed(node: &Node) -> Result<Box3, String> {
    let m = matrix(node, "transform").filter(|m| m.len() == 16 || m.len() == 12);
    let m = m.ok_or("no transform of 4 columns")?;
    let vertices = matrix(node, "vertices").ok_or("no vertices")?;
    let (corners, rest) = vertices.as_chunks::<3>();
    if corners.is_empty() || !rest.is_empty() {
        return Err(format!("{} numbers of vertices", vertices.len()));
    }
    let scaled = Matrix3::new(m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]);
    let scale = Vector3::from_iterator(scaled.column_iter().map(|column| column.norm()));
    let axes = scaled * Matrix3::from_diagonal(&scale.map(|length| 1.0 / length));
    let skew = (axes.transpose() * axes - Matrix3::identity()).amax();
    if skew.is_nan() || skew > LARGEST_SKEW || axes.determinant() <= 0.0 {
        return Err(format!("a transform whose axes are off square by {skew}"));
    }
    let lowest = corners.iter().fold([f64::INFINITY; 3], |low, c| by_axis(&low, c, f64::min));
    let highest = corners.iter().fold([-f64::INFINITY; 3], |high, c| by_axis(&high, c, f64::max));
    let (lowest, highest) = (Vector3::from(lowest), Vector3::from(highest));
    let size_m = (highest - lowest).component_mul(&scale);
    let centre = scaled * (lowest + highest) / 2.0 + Vector3::new(m[3], m[7], m[11]);
    if !size_m.iter().all(|side| side.is_finite() && *side > 0.0) {
        return Err(format!("{} x {} x {} m", size_m.x, size_m.y, size_m.z));
    }
    if !is_place(&centre) {
        return Err(format!("a centre {:?} m, beyond 1e9 m", centre.as_slice()));
    }
    let near = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
    let rotation = UnitQuaternion::new_normalize(near.into_inner());
    Ok(Box3 { world_from_box: Pose::from_parts(centre.into(), rotation), size_m })
}

fn by_axis(a: &[f64; 3], b: &[f64; 3], choose: fn(f64, f64) -> f64) -> [f64; 3] {
    [0, 1, 2].map(|axis| choose(a[axis], b[axis]))
}

/// The numbers of OpenCV's matrix, if all are finite.
fn matrix(node: &Node, name: &str) -> Option<Vec<f64>> {
    let node = child(node, name)?;
    let numbers = text(&node, "data")?.split_whitespace();
    numbers.map(|word| word.parse().ok().filter(|number: &f64| number.is_finite())).collect()
}

fn text<'a>(node: &Node<'a, '_>, name: &str) -> Option<&'a str> {
    child(node, name)?.text()
}

fn child<'a, 'i>(node: &Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| child.has_tag_name(name))
}
