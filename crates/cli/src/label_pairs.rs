//! Two label sets of one grid and the same classes, keyframe by keyframe.

use std::collections::BTreeMap;
use std::path::Path;

use occlabel_core::Fault;
use occlabel_dialects::{KeyframeKey, LabelSet};

/// Two label sets, with the keyframes that both have.
pub(crate) struct LabelPairs {
    pub(crate) a: LabelSet,
    pub(crate) b: LabelSet,
    /// The same keyframe as either set names it.
    pub(crate) both: Vec<(KeyframeKey, KeyframeKey)>,
    pub(crate) only_a: Vec<KeyframeKey>,
    pub(crate) only_b: Vec<KeyframeKey>,
}

/// A label set's folder, and its dialect if it is told.
pub(crate) type Folder<'a> = (&'a Path, Option<&'a str>);

impl LabelPairs {
    /// Opens both sets and pairs their keyframes, of these scenes if any are named.
    ///
    /// # Errors
    /// If one cannot be opened, or their grids or classes differ.
    pub(crate) fn open(a: Folder, b: Folder, scenes: &[String]) -> Result<Self, Fault> {
        let [a, b] = [LabelSet::open(a.0, a.1)?, LabelSet::open(b.0, b.1)?];
        check_grids(&a, &b)?;
        check_classes(&a, &b)?;
        let is_wanted = |key: &&KeyframeKey| scenes.is_empty() || scenes.contains(&key.scene);
        let mut others = ByName::new(b.keyframes().iter());
        let (mut both, mut only_a) = (Vec::new(), Vec::new());
        for key in a.keyframes().iter().filter(is_wanted) {
            match others.take(key)? {
                Some(other) => both.push((key.clone(), other)),
                None => only_a.push(key.clone()),
            }
        }
        let only_b = others.rest().filter(is_wanted).cloned().collect();
        Ok(Self { a, b, both, only_a, only_b })
    }
}

/// Keyframes by scene and token; by the token alone where folders do not tell the scene.
struct ByName<'a>(BTreeMap<&'a str, Vec<&'a KeyframeKey>>);

impl<'a> ByName<'a> {
    fn new(keys: impl Iterator<Item = &'a KeyframeKey>) -> Self {
        let mut by_token: BTreeMap<&str, Vec<&KeyframeKey>> = BTreeMap::new();
        keys.for_each(|key| by_token.entry(&key.token).or_default().push(key));
        Self(by_token)
    }

    /// The same keyframe, if it is there.
    fn take(&mut self, key: &KeyframeKey) -> Result<Option<KeyframeKey>, Fault> {
        let Some(keys) = self.0.get_mut(key.token.as_str()) else { return Ok(None) };
        let is_same = |other: &KeyframeKey| {
            other.scene == key.scene || other.scene.is_empty() || key.scene.is_empty()
        };
        let found: Vec<usize> = (0..keys.len()).filter(|&at| is_same(keys[at])).collect();
        match found[..] {
            [] => Ok(None),
            [at] => Ok(Some(keys.remove(at).clone())),
            _ => Err(ambiguous(key, found.len())),
        }
    }

    fn rest(self) -> impl Iterator<Item = &'a KeyframeKey> {
        self.0.into_values().flatten()
    }
}

fn ambiguous(key: &KeyframeKey, scenes: usize) -> Fault {
    let expected = "a token in one scene, where the other set's files name no scene";
    Fault::new("token", "the second label set", expected, format!("it in {scenes} scenes"))
        .record(&key.token)
        .hint("compare --scenes one by one")
}

fn check_grids(a: &LabelSet, b: &LabelSet) -> Result<(), Fault> {
    if a.spec() == b.spec() && a.frame() == b.frame() {
        return Ok(());
    }
    Err(Fault::new("grids-differ", "the second label set", grid(a), grid(b)))
}

fn grid(set: &LabelSet) -> String {
    let (spec, frame) = (set.spec(), set.frame());
    let [x, y, z] = spec.shape();
    let (min, size) = (spec.min_m(), spec.size_m());
    format!(
        "{x} x {y} x {z} voxels of {} x {} x {} m from ({}, {}, {}) in the {frame} frame",
        size.x, size.y, size.z, min.x, min.y, min.z
    )
}

fn check_classes(a: &LabelSet, b: &LabelSet) -> Result<(), Fault> {
    let [expected, found] = [a, b].map(|set| set.classes().names().join(", "));
    match expected == found {
        true => Ok(()),
        false => Err(Fault::new("classes-differ", "the second label set", expected, found)
            .hint("`occlabel convert` brings one to the classes of the other")),
    }
}
