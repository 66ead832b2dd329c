//! What a configuration may say: checked once, at the door.

use occlabel_core::{CloudSettings, Fault, McapSettings};

use crate::Config;
use crate::config::{EgoBox, MeshTable};

/// Rays longer than this many voxels are refused (labels.md section 8).
const LONGEST_RAY_VOXELS: f64 = (1 << 20) as f64;

/// More pixels to each side are whole images.
const MOST_PX: u32 = 1000;

/// Refuses a configuration with an impossible value.
pub(crate) fn check(config: &Config) -> Result<(), Fault> {
    config.grid_spec()?;
    check_counts(config)?;
    check_spans(config)?;
    check_distances(config)?;
    check_meshes(&config.meshes)?;
    check_ego_box(&config.aggregate.ego_box_m)?;
    check_pixels("paint.borders_px", config.paint.borders_px)?;
    check_pixels("paint.splat_px", config.paint.splat_px)?;
    check_cloud(&config.reader.cloud)?;
    check_mcap(&config.reader.mcap)?;
    check_reach(config)
}

fn check_counts(config: &Config) -> Result<(), Fault> {
    at_least_one("keyframes.stride", config.keyframes.stride)?;
    at_least_one("relabel.k", config.relabel.k)?;
    at_least_one("occlusion.pixel_stride", config.occlusion.pixel_stride)?;
    at_least_one("states.occupied_min_hits", config.states.occupied_min_hits as usize)?;
    at_least_one("states.free_min_crossings", config.states.free_min_crossings as usize)
}

fn check_spans(config: &Config) -> Result<(), Fault> {
    not_negative("boxes.max_gap_s", config.boxes.max_gap_s)?;
    not_negative("boxes.extrapolate_s", config.boxes.extrapolate_s)?;
    not_negative("paint.max_dt_s", config.paint.max_dt_s)?;
    not_negative("aggregate.window_s", config.aggregate.window_s)?;
    not_negative("aggregate.deformable_window_s", config.aggregate.deformable_window_s)?;
    not_negative("raycast.same_time_s", config.raycast.same_time_s)
}

fn check_distances(config: &Config) -> Result<(), Fault> {
    let ratio = config.states.min_hit_ratio;
    positive("aggregate.max_range_m", config.aggregate.max_range_m)?;
    not_negative("aggregate.radius_m", config.aggregate.radius_m.value().unwrap_or(0.0))?;
    positive("aggregate.box_scale", config.aggregate.box_scale)?;
    not_negative("aggregate.box_margin_m", config.aggregate.box_margin_m)?;
    not_negative("paint.occlusion_m", config.paint.occlusion_m)?;
    not_negative("relabel.max_distance_m", config.relabel.max_distance_m.value().unwrap_or(0.0))?;
    not_negative("raycast.ignore_near_hit_m", config.raycast.ignore_near_hit_m)?;
    not_negative("raycast.ignore_near_origin_m", config.raycast.ignore_near_origin_m)?;
    not_negative("raycast.flat_ignore_dz_m", config.raycast.flat_ignore_dz_m)?;
    positive("occlusion.depth_max_m", config.occlusion.depth_max_m)?;
    need("states.min_hit_ratio", (0.0..=1.0).contains(&ratio), "0 to 1", ratio)
}

fn check_meshes(meshes: &MeshTable) -> Result<(), Fault> {
    at_least_one("meshes.min_points", meshes.min_points)?;
    not_negative("meshes.max_residual_m", meshes.max_residual_m)?;
    positive("meshes.max_pair_m", meshes.max_pair_m)?;
    positive("meshes.point_error_m", meshes.point_error_m)?;
    positive("meshes.mesh_error_m", meshes.mesh_error_m)?;
    positive("meshes.mesh_error_rad", meshes.mesh_error_rad)
}

fn check_pixels(key: &str, pixels: u32) -> Result<(), Fault> {
    need(key, pixels <= MOST_PX, &format!("at most {MOST_PX}"), pixels)
}

fn check_ego_box(ego_box: &EgoBox) -> Result<(), Fault> {
    let EgoBox::Corners { min, max } = ego_box else { return Ok(()) };
    let is_box = (0..3).all(|a| min[a].is_finite() && max[a].is_finite() && min[a] <= max[a]);
    need("aggregate.ego_box_m", is_box, "finite corners, min <= max", format!("{min:?} {max:?}"))
}

