//! Throws bytes at the parser that the environment variable `DOOR` names; `DOOR=seeds` writes what
//! each parser expects into `corpus/<parser>/` instead, and ends.
#![no_main]

use std::fs;
use std::path::Path;
use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use occlabel_logs::doors::{DOORS, Door};

static DOOR: LazyLock<&Door> = LazyLock::new(|| {
    let name = std::env::var("DOOR").unwrap_or_default();
    if name == "seeds" {
        write_seeds();
        std::process::exit(0);
    }
    let names: Vec<&str> = DOORS.iter().map(|door| door.name).collect();
    let door = DOORS.iter().find(|door| door.name == name);
    door.unwrap_or_else(|| panic!("DOOR has to be one of {}", names.join(", ")))
});

fuzz_target!(|bytes: &[u8]| {
    (DOOR.knock)(bytes);
});

fn write_seeds() {
    for door in DOORS {
        let folder = Path::new("corpus").join(door.name);
        fs::create_dir_all(&folder).unwrap();
        for (number, seed) in (door.seeds)().iter().enumerate() {
            fs::write(folder.join(format!("seed-{number}")), seed).unwrap();
        }
    }
}
