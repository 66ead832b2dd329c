//! Throws bytes at the door that the environment variable `DOOR` names. `DOOR=list` prints the names of
//! all doors instead, `DOOR=seeds` writes what each expects into folders of these names, and they end.
#![no_main]

use std::fs;
use std::path::Path;
use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use occlabel_testkit::Door;

static DOOR: LazyLock<&Door> = LazyLock::new(|| {
    let name = std::env::var("DOOR").unwrap_or_default();
    doors().find(|door| door.name == name).expect("DOOR is the name of a door")
});

fuzz_target!(
    init: if let Ok(wish @ ("list" | "seeds")) = std::env::var("DOOR").as_deref() {
        match wish {
            "list" => doors().for_each(|door| println!("{}", door.name)),
            _ => doors().for_each(write_seeds),
        }
        std::process::exit(0);
    },
    |bytes: &[u8]| {
        (DOOR.knock)(bytes);
    }
);

fn doors() -> impl Iterator<Item = &'static Door> {
    let labels = occlabel_labels::doors::DOORS.iter().chain(occlabel_dialects::doors::DOORS);
    let pipeline = occlabel_pipeline::doors::TEXTS.iter().chain(occlabel_pipeline::doors::GEOMETRY);
    let worlds = occlabel_simulate::doors::DOORS;
    occlabel_logs::doors::DOORS.iter().chain(labels).chain(pipeline).chain(worlds)
}

fn write_seeds(door: &Door) {
    fs::create_dir_all(door.name).unwrap();
    for (number, seed) in (door.seeds)().iter().enumerate() {
        fs::write(Path::new(door.name).join(format!("seed-{number}")), seed).unwrap();
    }
}
