//! Rules of a preset on a grid small enough to draw.

use occlabel_pipeline::{Autos, Config, Rules, parse_taxonomy, preset, shipped_taxonomy};

const NO_EGO: &str = "aggregate.ego_box_m=none";

/// The preset `precise` with settings over it.
pub(crate) fn rules(settings: &[&str]) -> Rules {
    let settings: Vec<String> =
        [&[NO_EGO], settings].concat().iter().map(|s| s.to_string()).collect();
    let text = preset("precise").expect("a preset");
    let mut config = Config::from_layers("test", text, None, &settings).expect("a configuration");
    let autos =
        Autos { ego_box_m: None, taxonomy: "occ3d-nuscenes".into(), reference_lidar: "TOP".into() };
    let name = config.taxonomy_file(&autos).to_owned();
    let text = shipped_taxonomy(&name).expect("a name");
    let taxonomy = parse_taxonomy(text, &name).expect("a taxonomy");
    config.resolve(&autos, &taxonomy);
    Rules::new(&config, taxonomy.into()).expect("rules")
}

/// 24 x 16 x 6 voxels of 0.5 m, most of them ahead. The ground, z = 0, runs through the middle of
/// the second layer, so that no surface lies on a face.
pub(crate) fn small(settings: &[&str]) -> Rules {
    let grid =
        ["grid.min_m=[-2.0, -4.0, -0.75]", "grid.max_m=[10.0, 4.0, 2.25]", "grid.voxel_size_m=0.5"];
    rules(&[&grid, settings].concat())
}

/// 16 x 16 x 8 voxels of 0.5 m around the ego: a quarter turn maps it onto itself.
pub(crate) fn large(settings: &[&str]) -> Rules {
    let grid = ["grid.min_m=[-4, -4, -2]", "grid.max_m=[4, 4, 2]", "grid.voxel_size_m=0.5"];
    rules(&[&grid, settings].concat())
}
