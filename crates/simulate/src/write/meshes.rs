//! Meshes of people beside a log, a file for each at a keyframe.

use std::fmt::Write;

use occlabel_core::Fault;

use super::files::Output;
use super::nuscenes::sample_token;
use crate::{DrawnMesh, Drive};

/// What a format calls keyframes and tracks, which name the files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshNames {
    /// Samples and instances, which begin with the scene's name.
    Nuscenes,
    /// A keyframe's time in nanoseconds, a mover's name.
    Mcap,
}

/// Writes `meshes/<scene>/<keyframe token>/<track>.obj`, in the log's world, for all whose shape
/// changes; how many.
///
/// # Errors
/// If a file cannot be written.
pub fn write_meshes(drives: &[Drive], names: MeshNames, output: &Output) -> Result<usize, Fault> {
    let mut written = 0;
    for drive in drives {
        let scene = &drive.scene().name;
        for keyframe in &drive.scene().keyframes {
            for mesh in drive.meshes(keyframe) {
                let mover = &drive.world().movers[mesh.mover].name;
                let (token, track) = match names {
                    MeshNames::Nuscenes => {
                        (sample_token(scene, keyframe), format!("{scene}-{mover}"))
                    }
                    MeshNames::Mcap => (keyframe.token.clone(), mover.clone()),
                };
                output
                    .write(&format!("meshes/{scene}/{token}/{track}.obj"), obj(&mesh).as_bytes())?;
                written += 1;
            }
        }
    }
    Ok(written)
}

/// Wavefront OBJ, to a tenth of a millimetre.
fn obj(mesh: &DrawnMesh) -> String {
    let mut text = String::new();
    for p in &mesh.vertices {
        writeln!(text, "v {:.4} {:.4} {:.4}", p.x, p.y, p.z).expect("room in memory");
    }
    for [a, b, c] in mesh.faces.iter().map(|face| face.map(|at| at + 1)) {
        writeln!(text, "f {a} {b} {c}").expect("room in memory");
    }
    text
}
