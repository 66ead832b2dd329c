//! The exactly known worlds of a simulated log, by the names of their scenes.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use occlabel_core::Fault;
use occlabel_disk as disk;
use occlabel_simulate::{World, shipped_world};

/// Worlds by name.
pub(crate) struct KnownWorlds {
    place: String,
    worlds: BTreeMap<String, World>,
}

impl KnownWorlds {
    /// Reads a world file, all that a folder holds, or those of a simulated log's `truth` folder;
    /// where there is nothing of the name, the shipped world.
    pub(crate) fn read(place: &Path) -> Result<Self, Fault> {
        let shipped = place.to_str().filter(|_| !disk::exists(place)).and_then(shipped_world);
        let worlds = match shipped {
            Some(text) => vec![World::parse(text, &format!("{}.toml", place.display()))?],
            None => files(place)?.iter().map(|file| world(file)).collect::<Result<_, _>>()?,
        };
        let worlds = worlds.into_iter().map(|world| (world.name.clone(), world)).collect();
        Ok(Self { place: place.display().to_string(), worlds })
    }

    /// The world that a scene was driven in.
    pub(crate) fn of(&self, scene: &str) -> Result<&World, Fault> {
        self.worlds.get(scene).ok_or_else(|| {
            let known: Vec<&str> = self.worlds.keys().map(String::as_str).collect();
            let expected = format!("the world of the labelled scene `{scene}`");
            Fault::new("world-truth", &self.place, expected, known.join(", "))
        })
    }

    /// Refuses a world that is not the one of a hash, though its name be the same.
    pub(crate) fn check(&self, world: &World, hash: &str) -> Result<(), Fault> {
        if world.hash == hash {
            return Ok(());
        }
        let expected = format!("the very world `{}` that was labelled, of hash {hash}", world.name);
        let found = format!("another of that name, of hash {}", world.hash);
        let fault = Fault::new("world-truth", &self.place, expected, found);
        Err(fault.hint("the simulated log's own folder holds its world, with all that was set"))
    }
}

fn world(file: &Path) -> Result<World, Fault> {
    let place = file.display().to_string();
    let text = disk::read_to_string(file)
        .map_err(|error| Fault::new("world-truth", &place, "a world file", error.to_string()))?;
    World::parse(&text, &place)
}

fn files(place: &Path) -> Result<Vec<PathBuf>, Fault> {
    if !disk::is_dir(place) {
        return Ok(vec![place.to_owned()]);
    }
    let truth = place.join("truth");
    let folder = if disk::is_dir(&truth) { truth } else { place.to_owned() };
    let unread = |error: std::io::Error| {
        let place = folder.display().to_string();
        Fault::new("world-truth", place, "a folder of world files", error.to_string())
    };
    let entries = disk::list(&folder).map_err(unread)?;
    let mut files: Vec<PathBuf> = entries.iter().map(disk::Entry::path).collect();
    files.retain(|file| file.extension().is_some_and(|ending| ending == "toml"));
    files.sort();
    Ok(files)
}
