//! From the command line to an open log and the rules to label it by.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use occlabel_core::{ClassId, Fault, McapSettings, Taxonomy};
use occlabel_dialects::{Dialect, DialectGrid};
use occlabel_disk as disk;
use occlabel_logs::{
    Argoverse2Log, CloudLog, CloudOptions, CodaLog, Kitti360Log, Masks, McapLog, McapOptions,
    MeshFolder, NuScenesLog, NuScenesOptions, PointColumns, QuaternionOrder, ReadOptions,
    ReaderDefaults, SceneSource, SemanticKittiLog, TimeSource, WaymoLog,
};
use occlabel_pipeline::{
    Autos, Config, GridFrame, GridTable, ReaderTables, Rules, VoxelSize, parse_taxonomy, preset,
    shipped_taxonomy,
};
use occlabel_voxelize::Surfels;

use crate::args::{ConfigArgs, Format, LogArgs, QuatOrder, TimeSourceArg};
use crate::exit::Stop;
use crate::format_flags::check_flags;
use crate::format_hint::{check_input, with_format};
use crate::masks::open_masks;
use crate::presets::unknown_preset;
use crate::urls::check_url;

/// A log, and what decides its labels.
pub(crate) struct Opened {
    pub(crate) source: Box<dyn SceneSource>,
    /// The preset's name; none if a file was given.
    pub(crate) preset: Option<String>,
    /// Resolved: no `"auto"` left.
    pub(crate) config: Config,
    /// BLAKE3 of the taxonomy's file.
    pub(crate) taxonomy_hash: String,
    pub(crate) rules: Rules,
    /// The masks that paint; none if there are none.
    pub(crate) masks: Option<Masks>,
    /// Whether the configuration names the lidar that keyframes refer to.
    pub(crate) names_lidar: bool,
    /// Who is known by their surface.
    pub(crate) meshes: Option<MeshFolder>,
}

/// Opens the log and resolves the configuration against it.
pub(crate) fn open(log: &LogArgs, args: &ConfigArgs) -> Result<Opened, Stop> {
    open_with(log, args, &Stead::default())
}

/// What stands in where the command line says nothing.
#[derive(Default)]
pub(crate) struct Stead {
    /// The class of what the taxonomy does not name.
    pub(crate) class: Option<ClassId>,
    /// The grid, in place of the preset's.
    pub(crate) grid: Option<GridTable>,
}

/// The same with what stands in where the command line says nothing.
pub(crate) fn open_with(log: &LogArgs, args: &ConfigArgs, stead: &Stead) -> Result<Opened, Stop> {
    let (preset, config) = read_config(args, stead.grid.as_ref()).map_err(Stop::usage)?;
    check_flags(log, args).map_err(Stop::usage)?;
    Ok(Opened { preset, ..open_by(log, config, stead)? })
}

/// Opens the log by a configuration, which is resolved against it.
pub(crate) fn open_by(log: &LogArgs, mut config: Config, stead: &Stead) -> Result<Opened, Stop> {
    check_url(&log.input)?;
    check_input(&log.input).map_err(Stop::usage)?;
    disk::expect_no_change(&log.input);
    let scenes = wanted_scenes(log).map_err(Stop::usage)?;
    let names_lidar = config.keyframes.reference_lidar != "auto";
    let stop = |fault| usage_or_failed(with_format(fault, log));
    let autos = autos(log, scenes.as_ref(), &mut config.reader).map_err(stop)?;
    let meshes = open_meshes(&mut config, &log.input).map_err(Stop::usage)?;
    let (taxonomy, taxonomy_hash) = resolve(&mut config, &autos).map_err(Stop::usage)?;
    let unknown_as = unknown_as(log, &taxonomy).map_err(Stop::usage)?.or(stead.class);
    let masks = open_masks(&log.input, &mut config.paint, &taxonomy, unknown_as);
    let masks = masks.map_err(Stop::usage)?;
    let taxonomy = Arc::new(taxonomy);
    let rules = Rules::new(&config, taxonomy.clone()).map_err(Stop::usage)?;
    let options = ReadOptions { scenes, unknown_as, taxonomy, keyframes: config.keyframes.clone() };
    let source = open_format(log, options, &config).map_err(stop)?;
    let preset = None;
    Ok(Opened { source, preset, config, taxonomy_hash, rules, masks, names_lidar, meshes })
}

