//! Sweeps of a scene, one after the other.

use occlabel_core::{AggregatedScene, ClassId};

use crate::SplitSweep;

/// A scene of all its sorted sweeps, in their order.
pub fn accumulate(
    sweeps: impl IntoIterator<Item = SplitSweep>,
) -> AggregatedScene<Option<ClassId>> {
    let mut scene = AggregatedScene::new(Vec::new(), Vec::new());
    for sweep in sweeps {
        scene.background.push(sweep.background);
        scene.objects.extend(sweep.objects);
        scene.dropped += sweep.dropped;
    }
    scene
}
