//! GLB files: glTF 2.0 with its numbers in the same file.
//!
//! ```text
//!   labels frame        glTF
//!   z up                y up          x forward -> z forward
//!    |  x forward        |  z forward y left    -> x left
//!    | /                 | /          z up      -> y up
//!    +--- y right       -+--- x left
//! ```
//!
//! One root node turns the axes; under it stands a node, with a mesh and a material, for each class.
//! The document is so small that `serde_json` writes it without a crate of glTF's types.
//!
//! Source: Khronos Group, "glTF 2.0 Specification".

use serde_json::{Value, json};

use crate::{ShownKeyframe, ShownScene};

use super::corner_m;
use super::quads::{Quad, quads};

/// The occupied voxels of a keyframe: a closed solid for each class, of its colour, metres.
pub fn glb(keyframe: &ShownKeyframe, scene: &ShownScene) -> Vec<u8> {
    let kind =
        |voxel| Some(*keyframe.semantics.at(voxel)).filter(|&class| scene.is_occupied(class));
    let mut quads = quads(keyframe.spec.shape(), kind);
    quads.sort_by_key(|quad| quad.kind);
    let mut document = Document::new(&keyframe.token);
    for quads in quads.chunk_by(|a, b| a.kind == b.kind) {
        let class = quads[0].kind;
        document.add(&scene.palette.label(class), class, scene.palette.color(class));
        document.solid(quads, keyframe);
    }
    document.into_bytes()
}

/// A glTF document that grows class by class.
struct Document {
    json: Value,
    numbers: Vec<u8>,
}

/// x, y, z of the labels' frame become z, x, y.
const Y_UP: [f64; 4] = [-0.5, -0.5, -0.5, 0.5];
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

impl Document {
    fn new(name: &str) -> Self {
        let json = json!({
            "asset": { "version": "2.0", "generator": "occlabel" },
            "scene": 0,
            "scenes": [{ "nodes": [0] }],
            "nodes": [{ "name": name, "rotation": Y_UP }],
        });
        Self { json, numbers: Vec::new() }
    }

    /// A class's node, mesh and material; its solid comes next.
    fn add(&mut self, name: &str, class: u8, color: [u8; 3]) {
        let mesh = self.push("meshes", json!({ "name": name }));
        let node = json!({ "name": name, "mesh": mesh, "extras": { "class": class } });
        let node = self.push("nodes", node);
        push(&mut self.json["nodes"][0]["children"], json!(node));
        let [red, green, blue] = color.map(linear);
        let paint = json!({
            "baseColorFactor": [red, green, blue, 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": 1.0,
        });
        self.push("materials", json!({ "name": name, "pbrMetallicRoughness": paint }));
    }

    /// The primitive of the last mesh: two triangles a rectangle, corners not shared, so that
    /// viewers shade each flat.
    fn solid(&mut self, quads: &[Quad<u8>], keyframe: &ShownKeyframe) {
        let corners = quads.iter().flat_map(Quad::corners);
        let corners: Vec<_> =
            corners.map(|corner| corner_m(&keyframe.spec, corner).map(|m| m as f32)).collect();
        let firsts = (0..quads.len() as u32).map(|quad| 4 * quad);
        let indices: Vec<u32> = firsts.flat_map(|i| [i, i + 1, i + 2, i, i + 2, i + 3]).collect();
        let extreme = |pick: fn(f32, f32) -> f32| -> [f64; 3] {
            std::array::from_fn(|axis| {
                corners.iter().map(|corner| corner[axis]).reduce(pick).map_or(0.0, f64::from)
            })
        };
        let bounds = json!({ "min": extreme(f32::min), "max": extreme(f32::max) });
        let bytes = corners.as_flattened().iter().flat_map(|m| m.to_le_bytes()).collect();
        let positions = self.accessor(bytes, ARRAY_BUFFER, FLOAT, "VEC3", corners.len(), bounds);
        let bytes = indices.iter().flat_map(|index| index.to_le_bytes()).collect();
        let (kind, count) = (UNSIGNED_INT, indices.len());
        let indices = self.accessor(bytes, ELEMENT_ARRAY_BUFFER, kind, "SCALAR", count, json!({}));
        let last = self.json["meshes"].as_array().map_or(0, |meshes| meshes.len() - 1);
        let attributes = json!({ "POSITION": positions });
        let primitive = json!({ "attributes": attributes, "indices": indices, "material": last });
        self.json["meshes"][last]["primitives"] = json!([primitive]);
    }

    /// Numbers of 4 bytes, and what they are.
    fn accessor(
        &mut self,
        bytes: Vec<u8>,
        target: u32,
        component: u32,
        kind: &str,
        count: usize,
        mut accessor: Value,
    ) -> usize {
        let place = json!({
            "buffer": 0,
            "byteOffset": self.numbers.len(),
            "byteLength": bytes.len(),
            "target": target,
        });
        self.numbers.extend(bytes);
        accessor["bufferView"] = json!(self.push("bufferViews", place));
        accessor["componentType"] = json!(component);
        accessor["type"] = json!(kind);
        accessor["count"] = json!(count);
        self.push("accessors", accessor)
    }

    fn push(&mut self, list: &str, item: Value) -> usize {
        push(&mut self.json[list], item)
    }

    fn into_bytes(mut self) -> Vec<u8> {
        let mut chunks = Vec::new();
        if !self.numbers.is_empty() {
            self.json["buffers"] = json!([{ "byteLength": self.numbers.len() }]);
            chunks = chunk(b"BIN\0", self.numbers, 0);
        }
        let mut body = chunk(b"JSON", self.json.to_string().into_bytes(), b' ');
        body.extend(chunks);
        let mut bytes = b"glTF".to_vec();
        bytes.extend([2, body.len() as u32 + 12].iter().flat_map(|n: &u32| n.to_le_bytes()));
        bytes.extend(body);
        bytes
    }
}

/// Adds to a list, which is there from its first item on; tells the item's place.
fn push(list: &mut Value, item: Value) -> usize {
    match list.as_array_mut() {
        Some(items) => {
            items.push(item);
            items.len() - 1
        }
        None => {
            *list = json!([item]);
            0
        }
    }
}

/// A chunk: its length, its kind, its bytes, filled up to a multiple of 4.
fn chunk(kind: &[u8; 4], mut data: Vec<u8>, filling: u8) -> Vec<u8> {
    data.resize(data.len().next_multiple_of(4), filling);
    let mut bytes = (data.len() as u32).to_le_bytes().to_vec();
    bytes.extend(kind);
    bytes.extend(data);
    bytes
}

/// Colours of files are sRGB, those of materials are not.
fn linear(channel: u8) -> f64 {
    let share = f64::from(channel) / 255.0;
    match share <= 0.04045 {
        true => share / 12.92,
        false => libm::pow((share + 0.055) / 1.055, 2.4),
    }
}

#[cfg(test)]
mod tests {
    use occlabel_core::{GridSpec, VoxelGrid};

