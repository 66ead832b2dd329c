//! Files of every dialect are known for what they are.

use std::fs;
use std::path::{Path, PathBuf};

use occlabel_core::{GridSpec, VoxelGrid};
use occlabel_dialects::{Class, Dialect, Holds, KeyframeLabels};

use crate::{describe, rules_of};

/// Ground of a class below, all else free, all observed.
fn labels(dialect: &Dialect, spec: &GridSpec) -> KeyframeLabels {
    let free = dialect.classes.free_index();
    let is_road = |class: &Class| matches!(class.concept(), Some("road" | "background"));
    let road = dialect.classes.list.iter().position(is_road).expect("a ground") as u8;
    let class = |flat: usize| if flat.is_multiple_of(spec.shape()[2]) { road } else { free };
    let semantics = VoxelGrid::from_values(spec, (0..spec.len()).map(class).collect());
    let ones = || Some(VoxelGrid::filled(spec, 1));
    let mut labels = KeyframeLabels::of_semantics(spec.clone(), semantics);
    labels.mask_lidar = dialect.can_say(&Holds::MaskLidar).then(ones).flatten();
    labels.mask_camera = dialect.can_say(&Holds::MaskCamera).then(ones).flatten();
    let still = || Some(VoxelGrid::filled(spec, [0.0; 3]));
    labels.flow = dialect.can_say(&Holds::Flow).then(still).flatten();
    labels
}

/// Writes a keyframe, and gives the place of the file with its classes.
fn written(dialect: &Dialect, root: &Path) -> PathBuf {
    let spec = dialect.grid.spec().expect("a grid");
    let encoded = dialect.encode(&labels(dialect, &spec), "00", "000005").expect("files");
    for (path, bytes) in &encoded.files {
        let place = root.join(path.as_str());
        fs::create_dir_all(place.parent().expect("a folder")).expect("a folder");
        fs::write(place, bytes).expect("a file");
    }
    let is_classes = |path: &&str| {
        let name = path.rsplit(['/', '_']).next().unwrap_or_default();
        !matches!(name, "000005.bin" | "000005.invalid" | "000005.occluded" | "invalid.npy")
            && !path.ends_with("flow_final.npy")
    };
    let mut paths = encoded.files.iter().map(|(path, _)| path.as_str());
    root.join(paths.find(is_classes).expect("a file of classes"))
}

#[test]
fn a_file_at_its_place_looks_like_its_dialect_and_nothing_else() {
    let mut known = 0;
    for dialect in Dialect::all().iter().filter(|dialect| dialect.name != "occ3d-waymo-fine") {
        let root = tempfile::tempdir().expect("a folder");
        let told = describe(&written(dialect, root.path()));
        assert_eq!(told.dialects, [dialect.name.as_str()], "{told}");
        assert_eq!(rules_of(&told), [""; 0], "{told}");
        let contents = told.contents.expect("contents");
        let [x, y, z] = contents.grid.shape;
        assert_eq!(contents.states.occupied as usize, x * y, "{}", dialect.name);
        let told_free = contents.states.free as usize;
        assert_eq!(told_free, x * y * (z - 1), "{}", dialect.name);
        assert_eq!(contents.free, dialect.classes.free);
        known += 1;
    }
    assert_eq!(known, Dialect::names().len() - 1);
}
