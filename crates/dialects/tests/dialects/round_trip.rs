//! What was written is read back.

use std::collections::BTreeSet;

use occlabel_core::VoxelGrid;
use occlabel_dialects::{Dialect, Holds, IGNORED, KeyframeLabels, LabelSet, Layout, Note, Wanted};
use occlabel_labels::NumberArray;

use crate::support::{dialect, free, manifest, put, spec, write, write_manifest};

/// Numbers without a pattern, the same each time (SplitMix64).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) % limit
    }

    fn grid<T>(&mut self, mut value: impl FnMut(&mut Self) -> T) -> VoxelGrid<T> {
        let spec = spec();
        let values = (0..spec.len()).map(|_| value(self)).collect();
        VoxelGrid::from_values(&spec, values)
    }
}

/// Labels that say all that a dialect can say.
pub(crate) fn labels(dialect: &Dialect, random: &mut Random) -> KeyframeLabels {
    let free_index = dialect.classes.free_index();
    let mut labels = free(dialect, &spec());
    labels.semantics = random.grid(|random| match random.below(3) {
        0 => free_index,
        1 if dialect.classes.no_label.is_some() => IGNORED,
        _ => random.below(u64::from(free_index)) as u8,
    });
    let mask = |random: &mut Random| random.grid(|random| random.below(2) as u8);
    labels.mask_lidar = dialect.can_say(&Holds::MaskLidar).then(|| mask(random));
    labels.mask_camera = dialect.can_say(&Holds::MaskCamera).then(|| mask(random));
    if dialect.can_say(&Holds::Instances) {
        labels.instances = Some(random.grid(|random| random.below(65_536) as u16));
    }
    labels.flow = dialect.can_say(&Holds::Flow).then(|| flow(dialect, &labels, random));
    for array in dialect.layout.arrays() {
        if let Holds::Extra(name) = &array.holds {
            let sides = array.shape.clone().unwrap_or([4, 3, 2].to_vec());
            let components = (array.components > 0).then_some(array.components);
            let shape: Vec<usize> = sides.into_iter().chain(components).collect();
            let count = shape.iter().product();
            let values: Vec<u8> = (0..count).map(|_| random.below(2) as u8).collect();
            labels.extras.insert(name.clone(), NumberArray::new(&shape, &values));
        }
    }
    labels
}

/// Velocities with as many components as the dialect has, and none where it lists no voxel.
fn flow(dialect: &Dialect, labels: &KeyframeLabels, random: &mut Random) -> VoxelGrid<[f32; 3]> {
    let is_sparse = matches!(dialect.layout, Layout::Rows(_) | Layout::Indices(_));
    let is_flat = dialect.array_of(&Holds::Flow).is_some_and(|array| array.components == 2);
    labels.semantics.map(|&index| {
        let [x, y, z] = [0; 3].map(|_| random.below(1000) as f32 / 8.0 - 60.0);
        match is_sparse && index == dialect.classes.free_index() {
            true => [0.0; 3],
            false => [x, y, if is_flat { 0.0 } else { z }],
        }
    })
}

fn read_back(dialect: &Dialect, labels: &KeyframeLabels) -> KeyframeLabels {
    let (read, notes) = read_back_noting(dialect, labels);
    assert!(notes.is_empty(), "{notes:?}");
    read
}

/// What is read back, and what the writer noted.
pub(crate) fn read_back_noting(
    dialect: &Dialect,
    labels: &KeyframeLabels,
) -> (KeyframeLabels, BTreeSet<Note>) {
    let folder = tempfile::tempdir().unwrap();
    let encoded = write(folder.path(), dialect, labels, "s", "k");
    write_manifest(folder.path(), &manifest(&spec(), Some(&dialect.name)));
    let set = LabelSet::open(folder.path(), None).unwrap();
    assert_eq!(set.dialect().name, dialect.name);
    (set.read_with(&set.keyframes()[0], &Wanted::ALL).unwrap(), encoded.notes)
}

#[test]
fn what_a_dialect_can_say_survives_its_files() {
    let (mut random, mut tried) = (Random(6), 0);
    for _ in 0..20 {
        for dialect in Dialect::all() {
            let labels = labels(&dialect, &mut random);
            assert_eq!(read_back(&dialect, &labels), labels, "{}", dialect.name);
            tried += 1;
        }
    }
    assert_eq!(tried, 20 * 14);
}

#[test]
fn the_same_labels_give_the_same_bytes() {
    for dialect in Dialect::all() {
        let encode = || dialect.encode(&labels(&dialect, &mut Random(1)), "s", "k").unwrap();
        assert_eq!(encode(), encode(), "{}", dialect.name);
    }
}

#[test]
fn fault_34_damaged_files_are_read_or_refused_and_nothing_else() {
    let (mut random, mut refused, mut tried) = (Random(9), 0, 0);
    for dialect in Dialect::all() {
        let folder = tempfile::tempdir().unwrap();
        let files = write(folder.path(), &dialect, &labels(&dialect, &mut random), "s", "k").files;
        write_manifest(folder.path(), &manifest(&spec(), Some(&dialect.name)));
        let set = LabelSet::open(folder.path(), None).unwrap();
        for (path, bytes) in files.iter().cycle().take(60) {
            put(folder.path(), path.as_str(), &damaged(bytes, &mut random));
            let read = set.read_with(&set.keyframes()[0], &Wanted::ALL);
            refused += usize::from(read.is_err());
            put(folder.path(), path.as_str(), bytes);
            tried += 1;
        }
    }
    assert!(tried == 60 * 14 && refused > tried / 3 && refused < tried, "{refused} of {tried}");
}

/// Bytes of which some are others, or of which the end is missing.
fn damaged(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    if random.below(4) == 0 {
        bytes.truncate(random.below(bytes.len() as u64) as usize);
        return bytes;
    }
    for _ in 0..=random.below(3) {
        let at = random.below(bytes.len() as u64) as usize;
        bytes[at] = random.below(256) as u8;
    }
    bytes
}

#[test]
fn extras_keep_their_type_and_their_numbers() {
    let waymo = dialect("occ3d-waymo");
    let mut labels = free(&waymo, &spec());
    labels.mask_lidar = Some(VoxelGrid::filled(&spec(), 1));
    labels.mask_camera = labels.mask_lidar.clone();
    let pose: Vec<f32> = (0..16).map(|at| at as f32 * 1e5 + 0.5).collect();
    labels.extras.insert("ego2global".to_owned(), NumberArray::new(&[4, 4], &pose));
    labels.extras.insert("infov".to_owned(), NumberArray::new(&[4, 3, 2], &[1_i32; 24]));
    assert_eq!(read_back(&waymo, &labels), labels);
}

#[test]
fn only_what_is_wanted_is_read() {
    let openocc = dialect("openocc-v2");
    let labels = labels(&openocc, &mut Random(3));
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &openocc, &labels, "s", "k");
    let set = LabelSet::open(folder.path(), Some("openocc-v2")).unwrap();
    let read = set.read(&set.keyframes()[0]).unwrap();
    assert_eq!(read.semantics.values(), labels.semantics.values());
    assert!(read.flow.is_none() && read.instances.is_none());
}