fn check_cloud(settings: &CloudSettings) -> Result<(), Fault> {
    let opacity = settings.min_opacity;
    let is_share = opacity > 0.0 && opacity <= 1.0;
    need("reader.cloud.min_opacity", is_share, "above 0, at most 1", opacity)
}

fn check_mcap(settings: &McapSettings) -> Result<(), Fault> {
    positive("reader.mcap.time_unit_s", settings.time_unit_s)?;
    not_negative("reader.mcap.max_transform_gap_s", settings.max_transform_gap_s)?;
    need("reader.mcap.max_record_bytes", settings.max_record_bytes >= 1, "at least 1", 0)
}

fn check_reach(config: &Config) -> Result<(), Fault> {
    let smallest = config.grid.voxel_size_m.sides().into_iter().fold(f64::INFINITY, f64::min);
    let longest = smallest * LONGEST_RAY_VOXELS;
    let expected = format!("at most 2^20 of the smallest voxel size, {longest} m");
    for (key, reach) in [
        ("aggregate.max_range_m", config.aggregate.max_range_m),
        ("occlusion.depth_max_m", config.occlusion.depth_max_m),
    ] {
        need(key, reach <= longest, &expected, format!("{reach} m"))?;
    }
    Ok(())
}

fn at_least_one(key: &str, value: usize) -> Result<(), Fault> {
    need(key, value >= 1, "at least 1", value)
}

fn not_negative(key: &str, value: f64) -> Result<(), Fault> {
    need(key, value.is_finite() && value >= 0.0, "a finite number, 0 or more", value)
}

fn positive(key: &str, value: f64) -> Result<(), Fault> {
    need(key, value.is_finite() && value > 0.0, "a finite number above 0", value)
}

fn need(key: &str, holds: bool, expected: &str, found: impl ToString) -> Result<(), Fault> {
    if holds { Ok(()) } else { Err(Fault::new("config", key, expected, found.to_string())) }
}

#[cfg(test)]
mod tests {
    use crate::{Config, preset};

    fn refusal(setting: &str) -> String {
        let settings = [setting.to_owned()];
        let read = Config::from_layers("test", preset("precise").unwrap(), None, &settings);
        read.map(|_| String::new()).unwrap_or_else(|fault| fault.to_string())
    }

    #[test]
    fn impossible_values_are_refused_by_the_name_of_their_key() {
        for setting in [
            "keyframes.stride=0",
            "relabel.k=0",
            "paint.max_dt_s=-0.1",
            "paint.occlusion_m=nan",
            "paint.splat_px=1001",
            "paint.borders_px=1001",
            "occlusion.pixel_stride=0",
            "states.occupied_min_hits=0",
            "boxes.max_gap_s=-1",
            "aggregate.window_s=nan",
            "aggregate.max_range_m=0",
            "aggregate.radius_m=-1",
            "reader.cloud.min_opacity=0",
            "aggregate.box_scale=-1.0",
            "raycast.same_time_s=inf",
            "states.min_hit_ratio=1.5",
            "relabel.max_distance_m=-1",
            "aggregate.ego_box_m={min=[1,0,0],max=[0,1,1]}",
        ] {
            let key = setting.split('=').next().unwrap();
            assert!(refusal(setting).starts_with(key), "{setting}: {}", refusal(setting));
        }
    }

    #[test]
    fn fault_07_reach_beyond_the_lattice_is_refused() {
        assert!(refusal("aggregate.max_range_m=419431").contains("2^20"));
        assert!(refusal("occlusion.depth_max_m=1e9").contains("2^20"));
        assert_eq!(refusal("aggregate.max_range_m=419430"), "");
    }

    #[test]
    fn fault_32_impossible_voxels_are_refused_with_their_numbers() {
        for size in ["0", "-0.4", "nan", "0.3", "1e-6", "1e6"] {
            assert!(refusal(&format!("grid.voxel_size_m={size}")).contains("[grid]"), "{size}");
        }
        assert!(refusal("grid.voxel_size_m=1e-5").contains("8000000 x 8000000 x 640000"));
    }
}
