//! What a reader should look at first.

use super::run::{Run, RunScene};
use super::strays::{FEWEST, Stray, strays};
use super::totals::VoxelTotals;

/// So many thumbnails are shown at most; a page of any run stays small.
const MOST_THUMBNAILS: usize = 150;
/// So many of one scene, at most.
const MOST_OF_SCENE: usize = 4;
/// So many keyframes and scenes are told of at the top, at most.
pub(crate) const MOST_ITEMS: usize = 24;

/// Which keyframe: places in the run's scenes and in the scene's keyframes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct KeyframeAt {
    /// The place of the scene.
    pub scene: usize,
    /// The place of the keyframe in it.
    pub keyframe: usize,
}

/// What strays, and in which order scenes are told.
pub(crate) struct Attention {
    /// The farthest first.
    pub(crate) items: Vec<Item>,
    /// Places of scenes: first those that lost something, then those that stray, then those with
    /// warnings.
    pub(crate) scenes: Vec<usize>,
    /// How many things of each scene stray.
    pub(crate) strays_of: Vec<usize>,
}

/// A keyframe or a scene that strays.
pub(crate) struct Item {
    pub(crate) scene: usize,
    /// `None`: the scene as a whole.
    pub(crate) keyframe: Option<usize>,
    /// At least one; the farthest first.
    pub(crate) strays: Vec<Stray>,
    /// Whether it strays from the rest of its scene, else from the rest of the run.
    pub(crate) in_scene: bool,
}

impl Attention {
    pub(crate) fn of(run: &Run) -> Self {
        let mut items = keyframe_items(run);
        items.extend(scene_items(run));
        items.sort_by(|a, b| b.times().total_cmp(&a.times()));
        let mut strays_of = vec![0; run.scenes.len()];
        items.iter().for_each(|item| strays_of[item.scene] += 1);
        let scenes = scene_order(run, &items);
        Self { items, scenes, strays_of }
    }
}

impl Item {
    fn times(&self) -> f64 {
        self.strays.first().map_or(0.0, |stray| stray.times)
    }
}

impl Run {
    /// The keyframes whose thumbnails the page shows, in no order: those that stray, and a few of each
    /// scene; at most 150.
    pub fn wanted_thumbnails(&self) -> Vec<KeyframeAt> {
        let attention = Attention::of(self);
        let mut wanted: Vec<KeyframeAt> = Vec::new();
        let told = attention.items.iter().take(MOST_ITEMS).filter_map(|item| item.shown(self));
        let each = (MOST_THUMBNAILS / self.scenes.len().max(1)).clamp(1, MOST_OF_SCENE);
        let some = attention.scenes.iter().flat_map(|&scene| {
            let count = self.scenes[scene].keyframes.len();
            spread(count, each).map(move |keyframe| KeyframeAt { scene, keyframe })
        });
        for at in told.chain(some) {
            if !wanted.contains(&at) && wanted.len() < MOST_THUMBNAILS {
                wanted.push(at);
            }
        }
        wanted
    }
}

impl Item {
    /// The keyframe that shows it: itself, or the middle one of the scene.
    pub(crate) fn shown(&self, run: &Run) -> Option<KeyframeAt> {
        let count = run.scenes[self.scene].keyframes.len();
        let keyframe = self.keyframe.unwrap_or(count / 2);
        (keyframe < count).then_some(KeyframeAt { scene: self.scene, keyframe })
    }
}

/// Places of at most so many of a count, evenly spread.
fn spread(count: usize, most: usize) -> impl Iterator<Item = usize> {
    let shown = count.min(most);
    (0..shown).map(move |i| (2 * i + 1) * count / (2 * shown))
}

/// Keyframes that stray from the rest of their scene, or of the run where scenes are too short.
fn keyframe_items(run: &Run) -> Vec<Item> {
    let (long, short): (Vec<usize>, Vec<usize>) =
        (0..run.scenes.len()).partition(|&scene| run.scenes[scene].keyframes.len() >= FEWEST);
    let of_scene = |scene: usize| {
        let keyframes = 0..run.scenes[scene].keyframes.len();
        keyframes.map(move |keyframe| KeyframeAt { scene, keyframe })
    };
    let long = long.into_iter().flat_map(|scene| items_of(run, of_scene(scene).collect(), true));
    let rest = short.into_iter().flat_map(of_scene).collect();
    long.chain(items_of(run, rest, false)).collect()
}

