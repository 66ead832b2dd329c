//! Polygons of files, as triangles.

/// Adds a polygon as a fan of triangles around its first corner; `None` if it has less than three.
pub(super) fn fan(corners: &[u32], faces: &mut Vec<[u32; 3]>) -> Option<()> {
    let [first, rest @ ..] = corners else { return None };
    if rest.len() < 2 {
        return None;
    }
    faces.extend(rest.windows(2).map(|edge| [*first, edge[0], edge[1]]));
    Some(())
}