/// Opens a log by its format.
fn open_format(
    log: &LogArgs,
    read: ReadOptions,
    config: &Config,
) -> Result<Box<dyn SceneSource>, Fault> {
    match log.format {
        Format::Nuscenes => {
            let options = nuscenes_options(log, read);
            NuScenesLog::open(&log.input, options).map(|log| Box::new(log) as _)
        }
        Format::Waymo => WaymoLog::open(&log.input, read).map(|log| Box::new(log) as _),
        Format::Av2 => Argoverse2Log::open(&log.input, read).map(|log| Box::new(log) as _),
        Format::Coda => CodaLog::open(&log.input, read).map(|log| Box::new(log) as _),
        Format::Semantickitti if Kitti360Log::is_log(&log.input) => {
            Kitti360Log::open(&log.input, read).map(|log| Box::new(log) as _)
        }
        Format::Semantickitti => {
            SemanticKittiLog::open(&log.input, read).map(|log| Box::new(log) as _)
        }
        Format::Mcap => {
            let options = mcap_options(log, read, config.reader.mcap.clone());
            McapLog::open(&log.input, options).map(|log| Box::new(log) as _)
        }
        Format::Cloud => {
            let options = cloud_options(read, config)?;
            CloudLog::open(&log.input, options).map(|log| Box::new(log) as _)
        }
    }
}

/// The folder of meshes, if there is any; its name takes the place of its path.
fn open_meshes(config: &mut Config, root: &Path) -> Result<Option<MeshFolder>, Fault> {
    let is_there = disk::is_dir(&root.join("meshes"));
    let folder = match config.meshes.folder.as_str() {
        "none" => None,
        "auto" => is_there.then_some("meshes"),
        path => Some(path),
    };
    let folder = folder.map(|folder| MeshFolder::open(root, folder)).transpose()?;
    config.meshes.folder = folder.as_ref().map_or("none", MeshFolder::name).to_owned();
    Ok(folder)
}

/// What the format itself says where the configuration says `"auto"`; tables of other formats go,
/// as they decide nothing.
fn autos(
    log: &LogArgs,
    scenes: Option<&BTreeSet<String>>,
    tables: &mut ReaderTables,
) -> Result<Autos, Fault> {
    let given = std::mem::take(tables);
    let defaults = match log.format {
        Format::Nuscenes => NuScenesLog::format_defaults(&log.input, log.version.as_deref())?,
        Format::Waymo => WaymoLog::format_defaults(&log.input)?,
        Format::Av2 => Argoverse2Log::format_defaults(),
        Format::Coda => CodaLog::format_defaults(),
        Format::Semantickitti => SemanticKittiLog::format_defaults(),
        Format::Cloud => {
            tables.cloud = given.cloud;
            CloudLog::format_defaults()
        }
        Format::Mcap => {
            let (defaults, mut mcap) = McapLog::resolve(&log.input, scenes, &given.mcap)?;
            let taxonomy = std::mem::replace(&mut mcap.taxonomy, file_name(&given.mcap.taxonomy));
            tables.mcap = mcap;
            return Ok(Autos { taxonomy, ..autos_of(defaults) });
        }
    };
    Ok(autos_of(defaults))
}

fn nuscenes_options(log: &LogArgs, read: ReadOptions) -> NuScenesOptions {
    NuScenesOptions {
        read,
        version: log.version.clone(),
        quaternion_order: match log.quat_order {
            Some(QuatOrder::Xyzw) => QuaternionOrder::Xyzw,
            Some(QuatOrder::Wxyz) | None => QuaternionOrder::Wxyz,
        },
        columns: match log.columns {
            Some(4) => Some(PointColumns::Four),
            Some(_) => Some(PointColumns::Five),
            None => None,
        },
    }
}

fn mcap_options(log: &LogArgs, read: ReadOptions, settings: McapSettings) -> McapOptions {
    let time_source = match log.time_source {
        Some(TimeSourceArg::Log) => TimeSource::Log,
        Some(TimeSourceArg::Header) | None => TimeSource::Header,
    };
    McapOptions { read, settings, time_source, recover: log.recover }
}

/// Surfels become points so near to each other that at least two of them fit beside each other into each
/// voxel of the configured grid.
fn cloud_options(read: ReadOptions, config: &Config) -> Result<CloudOptions, Fault> {
    let is_spread = config.voxelize.surfels == Surfels::Extent;
    let smallest_m = config.grid_spec()?.size_m().min();
    let surfel_spacing_m = is_spread.then_some(smallest_m / 2.0);
    Ok(CloudOptions { read, settings: config.reader.cloud.clone(), surfel_spacing_m })
}

/// What the user named wrongly is a matter of usage; what the log holds wrongly is not.
fn usage_or_failed(fault: Fault) -> Stop {
    match fault.rule {
        "scene-unknown"
        | "version-folder"
        | "waymo-layout"
        | "waymo-v2"
        | "av2"
        | "av2-layout"
        | "coda-layout"
        | "semantickitti-layout"
        | "mcap-files"
        | "cloud-layout"
        | "mcap-clouds" => Stop::usage(fault),
        _ => fault.into(),
    }
}

fn read_config(
    args: &ConfigArgs,
    grid: Option<&GridTable>,
) -> Result<(Option<String>, Config), Fault> {
    let name = args.preset.as_deref().unwrap_or("precise");
    let base = preset(name).ok_or_else(|| unknown_preset(name))?;
    let base = &grid.map_or(Ok(base.to_owned()), |grid| with_grid(base, grid))?;
    match &args.config {
        None => Ok((Some(name.into()), Config::from_layers(name, base, None, &args.settings)?)),
        Some(path) => {
            let (place, file) = (path.display().to_string(), read_text(path)?);
            Ok((None, Config::from_layers(&place, base, Some(&file), &args.settings)?))
        }
    }
}

