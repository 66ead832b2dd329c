//! The command line.

use std::path::PathBuf;

/// What is asked for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Args {
    /// Which bench.
    pub(crate) bench: String,
    /// What stands behind it.
    pub(crate) rest: Vec<String>,
    /// The world, by its file's name in `benches/worlds/`.
    pub(crate) world: String,
    /// How often everything is measured.
    pub(crate) rounds: usize,
}

impl Args {
    /// `None` if that is no command line of ours.
    pub(crate) fn parse(mut words: impl Iterator<Item = String>) -> Option<Self> {
        let bench = words.next()?;
        let mut args = Self { bench, rest: vec![], world: "nuscenes_like".into(), rounds: 3 };
        while let Some(word) = words.next() {
            match word.as_str() {
                "--world" => args.world = words.next()?,
                "--rounds" => args.rounds = words.next()?.parse().ok().filter(|n| *n > 0)?,
                word if word.starts_with("--") => return None,
                _ => args.rest.push(word),
            }
        }
        Some(args)
    }

    /// The folder behind the bench's name.
    ///
    /// # Panics
    /// If there is none.
    pub(crate) fn folder(&self) -> PathBuf {
        self.rest.first().expect("a folder").into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(line: &str) -> Option<Args> {
        Args::parse(line.split_whitespace().map(String::from))
    }

    #[test]
    fn options_stand_anywhere_behind_the_bench() {
        let args = parse("peer DIR --rounds 5").unwrap();
        assert_eq!((args.folder(), args.rounds), ("DIR".into(), 5));
        assert_eq!(parse("scene --world waymo_like").unwrap().world, "waymo_like");
        assert!(parse("scene --rounds 0").is_none());
        assert!(parse("").is_none());
    }
}
