//! What labels and truth have to be before they are judged.

use occlabel_core::{Fault, VoxelGrid};

use super::judge::{JudgedLabels, KnownWorld};
use super::scale::Scale;

/// Checks that all grids have the scale's shape, and that every class has a name.
pub(super) fn check(labels: &JudgedLabels, known: &KnownWorld, scale: &Scale) -> Result<(), Fault> {
    let shapes = [
        ("semantics", labels.semantics.shape()),
        ("mask_lidar", labels.mask_lidar.shape()),
        ("mask_camera", labels.mask_camera.shape()),
        ("flow", labels.flow.map_or(scale.spec.shape(), VoxelGrid::shape)),
        ("truth", known.truth.shape()),
    ];
    for (place, found) in shapes {
        check_shape(place, found, scale)?;
    }
    let labelled = labels.semantics.values().iter().filter(|class| **class != scale.free);
    let truth = known.truth.values().iter().filter_map(|truth| Some(truth.class?.0));
    check_classes("semantics", labelled.copied(), scale)?;
    check_classes("truth", truth, scale)
}

fn check_shape(place: &str, found: [usize; 3], scale: &Scale) -> Result<(), Fault> {
    let name = |[x, y, z]: [usize; 3]| format!("{x} x {y} x {z} voxels");
    match scale.spec.shape() {
        expected if expected == found => Ok(()),
        expected => Err(Fault::new("judged-shape", place, name(expected), name(found))),
    }
}

fn check_classes(
    place: &str,
    mut classes: impl Iterator<Item = u8>,
    scale: &Scale,
) -> Result<(), Fault> {
    let named = scale.classes.len();
    let Some(strange) = classes.find(|class| usize::from(*class) >= named) else {
        return Ok(());
    };
    let expected = format!("class ids below {named}, or {} for free", scale.free);
    Err(Fault::new("judged-class", place, expected, format!("class {strange}")))
}
