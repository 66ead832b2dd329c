//! `simulate`: a drive through an exactly known world, as a log with its truth.

use std::path::Path;

use occlabel_core::{Fault, Taxonomy};
use occlabel_pipeline::{parse_taxonomy, shipped_taxonomy};
use occlabel_simulate::{
    Drive, Images, MeshNames, Output, WORLDS, World, Written, shipped_world, world_text_with,
    write_cloud, write_coda, write_masks, write_mcap, write_meshes, write_nuscenes,
    write_semantickitti, write_waymo,
};

use crate::args::{Format, ImagesArg, SimulateArgs, WrittenFormat};
use crate::console::Console;
use crate::exit::{Outcome, Stop};
use crate::format_flags::name;

pub(crate) fn run(args: &SimulateArgs, console: &Console) -> Result<Outcome, Stop> {
    let mesh_names = mesh_names(args).map_err(Stop::usage)?;
    let worlds = worlds(args).map_err(Stop::usage)?;
    let taxonomy = taxonomy(&worlds[0].1).map_err(Stop::usage)?;
    let drive = |(_, world): &(String, World)| Drive::new(world.clone(), &taxonomy);
    let drives: Vec<Drive> =
        worlds.iter().map(drive).collect::<Result<_, _>>().map_err(Stop::usage)?;
    let output = Output::create(&args.output).map_err(usage_or_failed)?;
    write_truth(&worlds, &output)?;
    let (written, last) = write(args, &drives, &taxonomy, &output).map_err(usage_or_failed)?;
    // nuScenes' own writer has them beside its images.
    if args.masks && args.format != WrittenFormat::Nuscenes {
        drives.iter().try_for_each(|drive| write_masks(drive, images(args), &output).map(drop))?;
    }
    let meshes = mesh_names.map(|names| write_meshes(&drives, names, &output)).transpose()?;
    let size = output.finish(&last)?;
    tell(&written, meshes, size, console);
    console.result(&format!("label it with  {}", label_line(args, &worlds[0].1)));
    Ok(Outcome::Complete)
}

/// An output folder that is taken and a world that a format has no words for are matters of usage; a
/// folder that cannot be written is not.
fn usage_or_failed(fault: Fault) -> Stop {
    let is_usage = ["output", "world", "waymo-v2"].contains(&fault.rule);
    if is_usage { Stop::usage(fault) } else { fault.into() }
}

/// Each scene's world, with its text: overrides applied, so that it can be built again from it.
fn worlds(args: &SimulateArgs) -> Result<Vec<(String, World)>, Fault> {
    let (text, place) = world_text(&args.world)?;
    let in_file = |fault: Fault| {
        let key = fault.record.clone().unwrap_or_else(|| fault.place.clone());
        Fault { place: place.clone(), ..fault }.record(key)
    };
    let text = world_text_with(&text, &args.settings).map_err(in_file)?;
    let world = World::parse(&text, &place)?;
    if args.scenes == 1 {
        return Ok(vec![(text, world)]);
    }
    if args.format != WrittenFormat::Nuscenes {
        let found = format!("{} of another format", args.scenes);
        return Err(Fault::new("usage", "--scenes", "nuscenes, or one scene a log", found));
    }
    let variant = |scene: u32| {
        let (name, seed) = (&world.name, world.seed.wrapping_add(u64::from(scene) - 1));
        let sets = [format!("name=\"{name}-{scene:04}\""), format!("seed={seed}")];
        let text = world_text_with(&text, &sets)?;
        let world = World::parse(&text, &place)?;
        Ok((text, world))
    };
    (1..=args.scenes).map(variant).collect()
}

/// The text of a shipped world, else of a file; and where it is from.
fn world_text(world: &str) -> Result<(String, String), Fault> {
    if let Some(text) = shipped_world(world) {
        return Ok((text.to_owned(), format!("{world}.toml")));
    }
    let text = std::fs::read_to_string(world).map_err(|error| {
        let names: Vec<&str> = WORLDS.iter().map(|world| world.name).collect();
        let expected = format!("{}, or a readable world file", names.join(", "));
        Fault::new("world", world, expected, error.to_string())
    })?;
    Ok((text, world.to_owned()))
}

fn taxonomy(world: &World) -> Result<Taxonomy, Fault> {
    let name = &world.taxonomy;
    let text = shipped_taxonomy(name).ok_or_else(|| {
        Fault::new("world", &world.place, "a shipped taxonomy", format!("`{name}`"))
            .record("taxonomy")
            .hint("`occlabel presets` lists them")
    })?;
    parse_taxonomy(text, name)
}

