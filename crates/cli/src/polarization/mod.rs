//! `polarization`: how light is polarized in the pictures of four cameras, beside the labels.

mod cameras;
mod picture;

use std::path::{Path, PathBuf};

use occlabel_core::{Fault, Keyframe, Scene};
use occlabel_disk as disk;
use occlabel_labels::{Beside, FileRecord, LabelTree, Manifest, TreePath, write_file};
use occlabel_logs::SceneSource;
use rayon::prelude::*;

use crate::args::{LogArgs, PolarizationArgs};
use crate::console::Console;
use crate::exit::{Outcome, Stop};
use crate::input::{Opened, Stead, open, open_by};
use crate::polarization::cameras::{Cameras, Pictures};
use crate::polarization::picture::{Grey, PolarizedPicture};
use crate::urls::check_url;

pub(crate) fn run(args: &PolarizationArgs, console: &Console) -> Result<Outcome, Stop> {
    check_url(&args.output)?;
    match (&args.images, &args.log) {
        (Some(images), _) => of_files(images, &args.output, console),
        (None, Some(log)) => of_log(log, args, console),
        (None, None) => {
            let expected = "--images, or the cameras of a log: --format, --input, --cameras";
            Err(Stop::usage(Fault::new("usage", "polarization", expected, "neither")))
        }
    }
}

/// Of four loose files: PREFIX_dolp.png and PREFIX_aolp.png.
fn of_files(images: &[PathBuf], prefix: &Path, console: &Console) -> Result<Outcome, Stop> {
    let read = |path: &PathBuf| {
        let place = path.display().to_string();
        let bytes = disk::read(path)
            .map_err(|error| Fault::new("image", &place, "a readable file", error.to_string()))?;
        Grey::decode(&bytes, &place)
    };
    let channels: Vec<Grey> = images.iter().map(read).collect::<Result<_, _>>()?;
    let picture = PolarizedPicture::of(&channels)?;
    for (ending, bytes) in picture.files() {
        let path = PathBuf::from(format!("{}_{ending}.png", prefix.display()));
        write_file(&path, &bytes)?;
        console.result(&path.display().to_string());
    }
    Tally::of(&picture).tell_pixels(console);
    Ok(Outcome::Complete)
}

/// Of every keyframe of a log that has all four pictures.
fn of_log(log: &LogArgs, args: &PolarizationArgs, console: &Console) -> Result<Outcome, Stop> {
    let tree = LabelTree::new(&args.output);
    let opened = open_as_labelled(log, args)?;
    let source = opened.source.as_ref();
    let mut beside = Beside::load(&tree)?;
    let mut tally = Tally::default();
    for name in source.scene_names() {
        let scene = source.load(&name)?;
        let cameras = Cameras::of(&scene, &args.cameras).map_err(Stop::usage)?;
        let work = Work { source, scene: &scene, cameras: &cameras, tree: &tree, name: &args.name };
        let done: Vec<(Vec<FileRecord>, Tally)> = scene
            .keyframes
            .par_iter()
            .map(|keyframe| work.keyframe(keyframe))
            .collect::<Result<_, _>>()?;
        let before = tally.clone();
        for (files, of_keyframe) in done {
            beside.add(&args.name, &args.cameras, files);
            tally.add(&of_keyframe);
        }
        if let Some(fault) = tally.absent_since(&before, &scene) {
            console.warning(&name, &fault);
        }
    }
    beside.write(&tree)?;
    tally.tell_keyframes(console);
    tally.tell_pixels(console);
    Ok(Outcome::Complete)
}

/// The log, read by the configuration of the labels in the output folder if there are any and the command
/// line names none: their keyframes are the log's then.
fn open_as_labelled(log: &LogArgs, args: &PolarizationArgs) -> Result<Opened, Stop> {
    let manifest = match args.config.is_empty() {
        true => Manifest::load_tree(&args.output)?,
        false => None,
    };
    match manifest.and_then(|manifest| serde_json::from_value(manifest.config).ok()) {
        Some(made_by) => open_by(log, made_by, &Stead::default()),
        None => open(log, &args.config),
    }
}

/// What is done with each keyframe of a scene.
struct Work<'a> {
    source: &'a dyn SceneSource,
    scene: &'a Scene,
    cameras: &'a Cameras,
    tree: &'a LabelTree,
    name: &'a str,
}

impl Work<'_> {
    /// Writes the keyframe's files; none, and counted, if a picture is absent.
    fn keyframe(&self, keyframe: &Keyframe) -> Result<(Vec<FileRecord>, Tally), Fault> {
        let channels = match self.cameras.read(self.source, self.scene, keyframe)? {
            Pictures::All(channels) => channels,
            Pictures::Absent => return Ok((Vec::new(), Tally { absent: 1, ..Tally::default() })),
        };
        let picture = PolarizedPicture::of(&channels)?;
        let write = |(ending, bytes): (&str, Vec<u8>)| {
            let file =
                format!("gts/{}/{}/{}_{ending}.png", self.scene.name, keyframe.token, self.name);
            self.tree.write(&TreePath::new(file)?, &bytes)
        };
        let files = picture.files().into_iter().map(write).collect::<Result<_, _>>()?;
        Ok((files, Tally::of(&picture)))
    }
}

/// What came of it.
#[derive(Clone, Debug, Default)]
struct Tally {
    made: usize,
    absent: usize,
    pixels: usize,
    dark: usize,
    clamped: usize,
}

impl Tally {
    fn of(picture: &PolarizedPicture) -> Self {
        let light = &picture.light;
        let (dark, clamped) = (light.dark, light.clamped);
        Self { made: 1, absent: 0, pixels: light.degree.len(), dark, clamped }
    }

    fn add(&mut self, more: &Self) {
        self.made += more.made;
        self.absent += more.absent;
        self.pixels += more.pixels;
        self.dark += more.dark;
        self.clamped += more.clamped;
    }

    /// That a scene has keyframes without all four pictures, if it has.
    fn absent_since(&self, before: &Self, scene: &Scene) -> Option<Fault> {
        let absent = self.absent - before.absent;
        let found = format!("{absent} of {} without", scene.keyframes.len());
        let fault =
            || Fault::new("image-absent", &scene.name, "four pictures at a keyframe", found);
        (absent > 0).then(fault)
    }

    fn tell_keyframes(&self, console: &Console) {
        let line = format!("keyframes  {}, {} without all pictures", self.made, self.absent);
        console.result(&line);
    }

    fn tell_pixels(&self, console: &Console) {
        let line =
            format!("pixels     {}, {} dark, {} clamped", self.pixels, self.dark, self.clamped);
        console.result(&line);
    }
}
