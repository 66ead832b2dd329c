//! What is converted into what.

use std::collections::{BTreeMap, BTreeSet};

use occlabel_core::Fault;
use occlabel_dialects::{ClassMap, Dialect, KeyframeKey, LabelSet};
use occlabel_labels::{Manifest, SceneRecord};

use crate::args::ConvertArgs;
use crate::exit::Stop;

/// What stands for the scene where the dialect that is read does not tell it.
pub(crate) const NO_SCENE: &str = "all";

/// What every part of the command needs.
pub(crate) struct Job<'a> {
    pub(crate) args: &'a ConvertArgs,
    pub(crate) set: LabelSet,
    pub(crate) to: Dialect,
    pub(crate) map: ClassMap,
    /// The keyframes to convert, scene by scene.
    pub(crate) keys: Vec<KeyframeKey>,
    /// What the labels' own manifest says of scenes.
    pub(crate) scenes: BTreeMap<String, SceneRecord>,
}

impl<'a> Job<'a> {
    /// Opens the labels, and makes sure that each keyframe gets a file of its own.
    pub(crate) fn plan(args: &'a ConvertArgs) -> Result<Self, Stop> {
        let to = Dialect::named(&args.to).map_err(Stop::usage)?;
        let set = LabelSet::open(&args.input, args.from.as_deref())?;
        let map = ClassMap::between(set.classes(), &to.classes, &args.map).map_err(Stop::usage)?;
        let keys = chosen(&set, args).map_err(Stop::usage)?;
        check_tokens(&to, &keys)?;
        let manifest = Manifest::load_tree(&args.input)?;
        let scenes = manifest.map(|manifest| manifest.scenes).unwrap_or_default();
        Ok(Self { args, set, to, map, keys, scenes })
    }

    /// The scene of a keyframe in the tree that is written.
    pub(crate) fn scene_of<'k>(&self, key: &'k KeyframeKey) -> &'k str {
        if key.scene.is_empty() { NO_SCENE } else { &key.scene }
    }
}

/// The keyframes of the scenes asked for.
fn chosen(set: &LabelSet, args: &ConvertArgs) -> Result<Vec<KeyframeKey>, Fault> {
    let known: BTreeSet<&str> = set.keyframes().iter().map(|key| key.scene.as_str()).collect();
    if let Some(absent) = args.scenes.iter().find(|scene| !known.contains(scene.as_str())) {
        let place = args.input.display().to_string();
        let known = known.into_iter().collect::<Vec<_>>().join(", ");
        return Err(Fault::new("scene", place, format!("one of {known}"), format!("`{absent}`")));
    }
    let is_chosen = |key: &&KeyframeKey| args.scenes.is_empty() || args.scenes.contains(&key.scene);
    Ok(set.keyframes().iter().filter(is_chosen).cloned().collect())
}

/// Refuses tokens that two scenes share where the files tell no scene.
fn check_tokens(to: &Dialect, keys: &[KeyframeKey]) -> Result<(), Fault> {
    if to.layout.path().contains("{scene}") {
        return Ok(());
    }
    let mut tokens = BTreeSet::new();
    match keys.iter().find(|key| !tokens.insert(&key.token)) {
        None => Ok(()),
        Some(key) => {
            let expected = "every token once, as the files tell no scene";
            let found = format!("`{}` in several scenes", key.token);
            Err(Fault::new("token", &to.name, expected, found).hint("convert --scenes one by one"))
        }
    }
}
