//! How a body moved between two keyframes.

use nalgebra::{Matrix3, Matrix4, Point3, Quaternion, Translation3, UnitQuaternion};
use occlabel_core::{Pose, TriangleMesh};

/// The rigid motion that best takes one mesh to another.
///
/// Meshes that are alike are compared vertex by vertex, by least squares: swinging limbs cancel out.
/// Of others only the centres are.
pub fn motion_between(from: &TriangleMesh, to: &TriangleMesh) -> Pose {
    let (start, end) = (from.centre(), to.centre());
    let turn = match from.is_like(to) {
        true => best_turn(&spread(from, &start, to, &end)),
        false => UnitQuaternion::identity(),
    };
    Pose::from_parts(Translation3::from(end.coords - turn * start.coords), turn)
}

/// Sums of the products of coordinates about the centres, those of `from` by row.
fn spread(
    from: &TriangleMesh,
    start: &Point3<f64>,
    to: &TriangleMesh,
    end: &Point3<f64>,
) -> Matrix3<f64> {
    let pairs = from.vertices().iter().zip(to.vertices());
    pairs.map(|(a, b)| (a - start) * (b - end).transpose()).sum()
}

/// The turn that best takes vectors to their partners, from the sums of their products: the eigenvector
/// of the largest eigenvalue, as a quaternion (Horn 1987).
fn best_turn(s: &Matrix3<f64>) -> UnitQuaternion<f64> {
    let off = |a: usize, b: usize| s[(a, b)] - s[(b, a)];
    let sum = |a: usize, b: usize| s[(a, b)] + s[(b, a)];
    let (x, y, z) = (s[(0, 0)], s[(1, 1)], s[(2, 2)]);
    #[rustfmt::skip]
    let n = Matrix4::new(
        x + y + z, off(1, 2), off(2, 0), off(0, 1),
        off(1, 2), x - y - z, sum(0, 1), sum(2, 0),
        off(2, 0), sum(0, 1), y - x - z, sum(1, 2),
        off(0, 1), sum(2, 0), sum(1, 2), z - x - y,
    );
    let eigen = n.symmetric_eigen();
    let q = eigen.eigenvectors.column(eigen.eigenvalues.imax());
    UnitQuaternion::new_normalize(Quaternion::new(q[0], q[1], q[2], q[3]))
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    fn mesh() -> TriangleMesh {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.2], [0.0, 0.6, 0.0], [0.1, 0.0, 1.8]];
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        TriangleMesh::new(corners.map(Point3::from).to_vec(), faces).unwrap()
    }

    #[test]
    fn meshes_that_are_alike_tell_how_they_were_turned_and_moved() {
        for turn in [[0.0; 3], [0.0, 0.0, 0.4], [0.3, -0.2, 3.0], [0.1, 2.0, -0.3]] {
            let turn = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
            let moved = Pose::from_parts(Translation3::new(700.0, -20.0, 3.0), turn);
            let found = motion_between(&mesh(), &mesh().moved(&moved));
            let off = (found.inverse() * moved).to_homogeneous() - Matrix4::identity();
            assert!(off.norm() < 1e-9, "{off}");
        }
    }

    #[test]
    fn of_other_meshes_the_centres_tell() {
        let other = TriangleMesh::new(mesh().vertices()[..3].to_vec(), [[0, 2, 1]]).unwrap();
        let way = motion_between(&mesh(), &other);
        assert_eq!(way.rotation, UnitQuaternion::identity());
        assert!((way * mesh().centre() - other.centre()).norm() < 1e-12);
    }
}
