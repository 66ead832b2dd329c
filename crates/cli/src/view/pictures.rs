//! Labels as a PNG.

use std::path::Path;

use image::RgbImage;
use occlabel_core::Fault;
use occlabel_dialects::KeyframeKey;
use occlabel_labels::write_file;
use occlabel_view::{Across, Difference, Painted, Plate, ShownScene, Strip, png};

use crate::args::{LogArgs, PictureArg, ViewArgs};
use crate::console::Console;
use crate::exit::Stop;
use crate::label_pairs::LabelPairs;
use crate::logged_scene::LoggedScene;
use crate::shown_set::ShownSet;
use crate::view::cameras::shots;
use crate::view::picture_flags::name;

const USUAL_PX: (u32, u32) = (1600, 900);

pub(crate) fn make(args: &ViewArgs, labels: &ShownSet, console: &Console) -> Result<(), Stop> {
    args.picture.check(args.log.is_some()).map_err(Stop::usage)?;
    let scene = labels.scene(args.scene.as_deref()).map_err(Stop::usage)?;
    let subject = Subject { args, labels, scene: &scene };
    let (picture, shown) = if args.picture.kind() == PictureArg::Strip {
        let keys = labels.keyframes(&scene.name, &args.keyframes).map_err(Stop::usage)?;
        (subject.strip(&keys)?, format!("{} keyframes", keys.len()))
    } else {
        let key = labels.keyframe(&scene.name, &args.keyframes).map_err(Stop::usage)?;
        (subject.of_keyframe(&key)?, format!("keyframe {}", key.token))
    };
    console.info(&format!("{}: {shown}", scene.name));
    Ok(write_file(&args.output, &png(&picture))?)
}

/// What is drawn of what.
struct Subject<'a> {
    args: &'a ViewArgs,
    labels: &'a ShownSet,
    scene: &'a ShownScene,
}

impl Subject<'_> {
    fn of_keyframe(&self, key: &KeyframeKey) -> Result<RgbImage, Stop> {
        match &self.args.picture.against {
            Some(against) => self.difference(key, against),
            None => self.of_one_set(key),
        }
    }

    fn of_one_set(&self, key: &KeyframeKey) -> Result<RgbImage, Stop> {
        let (flags, keyframe) = (&self.args.picture, self.labels.read(key)?);
        let labels = Painted::of(&keyframe, self.scene);
        let title = self.title(key, self.told());
        let plate = self.plate(&title);
        if let Some(log) = self.args.log.as_ref().filter(|_| flags.needs_log()) {
            return self.by_cameras(&plate, &labels, key, log);
        }
        Ok(match flags.kind() {
            PictureArg::BirdsEye => plate.birds_eye(&labels),
            PictureArg::Slices => plate.slices(&labels, flags.across()),
            PictureArg::Perspective => plate.perspective(&labels, &flags.aim()),
            _ => plate.sheet(&labels, &flags.aim()),
        })
    }

    fn by_cameras(
        &self,
        plate: &Plate,
        labels: &Painted,
        key: &KeyframeKey,
        log: &LogArgs,
    ) -> Result<RgbImage, Stop> {
        let args = self.args;
        let log = LoggedScene::open(log, &args.config, self.labels, &self.scene.name)?;
        let shots = shots(&log, &key.token, args.picture.camera.as_deref())?;
        let views: Vec<_> = shots.iter().map(|shot| shot.view()).collect();
        Ok(match args.picture.kind() {
            PictureArg::Perspective => plate.through_camera(labels, &views[0]),
            _ => plate.overlay(labels, &views),
        })
    }

    fn strip(&self, keys: &[KeyframeKey]) -> Result<RgbImage, Stop> {
        let [x_m, y_m, _] = self.extent_m();
        let what = format!("{} keyframes from above, up x {x_m}, left y {y_m} m", keys.len());
        let title = format!("{}: {what}", self.scene.name);
        let (plate, spec) = (self.plate(&title), self.labels.set.spec());
        let mut strip = Strip::new(plate, &self.scene.palette, spec, keys.len());
        let mut first = None;
        for key in keys {
            let keyframe = self.labels.read(key)?;
            let begin = *first.get_or_insert(keyframe.time);
            let since_s = begin.zip(keyframe.time).map(|(from, to)| to.seconds_apart(from));
            let time = since_s.map_or_else(String::new, |s| format!("{s:.1} s  "));
            let caption = format!("{time}{}", key.token);
            strip.add(&Painted::of(&keyframe, self.scene), &caption);
        }
        Ok(strip.finish())
    }

    fn difference(&self, key: &KeyframeKey, against: &Path) -> Result<RgbImage, Stop> {
        let args = &self.args.picture;
        let dialect = args.against_dialect.as_deref();
        let mine = (self.args.labels.as_path(), self.args.dialect.as_deref());
        let pairs = LabelPairs::open(mine, (against, dialect), &[]).map_err(Stop::usage)?;
        let pair = pairs.both.iter().find(|(one, _)| one == key);
        let other = pair.map(|(_, other)| other).ok_or_else(|| {
            let place = against.display().to_string();
            let expected = format!("the keyframe of {}", self.args.labels.display());
            Stop::usage(Fault::new("keyframe", place, expected, format!("no `{}`", key.token)))
        })?;
        let others = ShownSet::open(against, dialect).map_err(Stop::usage)?;
        let (from, to) = (self.labels.read(key)?, others.read(other)?);
        let sets =
            Difference { from: Painted::of(&from, self.scene), to: Painted::of(&to, self.scene) };
        let what = format!("A = {}, B = {}", self.args.labels.display(), against.display());
        let title = self.title(key, what);
        Ok(self.plate(&title).difference(&sets, &args.aim()))
    }

    fn plate<'a>(&self, title: &'a str) -> Plate<'a> {
        let (width, height) = self.args.picture.size.unwrap_or(USUAL_PX);
        Plate { width, height, title }
    }

    fn title(&self, key: &KeyframeKey, what: String) -> String {
        let scene = if self.scene.name.is_empty() { "" } else { &format!("{}, ", self.scene.name) };
        format!("{scene}keyframe {}: {what}", key.token)
    }

    /// Which way cuts lie, and how large they are.
    fn slices_told(&self) -> String {
        let extent = self.extent_m();
        match self.args.picture.across() {
            Across::X => format!("slices, up z {}, left y {} m", extent[2], extent[1]),
            Across::Y => format!("slices, up z {}, left x {} m", extent[2], extent[0]),
            Across::Z => format!("slices, up x {}, left y {} m", extent[0], extent[1]),
        }
    }

    fn extent_m(&self) -> [f64; 3] {
        let spec = self.labels.set.spec();
        (spec.max_m() - spec.min_m()).map(metres).into()
    }

    /// What the picture shows, for its title.
    fn told(&self) -> String {
        let args = &self.args.picture;
        match (args.kind(), &args.camera) {
            (PictureArg::Sheet, _) => "from above and as voxels".to_owned(),
            (PictureArg::BirdsEye, _) => "from above".to_owned(),
            (PictureArg::Perspective, None) => "voxels".to_owned(),
            (PictureArg::Perspective, Some(camera)) => format!("voxels as {camera} sees them"),
            (PictureArg::Overlay, _) => "labels over the images".to_owned(),
            (PictureArg::Slices, _) => self.slices_told(),
            (kind, _) => name(kind),
        }
    }
}

/// A length as a text, to the millimetre.
fn metres(length_m: f64) -> f64 {
    (length_m * 1000.0).round() / 1000.0
}
