//! Configurations and taxonomies.

use std::sync::{Arc, LazyLock};

use occlabel_core::Taxonomy;

use crate::{Autos, Config, PRESETS, Rules, TAXONOMIES, parse_taxonomy, preset, shipped_taxonomy};

pub(super) static TAXONOMY: LazyLock<Arc<Taxonomy>> = LazyLock::new(|| {
    let text = shipped_taxonomy("occ3d-nuscenes").unwrap();
    parse_taxonomy(text, "").unwrap().into()
});

/// By the first byte: a whole configuration, a file over a preset, or settings of single keys.
pub(super) fn config(bytes: &[u8]) -> bool {
    let Some((&kind, text)) = bytes.split_first() else { return false };
    let (base, text) = (preset("precise").unwrap(), String::from_utf8_lossy(text));
    let settings: Vec<String> = text.lines().map(str::to_owned).collect();
    let config = match kind % 3 {
        0 => Config::parse(&text, ""),
        1 => Config::from_layers("", base, Some(&text), &[]),
        _ => Config::from_layers("", base, None, &settings),
    };
    let Ok(mut config) = config else { return false };
    config.resolve(&autos(), &TAXONOMY);
    let again = toml::to_string(&config).map(|text| Config::parse(&text, ""));
    assert!(matches!(again, Ok(Ok(again)) if again == config), "{config:?}");
    Rules::new(&config, TAXONOMY.clone()).is_ok()
}

fn autos() -> Autos {
    Autos {
        ego_box_m: Some(([-1.0; 3], [1.0; 3])),
        taxonomy: "occ3d-nuscenes".into(),
        reference_lidar: "LIDAR_TOP".into(),
    }
}

pub(super) fn configs() -> Vec<Vec<u8>> {
    let whole = PRESETS[..2].iter().map(|(_, text)| [&[0], text.as_bytes()].concat());
    let layer = b"\x01[grid]\nvoxel_size_m = 0.2\n[reader.mcap]\ntime_unit_s = 1e-6\n".to_vec();
    let settings = b"\x02relabel.k=3\nboxes.max_gap_s=0.5\nrelabel.unknown_class=drop".to_vec();
    whole.chain([layer, settings]).collect()
}

/// A taxonomy's own promises.
pub(super) fn taxonomy(bytes: &[u8]) -> bool {
    let Ok(taxonomy) = parse_taxonomy(&String::from_utf8_lossy(bytes), "") else { return false };
    let classes = taxonomy.names.len();
    assert!(taxonomy.rank.len() == classes && usize::from(taxonomy.free) >= classes);
    let is_known = |name: &String| taxonomy.class_named(name).is_some();
    assert!(taxonomy.names.iter().all(is_known));
    true
}

pub(super) fn taxonomies() -> Vec<Vec<u8>> {
    TAXONOMIES.iter().map(|(_, text)| text.as_bytes().to_vec()).collect()
}
