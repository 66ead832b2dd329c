//! Labels as a PNG.

use occlabel_labels::write_file;
use occlabel_view::{BirdsEye, Orbit, Painted, birds_eye, perspective, png};

use crate::args::{PictureArg, ViewArgs};
use crate::console::Console;
use crate::exit::Stop;
use crate::shown_set::ShownSet;

pub(crate) fn make(args: &ViewArgs, labels: &ShownSet, console: &Console) -> Result<(), Stop> {
    let scene = labels.scene(args.scene.as_deref()).map_err(Stop::usage)?;
    let keys = labels.keyframes(&scene.name, &args.keyframes).map_err(Stop::usage)?;
    let Some(key) = keys.get(keys.len() / 2) else { return Ok(()) };
    console.info(&format!("{}: keyframe {}", scene.name, key.token));
    let keyframe = labels.read(key)?;
    let painted = Painted::of(&keyframe, &scene);
    let picture = match args.picture {
        PictureArg::BirdsEye => birds_eye(&painted, &BirdsEye { map_px: 800 }),
        PictureArg::Perspective => perspective(&painted, &Orbit::behind(&keyframe.spec, 1600, 900)),
    };
    Ok(write_file(&args.output, &png(&picture))?)
}
