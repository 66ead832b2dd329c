//! How complete each mover is.

use std::collections::BTreeMap;

use super::judge::{JudgedLabels, KnownWorld};
use super::scale::Scale;
use super::share::Share;
use super::tally::ObjectTally;

/// Of each mover in the grid: of its voxels that some ray ended in, those labelled occupied (A9).
pub(super) fn objects(
    labels: &JudgedLabels,
    known: &KnownWorld,
    scale: &Scale,
) -> BTreeMap<(String, u16), ObjectTally> {
    let [_, ny, nz] = scale.spec.shape();
    let mut objects: BTreeMap<u16, ObjectTally> = BTreeMap::new();
    let voxels = known.truth.values().iter().zip(labels.semantics.values()).enumerate();
    for (flat, (truth, semantics)) in voxels {
        let Some(track) = truth.instance.filter(|_| truth.ends > 0) else {
            continue;
        };
        let object = objects.entry(track.0).or_insert_with(|| unseen(scale));
        let column = flat / nz;
        object.rings[scale.ring(column / ny, column % ny)].count(*semantics != scale.free);
        object.class = object.class.into_iter().chain(truth.class).min();
    }
    objects.into_iter().map(|(track, object)| ((known.scene.into(), track), object)).collect()
}

fn unseen(scale: &Scale) -> ObjectTally {
    ObjectTally { class: None, rings: vec![Share::default(); scale.ring_m.len() + 1] }
}