fn items_of(run: &Run, places: Vec<KeyframeAt>, in_scene: bool) -> Vec<Item> {
    let totals = |at: &KeyframeAt| &run.scenes[at.scene].keyframes[at.keyframe].totals;
    let found = strays(&places.iter().map(totals).collect::<Vec<_>>());
    let item = |(at, strays): (KeyframeAt, Vec<Stray>)| {
        let KeyframeAt { scene, keyframe } = at;
        (!strays.is_empty()).then_some(Item { scene, keyframe: Some(keyframe), strays, in_scene })
    };
    places.into_iter().zip(found).filter_map(item).collect()
}

/// Scenes that stray from the rest of the run.
fn scene_items(run: &Run) -> Vec<Item> {
    let totals: Vec<VoxelTotals> = run.scenes.iter().map(|scene| scene.totals()).collect();
    let labelled: Vec<usize> = (0..totals.len()).filter(|&i| totals[i].voxels() > 0).collect();
    let found = strays(&labelled.iter().map(|&scene| &totals[scene]).collect::<Vec<_>>());
    let item = |(scene, strays): (usize, Vec<Stray>)| {
        (!strays.is_empty()).then_some(Item { scene, keyframe: None, strays, in_scene: false })
    };
    labelled.into_iter().zip(found).filter_map(item).collect()
}

fn scene_order(run: &Run, items: &[Item]) -> Vec<usize> {
    let rank = |scene: usize| {
        let RunScene { name, unreadable, .. } = &run.scenes[scene];
        let lost = !unreadable.is_empty() || run.remarks_of(name).any(|remark| remark.is_loss);
        let stray = items.iter().position(|item| item.scene == scene).unwrap_or(usize::MAX);
        let warned = run.remarks_of(name).next().is_some();
        (!lost, stray, !warned, scene)
    };
    let mut order: Vec<usize> = (0..run.scenes.len()).collect();
    order.sort_by_cached_key(|&scene| rank(scene));
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::run::{Remark, RunKeyframe};

    fn keyframe(occupied: u64) -> RunKeyframe {
        let totals = VoxelTotals {
            by_class: vec![occupied],
            free: 20_000,
            unobserved: 80_000 - occupied,
            seen_by_cameras: None,
        };
        RunKeyframe { token: format!("k{occupied}"), totals }
    }

    fn scene(name: &str, occupied: &[u64]) -> RunScene {
        let keyframes = occupied.iter().map(|&count| keyframe(count)).collect();
        RunScene { name: name.into(), keyframes, ..RunScene::default() }
    }

    #[test]
    fn a_planted_keyframe_is_first_and_scenes_that_lost_something_come_before_it() {
        let usual = [1000, 1010, 990, 1005, 995];
        let mut run = Run {
            scenes: ["a", "b", "c", "d"].map(|name| scene(name, &usual)).to_vec(),
            ..Run::default()
        };
        run.scenes[2].keyframes[3] = keyframe(300);
        run.scenes[1].keyframes[0] = keyframe(1300);
        let remark = |is_loss, scene: &str| Remark {
            is_loss,
            rule: "r".into(),
            scene: scene.into(),
            text: String::new(),
        };
        run.remarks = vec![remark(true, "d"), remark(false, "a")];
        let attention = Attention::of(&run);
        let items: Vec<_> = attention.items.iter().map(|i| (i.scene, i.keyframe)).collect();
        assert_eq!(items, [(2, Some(3)), (1, Some(0))]);
        assert_eq!(attention.scenes, [3, 2, 1, 0]);
        assert_eq!(attention.strays_of, [0, 1, 1, 0]);
        assert_eq!(run.wanted_thumbnails()[0], KeyframeAt { scene: 2, keyframe: 3 });
    }

    #[test]
    fn thumbnails_are_bounded_and_each_scene_has_one_as_long_as_there_is_room() {
        let few = Run { scenes: vec![scene("a", &[1000; 9])], ..Run::default() };
        assert_eq!(few.wanted_thumbnails().len(), MOST_OF_SCENE);
        let scenes = (0..700).map(|i| scene(&i.to_string(), &[1000; 3])).collect();
        let many = Run { scenes, ..Run::default() };
        let wanted = many.wanted_thumbnails();
        assert_eq!(wanted.len(), MOST_THUMBNAILS);
        assert!(wanted.iter().all(|at| at.keyframe == 1), "the middle of three");
        assert_eq!(spread(10, 4).collect::<Vec<_>>(), [1, 3, 6, 8]);
    }
}
