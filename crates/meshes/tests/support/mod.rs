//! People of capsules: exact, and as meshes.
#![allow(dead_code, unreachable_pub, reason = "each test takes what it needs")]

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use occlabel_core::{Pose, TriangleMesh};

/// All within a radius of a segment.
#[derive(Clone, Copy, Debug)]
pub struct Capsule {
    pub from: Point3<f64>,
    pub to: Point3<f64>,
    pub radius_m: f64,
}

/// Samples of a voxel along each edge.
const SAMPLES: i32 = 12;

impl Capsule {
    pub fn distance_m(&self, p: &Point3<f64>) -> f64 {
        let way = self.to - self.from;
        let share = ((p - self.from).dot(&way) / way.norm_squared().max(1e-12)).clamp(0.0, 1.0);
        (p - (self.from + way * share)).norm() - self.radius_m
    }

    /// Whether it reaches into a voxel, by samples of the voxel.
    pub fn reaches(
        &self,
        centre: &Point3<f64>,
        here_from_grid: &Pose,
        half: &Vector3<f64>,
    ) -> bool {
        if self.distance_m(centre) > half.norm() {
            return false;
        }
        let share = |n: i32| f64::from(n) / f64::from(SAMPLES) * 2.0 - 1.0;
        let sample =
            |x, y, z| Vector3::new(share(x), share(y), share(z)).component_mul(half) * 0.9999;
        let all = (0..=SAMPLES).flat_map(|x| (0..=SAMPLES).map(move |y| (x, y)));
        let mut all = all.flat_map(|(x, y)| (0..=SAMPLES).map(move |z| (x, y, z)));
        all.any(|(x, y, z)| {
            self.distance_m(&(centre + here_from_grid.rotation * sample(x, y, z))) < 0.0
        })
    }

    /// Where a ray first meets it.
    pub fn cast(&self, from: &Point3<f64>, way: &Vector3<f64>, max_m: f64) -> Option<f64> {
        let mut at_m = 0.0;
        while at_m < max_m {
            let step_m = self.distance_m(&(from + way * at_m));
            if step_m < 1e-6 {
                return Some(at_m);
            }
            at_m += step_m;
        }
        None
    }
}

pub fn ball(radius_m: f64) -> Capsule {
    Capsule { from: Point3::origin(), to: Point3::origin(), radius_m }
}

/// A person whose limbs swing against each other, by an angle.
pub fn person(swing_rad: f64) -> Vec<Capsule> {
    let part = |from: [f64; 3], to: [f64; 3], radius_m| Capsule {
        from: from.into(),
        to: to.into(),
        radius_m,
    };
    let limb = |at: [f64; 3], long: f64, swing: f64, radius_m| {
        let (sin, cos) = libm::sincos(swing);
        part(at, [at[0] + long * sin, at[1], at[2] - long * cos], radius_m)
    };
    vec![
        part([0.0, 0.0, 0.1], [0.0, 0.0, 0.46], 0.19),
        part([0.0, 0.0, 0.75], [0.0, 0.0, 0.75], 0.12),
        limb([0.0, 0.1, -0.02], 0.77, swing_rad, 0.08),
        limb([0.0, -0.1, -0.02], 0.77, -swing_rad, 0.08),
        limb([0.0, 0.25, 0.46], 0.54, -swing_rad, 0.055),
        limb([0.0, -0.25, 0.46], 0.54, swing_rad, 0.055),
    ]
}

/// Capsules as one mesh that passes through itself, of so many corners around.
pub fn mesh(parts: &[Capsule], around: u32) -> TriangleMesh {
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for part in parts {
        add(part, around, &mut vertices, &mut faces);
    }
    TriangleMesh::new(vertices, faces).unwrap()
}

fn add(part: &Capsule, around: u32, vertices: &mut Vec<Point3<f64>>, faces: &mut Vec<[u32; 3]>) {
    let axis = (part.to - part.from).try_normalize(1e-9).unwrap_or_else(Vector3::z);
    let turn = Rotation3::rotation_between(&Vector3::z(), &axis)
        .unwrap_or_else(|| Rotation3::from_axis_angle(&Vector3::x_axis(), FRAC_PI_2 * 2.0));
    let first = vertices.len() as u32;
    let rings = around / 2 + 1;
    for ring in 0..=rings {
        // Both middle rings stand at the equator, one at each end.
        let step = if ring <= rings / 2 { ring } else { ring - 1 };
        let (sin, cos) = libm::sincos(f64::from(step) / f64::from(rings - 1) * FRAC_PI_2 * 2.0);
        let end = if ring <= rings / 2 { part.to } else { part.from };
        for corner in 0..around {
            let (y, x) = libm::sincos(f64::from(corner) / f64::from(around) * TAU);
            let local = Vector3::new(x * sin, y * sin, cos) * part.radius_m;
            vertices.push(end + turn * local);
        }
    }
    for ring in 0..rings {
        for corner in 0..around {
            let at = |ring: u32, corner: u32| first + ring * around + corner % around;
            let [a, b, c, d] = [
                at(ring, corner),
                at(ring, corner + 1),
                at(ring + 1, corner),
                at(ring + 1, corner + 1),
            ];
            faces.extend([[a, c, b], [b, c, d]]);
        }
    }
}

pub fn turned(turn: [f64; 3], shift: [f64; 3]) -> Pose {
    let turn = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
    Pose::from_parts(Translation3::from(shift), turn)
}
