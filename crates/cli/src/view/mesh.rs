//! A keyframe's occupied voxels as a PLY or GLB file.

use occlabel_labels::write_file;
use occlabel_view::{ShownKeyframe, ShownScene, glb, ply_cubes, ply_points};

use crate::args::{MeshArg, ViewArgs};
use crate::console::Console;
use crate::exit::Stop;
use crate::shown_set::ShownSet;

pub(crate) fn make_ply(args: &ViewArgs, labels: &ShownSet, console: &Console) -> Result<(), Stop> {
    let ply = match args.mesh.unwrap_or(MeshArg::Points) {
        MeshArg::Points => ply_points,
        MeshArg::Cubes => ply_cubes,
    };
    make(args, labels, console, ply)
}

pub(crate) fn make_glb(args: &ViewArgs, labels: &ShownSet, console: &Console) -> Result<(), Stop> {
    make(args, labels, console, glb)
}

/// Writes one keyframe: the named one, or that in the middle.
fn make(
    args: &ViewArgs,
    labels: &ShownSet,
    console: &Console,
    bytes: fn(&ShownKeyframe, &ShownScene) -> Vec<u8>,
) -> Result<(), Stop> {
    let scene = labels.scene(args.scene.as_deref()).map_err(Stop::usage)?;
    let key = labels.keyframe(&scene.name, &args.keyframes).map_err(Stop::usage)?;
    console.info(&format!("{}: keyframe {}", scene.name, key.token));
    Ok(write_file(&args.output, &bytes(&labels.read(&key)?, &scene))?)
}
