//! Which dialects a file looks like.

use std::path::Path;

use crate::describe::sight::{Packing, SeenArray, Sight};
use crate::{Array, Dialect, Element, Holds, Layout, Rows};

/// A dialect that a file may be in. The more of it is so, the better it fits: in this order.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Fit {
    /// The dialect.
    dialect: Dialect,
    /// Its arrays that are there, less those that are not and those that it does not know.
    arrays: i64,
    /// Whether the grid has the published shape, as far as the file tells.
    is_published_shape: bool,
    /// Whether the file stands where the dialect has it.
    is_at_its_path: bool,
}

impl Fit {
    /// The dialects that fit a file best; several if nothing tells them apart.
    pub(crate) fn best(path: &Path, sight: &Sight) -> Vec<Dialect> {
        let fit = |dialect| Self::of(dialect, path, sight);
        let fits: Vec<_> = Dialect::all().into_iter().filter_map(fit).collect();
        let best = fits.iter().map(Self::rank).max();
        let is_best = |fit: &Self| Some(fit.rank()) == best;
        fits.into_iter().filter(is_best).map(|fit| fit.dialect).collect()
    }

    /// How well it fits.
    fn rank(&self) -> (i64, bool, bool) {
        (self.arrays, self.is_published_shape, self.is_at_its_path)
    }

    fn of(dialect: Dialect, path: &Path, sight: &Sight) -> Option<Self> {
        let (arrays, shape) = match (&dialect.layout, sight.packing) {
            (Layout::Npz(files), Packing::Npz) => {
                let semantics = whole_grid(sight, &files.arrays)?;
                (balance(sight, &files.arrays), Some(semantics.shape.clone()))
            }
            (Layout::Rows(rows), Packing::Npy) => (columns(rows, sight)?, None),
            (Layout::Indices(files), Packing::Npy) => (pairs(&files.arrays, path, sight)?, None),
            (Layout::VoxelFiles(files), Packing::Bytes) => {
                let array = files.arrays.iter().find(|a| a.name == sight.arrays[0].name)?;
                (1, grid_of_bytes(&dialect, array, sight.arrays[0].shape[0]))
            }
            _ => return None,
        };
        let published = dialect.grid.spec().ok()?.shape();
        let published = dialect.layout.order().file_shape(published);
        Some(Self {
            arrays,
            is_published_shape: shape.is_none_or(|shape| shape == published),
            is_at_its_path: is_at(dialect.layout.path(), path),
            dialect,
        })
    }
}

/// The array of classes, if it is one of whole numbers on three axes.
fn whole_grid<'a>(sight: &'a Sight, arrays: &[Array]) -> Option<&'a SeenArray> {
    let named = arrays.iter().find(|array| array.holds == Holds::Semantics)?;
    let seen = sight.array(&named.name)?;
    (seen.is_whole() && seen.shape.len() == 3).then_some(seen)
}

/// Arrays that are there, less those that are missing or foreign.
fn balance(sight: &Sight, arrays: &[Array]) -> i64 {
    let there = arrays.iter().filter(|array| sight.array(&array.name).is_some()).count() as i64;
    let foreign = sight.arrays.len() as i64 - there;
    2 * there - arrays.len() as i64 - foreign
}

/// A table of as many columns.
fn columns(rows: &Rows, sight: &Sight) -> Option<i64> {
    let [_, columns] = sight.arrays[0].shape[..] else { return None };
    let is_it = |table: &&crate::Table| table.columns.len() == columns;
    rows.tables.iter().find(is_it).map(|_| 1)
}

/// Two whole columns, in a file of the right name.
fn pairs(arrays: &[Array], path: &Path, sight: &Sight) -> Option<i64> {
    let seen = &sight.arrays[0];
    let semantics = arrays.iter().find(|array| array.holds == Holds::Semantics)?;
    let stem = path.file_stem()?.to_str()?;
    let is_it = seen.is_whole() && matches!(seen.shape[..], [_, 2]);
    (is_it && stem.ends_with(&semantics.name)).then_some(1)
}

/// The published shape, if so many bytes are a grid of it; else one that no grid has.
fn grid_of_bytes(dialect: &Dialect, array: &Array, bytes: usize) -> Option<Vec<usize>> {
    let spec = dialect.grid.spec().ok()?;
    let expected = match array.element {
        Element::Bits(_) => spec.len().div_ceil(8),
        Element::Number(number) => spec.len() * number.size(),
    };
    (bytes != expected).then(Vec::new)
}

/// Whether a path ends as a pattern says.
fn is_at(pattern: &str, path: &Path) -> bool {
    let names = path.iter().rev().map(|name| name.to_string_lossy().into_owned());
    let parts: Vec<&str> = pattern.rsplit('/').filter(|part| *part != "{split}").collect();
    let names: Vec<String> = names.take(parts.len()).collect();
    names.len() == parts.len() && parts.iter().zip(&names).all(|(part, name)| is_like(part, name))
}

/// Whether a name has the fixed texts of a part of a pattern, in their order.
fn is_like(part: &str, name: &str) -> bool {
    let mut texts = part.split('{').map(|text| text.split_once('}').map_or(text, |(_, text)| text));
    let Some(mut rest) = texts.next().and_then(|first| name.strip_prefix(first)) else {
        return false;
    };
    let mut is_exact = true;
    for text in texts {
        let Some((_, after)) = rest.rsplit_once(text) else { return false };
        (rest, is_exact) = (after, text.is_empty() || after.is_empty());
    }
    is_exact && (part.contains('{') || rest.is_empty())
}
