//! Labels as a PNG.

use image::RgbImage;
use occlabel_core::Fault;
use occlabel_dialects::KeyframeKey;
use occlabel_labels::write_file;
use occlabel_view::{Difference, Page, Painted, ShownKeyframe, ShownScene, Strip, png};

use crate::args::{PictureArg, ViewArgs};
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
    let keys = labels.keyframes(&scene.name, &args.keyframes).map_err(Stop::usage)?;
    let Some(key) = keys.get(keys.len() / 2) else { return Ok(()) };
    let subject = Subject { args, labels, scene: &scene };
    let picture = match args.picture.kind() {
        PictureArg::Strip => subject.strip(&keys)?,
        PictureArg::Difference => subject.difference(key)?,
        _ => subject.of_keyframe(key)?,
    };
    console.info(&format!("{}: keyframe {}", scene.name, key.token));
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
        let (flags, keyframe) = (&self.args.picture, self.labels.read(key)?);
        let labels = Painted::of(&keyframe, self.scene);
        let title = self.title(key, self.told());
        let page = self.page(&title);
        Ok(match flags.kind() {
            PictureArg::BirdsEye => page.birds_eye(&labels),
            PictureArg::Slices => page.slices(&labels, flags.across()),
            PictureArg::Overlay => self.by_cameras(&page, &labels, key)?,
            PictureArg::Perspective if flags.camera.is_some() => {
                self.by_cameras(&page, &labels, key)?
            }
            PictureArg::Perspective => page.perspective(&labels, &flags.aim()),
            _ => page.sheet(&labels, &flags.aim()),
        })
    }

    fn by_cameras(
        &self,
        page: &Page,
        labels: &Painted,
        key: &KeyframeKey,
    ) -> Result<RgbImage, Stop> {
        let args = self.args;
        let Some(log) = &args.log else { return Err(Stop::usage(no_log())) };
        let log = LoggedScene::open(log, &args.config, self.labels, &self.scene.name)?;
        let shots = shots(&log, &key.token, args.picture.camera.as_deref())?;
        let views: Vec<_> = shots.iter().map(|shot| shot.view()).collect();
        Ok(match args.picture.kind() {
            PictureArg::Perspective => page.through_camera(labels, &views[0]),
            _ => page.overlay(labels, &views),
        })
    }

    fn strip(&self, keys: &[KeyframeKey]) -> Result<RgbImage, Stop> {
        let title = format!("{}: {} keyframes from above", self.scene.name, keys.len());
        let mut strip = Strip::new(self.page(&title), self.labels.set.spec(), keys.len());
        let (mut first, mut last) = (None, None);
        for key in keys {
            let keyframe = self.labels.read(key)?;
            let begin = *first.get_or_insert(keyframe.time);
            let since_s = begin.zip(keyframe.time).map(|(from, to)| to.seconds_apart(from));
            let time = since_s.map_or_else(String::new, |s| format!("{s:.1} s  "));
            let caption = format!("{time}{}", key.token);
            strip.add(&Painted::of(&keyframe, self.scene), &caption);
            last = Some(keyframe);
        }
        let last: ShownKeyframe = last.ok_or_else(|| Stop::usage(no_log()))?;
        Ok(strip.finish(&Painted::of(&last, self.scene)))
    }

    fn difference(&self, key: &KeyframeKey) -> Result<RgbImage, Stop> {
        let args = &self.args.picture;
        let Some(against) = args.against.as_deref() else { return Err(Stop::usage(no_log())) };
        let dialect = args.against_dialect.as_deref();
        let mine = (self.args.labels.as_path(), self.args.dialect.as_deref());
        let pairs = LabelPairs::open(mine, (against, dialect), &[]).map_err(Stop::usage)?;
        let pair = pairs.both.iter().find(|(one, _)| one == key);
        let other = pair.map(|(_, other)| other).ok_or_else(|| {
            let found = format!("no keyframe {}", key.token);
            Stop::usage(Fault::new("keyframe", against.display().to_string(), "it there", found))
        })?;
        let others = ShownSet::open(against, dialect).map_err(Stop::usage)?;
        let (from, to) = (self.labels.read(key)?, others.read(other)?);
        let sets =
            Difference { from: Painted::of(&from, self.scene), to: Painted::of(&to, self.scene) };
        let what = format!("{} against {}", self.args.labels.display(), against.display());
        let title = self.title(key, what);
        Ok(self.page(&title).difference(&sets, &args.aim()))
    }

    fn page<'a>(&self, title: &'a str) -> Page<'a> {
        let (width, height) = self.args.picture.size.unwrap_or(USUAL_PX);
        Page { width, height, title }
    }

    fn title(&self, key: &KeyframeKey, what: String) -> String {
        let scene = if self.scene.name.is_empty() { "" } else { &format!("{}, ", self.scene.name) };
        format!("{scene}keyframe {}: {what}", key.token)
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
            (kind, _) => name(kind),
        }
    }
}

fn no_log() -> Fault {
    Fault::new("flag", "view", "what the picture needs", "nothing")
}
