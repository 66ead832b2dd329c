//! The worlds that ship with the program.

/// A world in `configs/worlds/`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShippedWorld {
    /// Its name.
    pub name: &'static str,
    /// The text of its file; the first line is a comment that says what it shows.
    pub text: &'static str,
}

macro_rules! shipped {
    ($($name:literal)*) => {
        &[$(ShippedWorld {
            name: $name,
            text: include_str!(concat!("../../../configs/worlds/", $name, ".toml")),
        }),*]
    };
}

/// All shipped worlds, that of the demo first.
pub const WORLDS: &[ShippedWorld] =
    shipped!("street" "crossing" "hill" "campus" "crowd" "highway" "scale");

/// The text of a shipped world's file.
pub fn shipped_world(name: &str) -> Option<&'static str> {
    WORLDS.iter().find(|world| world.name == name).map(|world| world.text)
}

impl ShippedWorld {
    /// What it shows, in one line.
    pub fn about(&self) -> &'static str {
        self.text.lines().next().unwrap_or_default().trim_start_matches(['#', ' '])
    }
}
