//! Points with numbers to each, packed one after the other: in point clouds and in PLY files alike.

use crate::{ShownKeyframe, ShownScene};

/// How a number is stored, little-endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    U8,
    U16,
    F32,
}

impl Kind {
    pub(crate) fn bytes(self) -> u32 {
        match self {
            Self::U8 => 1,
            Self::U16 => 2,
            Self::F32 => 4,
        }
    }
}

/// A number's name and how it is stored.
pub(crate) type Column = (&'static str, Kind);

pub(crate) const POSITION: [Column; 3] = [("x", Kind::F32), ("y", Kind::F32), ("z", Kind::F32)];
pub(crate) const COLOR: [Column; 4] =
    [("red", Kind::U8), ("green", Kind::U8), ("blue", Kind::U8), ("alpha", Kind::U8)];

/// Rows of the same numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Rows {
    pub(crate) columns: Vec<Column>,
    pub(crate) bytes: Vec<u8>,
}

impl Rows {
    pub(crate) fn new(columns: impl IntoIterator<Item = Column>) -> Self {
        Self { columns: columns.into_iter().collect(), bytes: Vec::new() }
    }

    /// Bytes of a row.
    pub(crate) fn stride(&self) -> u32 {
        self.columns.iter().map(|(_, kind)| kind.bytes()).sum()
    }

    /// How many rows there are.
    pub(crate) fn len(&self) -> usize {
        self.bytes.len() / self.stride() as usize
    }

    pub(crate) fn position(&mut self, position: [f64; 3]) {
        self.bytes.extend(position.into_iter().flat_map(|m| (m as f32).to_le_bytes()));
    }

    pub(crate) fn byte(&mut self, value: u8) {
        self.bytes.push(value);
    }

    pub(crate) fn short(&mut self, value: u16) {
        self.bytes.extend(value.to_le_bytes());
    }

    /// A colour that covers.
    pub(crate) fn color(&mut self, [red, green, blue]: [u8; 3]) {
        self.bytes.extend([red, green, blue, 255]);
    }
}

/// The occupied voxels of a keyframe, in flat order: centre in the grid frame, class, colour; the track
/// where there are instances, hits and crossings where there is evidence.
pub(crate) fn occupied_rows(keyframe: &ShownKeyframe, scene: &ShownScene) -> Rows {
    let mut rows = Rows::new(POSITION.into_iter().chain([("class", Kind::U8)]).chain(COLOR));
    let instances = keyframe.instances.as_ref().map(|grid| ("track", grid));
    let evidence = keyframe.evidence.as_ref();
    let counts = evidence.map(|evidence| ("hits", &evidence.hits));
    let crossings = evidence.map(|evidence| ("crossings", &evidence.crossings));
    let shorts: Vec<_> = [instances, counts, crossings].into_iter().flatten().collect();
    rows.columns.extend(shorts.iter().map(|(name, _)| (*name, Kind::U16)));
    for (flat, &class) in keyframe.semantics.values().iter().enumerate() {
        if scene.is_occupied(class) {
            let centre = keyframe.spec.centre(keyframe.spec.voxel_at(flat));
            rows.position(centre.coords.into());
            rows.byte(class);
            rows.color(scene.palette.color(class));
            shorts.iter().for_each(|(_, grid)| rows.short(grid.values()[flat]));
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use occlabel_core::{GridSpec, VoxelGrid};

    use super::*;
    use crate::testing::{shown_keyframe, shown_scene};
    use crate::{NO_LABEL, ShownEvidence};

    #[test]
    fn rows_are_the_occupied_voxels_with_what_is_known_of_each() {
        let spec = GridSpec::new([0.0; 3], [1.0, 1.0, 2.0], [0.5, 1.0, 1.0]).unwrap();
        let scene = shown_scene();
        let semantics = VoxelGrid::from_values(&spec, vec![scene.free, 1, NO_LABEL, 0]);
        let counts = VoxelGrid::from_values(&spec, vec![1, 2, 3, 0x405]);
        let mut keyframe = shown_keyframe(&spec, semantics);
        assert_eq!(occupied_rows(&keyframe, &scene).len(), 2);
        keyframe.instances = Some(VoxelGrid::from_values(&spec, vec![0, 7, 0, 0]));
        let (hits, crossings) = (counts.clone(), counts.map(|count| count + 1));
        keyframe.evidence = Some(ShownEvidence { hits, crossings, camera_bits: counts });
        let rows = occupied_rows(&keyframe, &scene);
        let names: Vec<_> = rows.columns.iter().map(|(name, _)| *name).collect();
        let known =
            ["x", "y", "z", "class", "red", "green", "blue", "alpha", "track", "hits", "crossings"];
        assert_eq!((names, rows.stride()), (known.to_vec(), 23));
        let row = |centre: [f32; 3], class: u8, shorts: [u16; 3]| {
            let [red, green, blue] = scene.palette.color(class);
            let place = centre.into_iter().flat_map(f32::to_le_bytes);
            let look = [class, red, green, blue, 255];
            place
                .chain(look)
                .chain(shorts.into_iter().flat_map(u16::to_le_bytes))
                .collect::<Vec<u8>>()
        };
        let first = row([0.25, 0.5, 1.5], 1, [7, 2, 3]);
        assert_eq!(rows.bytes, [first, row([0.75, 0.5, 1.5], 0, [0, 0x405, 0x406])].concat());
    }
}