/// A preset with another grid.
fn with_grid(preset: &str, grid: &GridTable) -> Result<String, Fault> {
    let not_toml = |error: String| Fault::new("config", "the preset", "TOML", error);
    let mut table: toml::Table =
        preset.parse().map_err(|error: toml::de::Error| not_toml(error.to_string()))?;
    let grid = toml::Value::try_from(grid).map_err(|error| not_toml(error.to_string()))?;
    table.insert("grid".to_owned(), grid);
    Ok(table.to_string())
}

/// The grid that a dialect was published with.
pub(crate) fn published_grid(dialect: &Dialect) -> Result<GridTable, Fault> {
    let DialectGrid { frame, min_m, max_m, voxel_size_m } = dialect.grid.clone();
    let frame = match frame.as_str() {
        "ego" => GridFrame::Ego,
        "lidar" => GridFrame::Lidar,
        other => {
            let expected = "ego or lidar, to label in";
            return Err(Fault::new("dialect", &dialect.name, expected, other).record("grid.frame"));
        }
    };
    let is_cube = voxel_size_m.iter().all(|side| *side == voxel_size_m[0]);
    let voxel_size_m =
        if is_cube { VoxelSize::Cube(voxel_size_m[0]) } else { VoxelSize::Sides(voxel_size_m) };
    Ok(GridTable { frame, min_m, max_m, voxel_size_m })
}

/// The `[grid]` of a configuration file.
pub(crate) fn grid_of_file(path: &Path) -> Result<GridTable, Fault> {
    #[derive(serde::Deserialize)]
    struct File {
        grid: GridTable,
    }
    let file: Result<File, _> = toml::from_str(&read_text(path)?);
    file.map(|file| file.grid).map_err(|error| {
        let expected = "a table [grid] with frame, min_m, max_m, voxel_size_m";
        Fault::new("config", path.display().to_string(), expected, error.message())
    })
}

/// Puts what is meant in place of every `"auto"`, and gives the taxonomy with its file's hash.
fn resolve(config: &mut Config, autos: &Autos) -> Result<(Taxonomy, String), Fault> {
    let file = config.taxonomy_file(autos).to_owned();
    let (taxonomy, hash) = taxonomy_of(&file)?;
    config.taxonomy.file = if shipped_taxonomy(&file).is_some() { file } else { file_name(&file) };
    config.resolve(autos, &taxonomy);
    Ok((taxonomy, hash))
}

/// A shipped taxonomy, or that of a file, with the file's hash.
pub(crate) fn taxonomy_of(file: &str) -> Result<(Taxonomy, String), Fault> {
    let text = match shipped_taxonomy(file) {
        Some(text) => text.to_owned(),
        None => read_text(Path::new(file))?,
    };
    Ok((parse_taxonomy(&text, file)?, blake3::hash(text.as_bytes()).to_string()))
}

/// A path without its folders, which would tell of the machine.
pub(crate) fn file_name(file: &str) -> String {
    Path::new(file).file_name().map_or(file.into(), |name| name.to_string_lossy().into_owned())
}

pub(crate) fn read_text(path: &Path) -> Result<String, Fault> {
    disk::read_to_string(path).map_err(|error| {
        Fault::new(
            "config-file",
            path.display().to_string(),
            "a readable text file",
            error.to_string(),
        )
    })
}

fn wanted_scenes(log: &LogArgs) -> Result<Option<BTreeSet<String>>, Fault> {
    let Some(list) = &log.scenes_from else {
        return Ok((!log.scenes.is_empty()).then(|| log.scenes.iter().cloned().collect()));
    };
    let text = if list.as_os_str() == "-" {
        std::io::read_to_string(std::io::stdin())
            .map_err(|error| Fault::new("scenes-from", "stdin", "scene names", error.to_string()))?
    } else {
        read_text(list)?
    };
    let names = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let names: BTreeSet<String> = names.map(str::to_owned).collect();
    if names.is_empty() {
        let place = list.display().to_string();
        return Err(Fault::new("scenes-from", place, "names of scenes, one a line", "none"));
    }
    Ok(Some(names))
}

fn unknown_as(log: &LogArgs, taxonomy: &Taxonomy) -> Result<Option<ClassId>, Fault> {
    let Some(name) = &log.unknown_as else { return Ok(None) };
    let class = taxonomy.class_named(name).ok_or_else(|| {
        let expected = format!("one of {}", taxonomy.names.join(", "));
        Fault::new("config", "--unknown-as", expected, format!("`{name}`"))
    })?;
    Ok(Some(class))
}

fn autos_of(defaults: ReaderDefaults) -> Autos {
    Autos {
        ego_box_m: defaults.ego_box_m,
        taxonomy: defaults.taxonomy.to_owned(),
        reference_lidar: defaults.reference_lidar,
    }
}