/// The worlds beside the log, for who judges its labels.
fn write_truth(worlds: &[(String, World)], output: &Output) -> Result<(), Fault> {
    match worlds {
        [(text, _)] => output.write("truth/world.toml", text.as_bytes()),
        worlds => worlds.iter().try_for_each(|(text, world)| {
            output.write(&format!("truth/{}.toml", world.name), text.as_bytes())
        }),
    }
}

fn images(args: &SimulateArgs) -> Images {
    match args.images {
        ImagesArg::None => Images::None,
        ImagesArg::Keyframes => Images::Keyframes,
        ImagesArg::All => Images::All,
    }
}

/// Writes the log, and tells the entry to finish it with.
fn write(
    args: &SimulateArgs,
    drives: &[Drive],
    taxonomy: &Taxonomy,
    output: &Output,
) -> Result<(Written, String), Fault> {
    let images = images(args);
    match args.format {
        WrittenFormat::Nuscenes => write_nuscenes(drives, taxonomy, images, output)
            .map(|(written, last)| (written, last.to_owned())),
        WrittenFormat::Semantickitti => write_semantickitti(&drives[0], output)
            .map(|(written, last)| (written, last.to_owned())),
        WrittenFormat::Coda => {
            write_coda(&drives[0], images, output).map(|(written, last)| (written, last.to_owned()))
        }
        WrittenFormat::Mcap => write_mcap(&drives[0], taxonomy, images, output),
        WrittenFormat::Cloud => write_cloud(&drives[0], taxonomy, output),
        WrittenFormat::Waymo => write_waymo(&drives[0], output),
        #[cfg(feature = "waymo-v2")]
        WrittenFormat::WaymoV2 => occlabel_simulate::write_waymo_v2(&drives[0], output),
        #[cfg(not(feature = "waymo-v2"))]
        WrittenFormat::WaymoV2 => {
            let expected = "a program built with the cargo feature `waymo-v2`";
            Err(Fault::new("waymo-v2", "--format waymo-v2", expected, "one without it"))
        }
    }
}

/// What names the files of meshes, if they are asked for.
fn mesh_names(args: &SimulateArgs) -> Result<Option<MeshNames>, Fault> {
    match args.format {
        _ if !args.meshes => Ok(None),
        WrittenFormat::Nuscenes => Ok(Some(MeshNames::Nuscenes)),
        WrittenFormat::Mcap => Ok(Some(MeshNames::Mcap)),
        _ => Err(Fault::new("usage", "--meshes", "--format nuscenes or mcap", "another format")),
    }
}

fn tell(written: &Written, meshes: Option<usize>, (files, bytes): (usize, u64), console: &Console) {
    let Written { scenes, sweeps, labelled, points, keyframes, boxes, images } = written;
    if let Some(meshes) = meshes {
        console.result(&format!("meshes     {meshes}"));
    }
    for line in [
        format!("scenes     {scenes}"),
        format!("sweeps     {sweeps}, {labelled} labelled"),
        format!("points     {points}"),
        format!("keyframes  {keyframes}"),
        format!("boxes      {boxes}"),
        format!("images     {images}"),
        format!("files      {files}"),
        format!("bytes      {bytes}"),
    ] {
        console.result(&line);
    }
}

/// The line that labels the log. nuScenes and MCAP hold the world's own names and are taken for logs of
/// nuScenes' taxonomy; the others have words of their own.
fn label_line(args: &SimulateArgs, world: &World) -> String {
    let input = Path::new(&args.output).display();
    if args.format == WrittenFormat::Cloud {
        let line = "occlabel label --format cloud --preset gs-occ3d";
        return format!("{line} --input {input} --output LABELS");
    }
    let (format, has_own_names) = match args.format {
        WrittenFormat::Nuscenes => (Format::Nuscenes, true),
        WrittenFormat::Mcap => (Format::Mcap, true),
        WrittenFormat::Semantickitti => (Format::Semantickitti, false),
        WrittenFormat::Coda => (Format::Coda, false),
        WrittenFormat::Waymo | WrittenFormat::WaymoV2 => (Format::Waymo, false),
        WrittenFormat::Cloud => (Format::Cloud, false),
    };
    let format = name(format);
    let line = format!("occlabel label --format {format} --input {input} --output LABELS");
    match world.taxonomy.as_str() {
        taxonomy if has_own_names && taxonomy != "occ3d-nuscenes" => {
            format!("{line} --set taxonomy.file={taxonomy}")
        }
        _ => line,
    }
}
