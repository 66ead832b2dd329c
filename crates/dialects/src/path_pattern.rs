//! Where the files of a keyframe stand, and back: which keyframe a file belongs to.

use std::io::{self, ErrorKind};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use occlabel_core::Fault;
use occlabel_disk as disk;
use occlabel_labels::TreePath;

/// A path with holes: `{scene}`, `{token}`, `{name}` of an array, and `{split}`, a folder of any name
/// that may be absent and is not written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PathPattern(Vec<Part>);

/// A folder or a file: at most one hole within a name.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Part {
    before: String,
    hole: Option<Hole>,
    after: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Hole {
    Scene,
    Token,
    Split,
}

const HOLES: [(Hole, &str); 3] =
    [(Hole::Scene, "{scene}"), (Hole::Token, "{token}"), (Hole::Split, "{split}")];

/// What stands in the holes.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Filling {
    pub(crate) scene: String,
    pub(crate) token: String,
    pub(crate) split: String,
}

impl PathPattern {
    /// A pattern from its text, for an array of a name.
    pub fn new(text: &str, name: &str) -> Self {
        Self(text.replace("{name}", name).split('/').map(Part::new).collect())
    }

    /// The pattern without its first folders.
    pub(crate) fn from(&self, start: usize) -> Self {
        Self(self.0[start..].to_vec())
    }

    /// How many folders there are before the file.
    pub(crate) fn folders(&self) -> usize {
        self.0.len() - 1
    }

    /// What the names of the last folders of a place say of the holes before `start`.
    pub(crate) fn filling_of(&self, place: &Path, start: usize) -> Result<Filling, Fault> {
        let place = full(place)?;
        let mut filling = Filling::default();
        let names = place.iter().rev().map(|name| name.to_string_lossy());
        for (part, name) in self.0[..start].iter().rev().zip(names) {
            let caught = part.caught(&name).unwrap_or(&name);
            filling.fill(part.hole, caught);
        }
        Ok(filling)
    }

    /// How many of the folders before `start` are called otherwise than the last of a place.
    pub(crate) fn contradictions(&self, place: &Path, start: usize) -> Result<usize, Fault> {
        let place = full(place)?;
        let names = place.iter().rev().map(|name| name.to_string_lossy());
        let pairs = self.0[..start].iter().rev().zip(names);
        Ok(pairs.filter(|(part, name)| part.caught(name).is_none()).count())
    }

    /// Calls for each file that fits, in order of names; symbolic links are followed.
    pub(crate) fn walk(
        &self,
        root: &Path,
        filling: &Filling,
        except: Option<&str>,
        visit: &mut dyn FnMut(Filling) -> ControlFlow<()>,
    ) -> Result<ControlFlow<()>, Fault> {
        let [part, rest @ ..] = &self.0[..] else { return Ok(ControlFlow::Continue(())) };
        for name in part.names_in(root)? {
            let mut filling = filling.clone();
            filling.fill(part.hole, part.caught(&name).unwrap_or_default());
            let place = root.join(&name);
            let flow = match rest {
                [] if except.is_some_and(|end| name.ends_with(end)) => ControlFlow::Continue(()),
                [] if disk::is_file(&place) => visit(filling),
                [] => ControlFlow::Continue(()),
                _ if disk::is_dir(&place) => {
                    Self(rest.to_vec()).walk(&place, &filling, except, visit)?
                }
                _ => ControlFlow::Continue(()),
            };
            if flow.is_break() {
                return Ok(flow);
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    /// The path below a root.
    pub(crate) fn place(&self, root: &Path, filling: &Filling) -> PathBuf {
        self.0.iter().fold(root.to_owned(), |place, part| place.join(part.filled(filling)))
    }

    /// The path in a tree, without `{split}`.
    ///
    /// # Errors
    /// If the scene or the token is no plain name.
    pub fn tree_path(&self, scene: &str, token: &str) -> Result<TreePath, Fault> {
        let filling =
            Filling { scene: scene.to_owned(), token: token.to_owned(), split: String::new() };
        let parts = self.0.iter().filter(|part| part.hole != Some(Hole::Split));
        let names: Vec<_> = parts.map(|part| part.filled(&filling)).collect();
        match names.iter().find(|name| name.contains('/')) {
            Some(name) => TreePath::new(format!("{name}/..")),
            None => TreePath::new(names.join("/")),
        }
    }
}

/// A folder's path without symbolic links; as it is written, if there is no folder.
fn full(place: &Path) -> Result<PathBuf, Fault> {
    match disk::canonicalize(place) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(place.to_owned()),
        full => full.map_err(|error| unreadable(place, &error)),
    }
}

fn unreadable(folder: &Path, error: &io::Error) -> Fault {
    Fault::new("read", folder.display().to_string(), "to read this folder", error.to_string())
}

impl Part {
    fn new(text: &str) -> Self {
        let found = HOLES.iter().find_map(|(hole, word)| Some((*hole, text.split_once(word)?)));
        match found {
            Some((hole, (before, after))) => {
                Self { before: before.into(), hole: Some(hole), after: after.into() }
            }
            None => Self { before: text.into(), hole: None, after: String::new() },
        }
    }

    /// What stands in the hole of a name; empty if there is no hole.
    fn caught<'a>(&self, name: &'a str) -> Option<&'a str> {
        let caught = name.strip_prefix(&self.before)?.strip_suffix(&self.after)?;
        (caught.is_empty() == self.hole.is_none()).then_some(caught)
    }

    fn filled(&self, filling: &Filling) -> String {
        let caught = match self.hole {
            Some(Hole::Scene) => &filling.scene,
            Some(Hole::Token) => &filling.token,
            Some(Hole::Split) => &filling.split,
            None => "",
        };
        format!("{}{caught}{}", self.before, self.after)
    }

    /// The names in a folder that fit, sorted. Those that begin with a dot do not.
    fn names_in(&self, root: &Path) -> Result<Vec<String>, Fault> {
        if self.hole.is_none() {
            return Ok(vec![self.before.clone()]);
        }
        let entries = disk::list(root).map_err(|error| unreadable(root, &error))?;
        let names = entries.iter().filter_map(|entry| entry.file_name().into_string().ok());
        let fits = |name: &String| !name.starts_with('.') && self.caught(name).is_some();
        let mut names: Vec<_> = names.filter(fits).collect();
        names.sort();
        Ok(names)
    }
}

impl Filling {
    fn fill(&mut self, hole: Option<Hole>, caught: &str) {
        match hole {
            Some(Hole::Scene) => self.scene = caught.to_owned(),
            Some(Hole::Token) => self.token = caught.to_owned(),
            Some(Hole::Split) => self.split = caught.to_owned(),
            None => {}
        }
    }
}
