//! What is linked, by the lock files: what `cargo deny` checks too, where it can be installed.

use std::fs;
use std::path::{Path, PathBuf};

use toml::{Table, Value};

/// The lock files that are committed.
const LOCKS: [&str; 2] = ["Cargo.lock", "fuzz/Cargo.lock"];

const CRATES_IO: &str = "registry+https://github.com/rust-lang/crates.io-index";

fn place(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn table(name: &str) -> Table {
    fs::read_to_string(place(name)).expect("a file").parse().expect("TOML")
}

/// The packages of a lock file.
fn packages(lock: &str) -> Vec<Value> {
    table(lock)["package"].as_array().expect("packages").clone()
}

fn text<'v>(value: &'v Value, key: &str) -> &'v str {
    value.get(key).and_then(Value::as_str).unwrap_or_default()
}

/// A version as numbers: of `1.2.3+c` or `1.2.3-rc`, 1, 2, 3.
fn version(text: &str) -> [u64; 3] {
    let numbers = text.split(['+', '-']).next().expect("a version");
    let mut numbers = numbers.split('.').map(|number| number.parse().expect("a number"));
    [(); 3].map(|()| numbers.next().unwrap_or(0))
}

/// Whether `name`, `name@<1.2.3` or `name@=1.2.3` means this package.
fn bans(ban: &str, name: &str, found: &str) -> bool {
    let (banned, versions) = ban.split_once('@').unwrap_or((ban, ""));
    assert!(versions.is_empty() || versions.starts_with(['<', '=']), "{ban}");
    let found = version(found);
    let is_meant = match (versions.strip_prefix('<'), versions.strip_prefix('=')) {
        (Some(below), _) => found < version(below),
        (_, Some(exactly)) => found == version(exactly),
        _ => true,
    };
    banned == name && is_meant
}

#[test]
fn nothing_banned_is_linked() {
    let deny = table("deny.toml");
    let bans_of = deny["bans"]["deny"].as_array().expect("bans").clone();
    assert!(bans_of.len() > 15);
    for package in LOCKS.iter().flat_map(|lock| packages(lock)) {
        let (name, found) = (text(&package, "name"), text(&package, "version"));
        let ban = bans_of.iter().find(|ban| bans(text(ban, "crate"), name, found));
        assert_eq!(ban, None, "{name} {found}");
    }
}

#[test]
fn bans_are_understood() {
    assert!(bans("zip@<2.3.0", "zip", "2.2.9") && !bans("zip@<2.3.0", "zip", "2.3.0"));
    assert!(bans("a@=0.12.0", "a", "0.12.0+x") && !bans("a@=0.12.0", "a", "0.12.1"));
    assert!(bans("tar", "tar", "9.9.9") && !bans("tar", "rat", "9.9.9"));
}

#[test]
fn every_package_is_ours_or_from_crates_io_with_its_hash() {
    for package in LOCKS.iter().flat_map(|lock| packages(lock)) {
        let (name, source) = (text(&package, "name"), text(&package, "source"));
        let is_ours = name.starts_with("occlabel") && source.is_empty();
        let is_pinned = source == CRATES_IO && text(&package, "checksum").len() == 64;
        assert!(is_ours || is_pinned, "{name} from {source}");
    }
}

#[test]
fn scripts_of_others_stand_beside_their_licences() {
    for licence in ["page/vendor/three.LICENSE", "report/vendor/chart.LICENSE.md"] {
        let text = fs::read_to_string(place("crates/view").join(licence)).expect("a licence");
        assert!(text.contains("MIT") && text.contains("Copyright"), "{licence}");
    }
}