    use super::*;
    use crate::testing::{shown_keyframe, shown_scene};

    /// The document and the numbers of a file, whose lengths are checked on the way.
    fn parts(bytes: &[u8]) -> (Value, Vec<u8>) {
        let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!((&bytes[..4], number(4), number(8)), (&b"glTF"[..], 2, bytes.len()));
        let end = 20 + number(12);
        let document = serde_json::from_slice(&bytes[20..end]).unwrap();
        let rest = bytes.get(end + 8..).unwrap_or_default();
        assert!(end % 4 == 0 && (rest.is_empty() || number(end) == rest.len()));
        (document, rest.to_vec())
    }

    #[test]
    fn each_class_is_a_node_of_its_own_under_one_that_turns_the_axes() {
        let spec = GridSpec::new([0.0; 3], [2.0, 1.0, 1.0], [1.0; 3]).unwrap();
        let keyframe = shown_keyframe(&spec, VoxelGrid::from_values(&spec, vec![1, 0]));
        let (document, numbers) = parts(&glb(&keyframe, &shown_scene()));
        assert_eq!(document["nodes"][0]["children"], json!([1, 2]));
        assert_eq!([1, 2].map(|at| &document["nodes"][at]["name"]), ["car", "driveable surface"]);
        let bounds = &document["accessors"][0];
        assert_eq!(
            (&bounds["min"], &bounds["max"]),
            (&json!([1.0, 0.0, 0.0]), &json!([2.0, 1.0, 1.0]))
        );
        assert_eq!(numbers.len(), 2 * (6 * 4 * 12 + 6 * 6 * 4));
    }

    #[test]
    fn an_empty_grid_is_a_document_without_meshes() {
        let spec = GridSpec::new([0.0; 3], [1.0; 3], [1.0; 3]).unwrap();
        let keyframe = shown_keyframe(&spec, VoxelGrid::filled(&spec, 2));
        let (document, numbers) = parts(&glb(&keyframe, &shown_scene()));
        assert!(document.get("meshes").is_none() && document.get("buffers").is_none());
        assert!(numbers.is_empty());
    }
}
