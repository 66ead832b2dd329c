//! Surfels: flat ellipses that a reconstruction is made of (2D Gaussian splatting).

use nalgebra::{Point3, Quaternion, UnitQuaternion, Vector3};
use occlabel_core::{CloudSettings, OpacityScale, SizeScale};

use super::columns::{Column, Row};

/// A surfel ends here whatever its opacity, standard deviations: what splatting draws of it.
const END_SIGMAS: f64 = 3.0;
/// A surfel that reaches farther than this is the sky or a mistake, metres.
const LARGEST_M: f64 = 20.0;

/// How surfels are read.
#[derive(Clone, Debug)]
pub(super) struct SurfelRules {
    pub(super) settings: CloudSettings,
    /// Points that stand for a surfel are so far apart, metres; none: a surfel is its centre.
    pub(super) spacing_m: Option<f64>,
}

/// What becomes of a point of a file.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Covered {
    /// It is the point itself.
    Point(Point3<f64>),
    /// It is a surfel that covers this.
    Ellipse(Ellipse),
    /// It is hardly there.
    Thin,
    /// It is too large to be a surface.
    Huge,
}

/// An ellipse: its centre, and its half axes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ellipse {
    centre: Point3<f64>,
    half_axes_m: [Vector3<f64>; 2],
    spacing_m: f64,
}

impl SurfelRules {
    /// What a point of a file stands for. A surfel is where its opacity, which falls off as a Gaussian, is
    /// at least `min_opacity`, and nowhere beyond three standard deviations.
    pub(super) fn covered(&self, row: &Row) -> Covered {
        let centre = Point3::from(row.all([Column::X, Column::Y, Column::Z]));
        let opacity = self.opacity(row.get(Column::Opacity));
        if opacity.is_some_and(|opacity| opacity.is_nan() || opacity < self.settings.min_opacity) {
            return Covered::Thin;
        }
        let (Some(spacing_m), Some(axes)) = (self.spacing_m, axes(row)) else {
            return Covered::Point(centre);
        };
        let end_sigmas = self.end_sigmas(opacity.unwrap_or(1.0));
        let half_m =
            row.all([Column::Scale0, Column::Scale1]).map(|scale| match self.settings.scale {
                SizeScale::Log => libm::exp(scale) * end_sigmas,
                SizeScale::Metres => scale.abs() * end_sigmas,
            });
        if half_m.iter().any(|half_m| half_m.is_nan()) {
            return Covered::Point(centre);
        }
        if half_m.iter().any(|half_m| *half_m > LARGEST_M) {
            return Covered::Huge;
        }
        let half_axes_m = [axes[0] * half_m[0], axes[1] * half_m[1]];
        Covered::Ellipse(Ellipse { centre, half_axes_m, spacing_m })
    }

    /// From 0 to 1; none if the file tells none.
    fn opacity(&self, written: f64) -> Option<f64> {
        let is_told = !written.is_nan();
        is_told.then(|| match self.settings.opacity {
            OpacityScale::Logit => 1.0 / (1.0 + libm::exp(-written)),
            OpacityScale::Linear => written.min(1.0),
        })
    }

    fn end_sigmas(&self, opacity: f64) -> f64 {
        let ratio = (opacity / self.settings.min_opacity).max(1.0);
        (2.0 * libm::log(ratio)).sqrt().min(END_SIGMAS)
    }
}

/// The two directions in which a surfel extends: its own x and y, else any two across its normal.
fn axes(row: &Row) -> Option<[Vector3<f64>; 2]> {
    let [w, x, y, z] = row.all([Column::Rot0, Column::Rot1, Column::Rot2, Column::Rot3]);
    let turn = Quaternion::new(w, x, y, z);
    if turn.norm() > 0.0 && turn.norm().is_finite() {
        let turn = UnitQuaternion::new_normalize(turn);
        return Some([turn * Vector3::x(), turn * Vector3::y()]);
    }
    let normal = Vector3::from(row.all([Column::NormalX, Column::NormalY, Column::NormalZ]));
    let normal = normal.try_normalize(0.0).filter(|normal| normal.norm().is_finite())?;
    let across = if normal.x.abs() < 0.7 { Vector3::x() } else { Vector3::y() };
    let first = normal.cross(&across).normalize();
    Some([first, normal.cross(&first)])
}

impl Ellipse {
    /// Points all over it, on a lattice along its axes, its centre one of them.
    pub(super) fn points(&self) -> impl Iterator<Item = Point3<f64>> + '_ {
        let [first, second] = &self.half_axes_m;
        self.lattice().map(move |[i, j]| self.centre + first * i + second * j)
    }

    /// How many points these are.
    pub(super) fn count(&self) -> u64 {
        self.lattice().count() as u64
    }

    /// Places in halves of the axes.
    fn lattice(&self) -> impl Iterator<Item = [f64; 2]> {
        let steps = self.half_axes_m.map(|half| (half.norm() / self.spacing_m).floor() as i32);
        let step = self.half_axes_m.map(|half| match half.norm() {
            0.0 => 0.0,
            half_m => self.spacing_m / half_m,
        });
        (-steps[0]..=steps[0])
            .flat_map(move |i| (-steps[1]..=steps[1]).map(move |j| [f64::from(i), f64::from(j)]))
            .map(move |[i, j]| [i * step[0], j * step[1]])
            .filter(|[i, j]| i * i + j * j <= 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rules(spacing_m: Option<f64>) -> SurfelRules {
        SurfelRules { settings: CloudSettings::default(), spacing_m }
    }

    /// A surfel of an opacity, of standard deviations along its x and y, turned about z by a quarter.
    fn surfel(opacity: f64, sigma_m: [f64; 2]) -> Row {
        let mut row = Row::empty();
        for (column, number) in [
            (Column::X, 1.0),
            (Column::Y, 2.0),
            (Column::Z, 3.0),
            (Column::Opacity, libm::log(opacity / (1.0 - opacity))),
            (Column::Scale0, libm::log(sigma_m[0])),
            (Column::Scale1, libm::log(sigma_m[1])),
            (Column::Rot0, 0.5_f64.sqrt()),
            (Column::Rot1, 0.0),
            (Column::Rot2, 0.0),
            (Column::Rot3, 0.5_f64.sqrt()),
        ] {
            row.set(column, number);
        }
        row
    }

    fn ellipse(row: &Row) -> Ellipse {
        match rules(Some(0.05)).covered(row) {
            Covered::Ellipse(ellipse) => ellipse,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_surfel_is_where_its_opacity_is_at_least_the_least() {
        // exp(-r^2 / 2) * 0.9 = 0.5 at r = 1.084.
        let points: Vec<_> = ellipse(&surfel(0.9, [1.0, 0.2])).points().collect();
        let reach = |axis: usize| {
            let away = points.iter().map(|p| (p[axis] - [1.0, 2.0, 3.0][axis]).abs());
            away.fold(0.0, f64::max)
        };
        assert!((reach(1) - 1.05).abs() < 1e-9, "its x looks along y: {}", reach(1));
        assert!((reach(0) - 0.2).abs() < 1e-9 && reach(2) < 1e-12, "{} {}", reach(0), reach(2));
        assert!(points.contains(&Point3::new(1.0, 2.0, 3.0)));
        assert_eq!(ellipse(&surfel(0.9, [1.0, 0.2])).count(), points.len() as u64);
    }

    #[test]
    fn thin_and_huge_surfels_are_none_and_points_stay_points() {
        assert_eq!(rules(Some(0.1)).covered(&surfel(0.49, [1.0; 2])), Covered::Thin);
        assert_eq!(rules(None).covered(&surfel(0.49, [1.0; 2])), Covered::Thin);
        assert_eq!(rules(Some(0.1)).covered(&surfel(0.9, [19.0, 0.1])), Covered::Huge);
        let centre = Covered::Point(Point3::new(1.0, 2.0, 3.0));
        assert_eq!(rules(None).covered(&surfel(0.9, [19.0, 0.1])), centre);
        let mut plain = surfel(0.9, [1.0; 2]);
        plain.set(Column::Scale0, f64::NAN);
        assert_eq!(rules(Some(0.1)).covered(&plain), centre);
    }

    #[test]
    fn a_normal_stands_in_for_a_rotation() {
        let mut row = surfel(0.9, [1.0; 2]);
        let turn = [Column::Rot0, Column::Rot1, Column::Rot2, Column::Rot3];
        turn.into_iter().for_each(|part| row.set(part, f64::NAN));
        [Column::NormalX, Column::NormalY].into_iter().for_each(|part| row.set(part, 0.0));
        row.set(Column::NormalZ, -2.0);
        assert!(ellipse(&row).points().all(|p| (p.z - 3.0).abs() < 1e-12));
    }

    #[test]
    fn a_settings_word_tells_how_numbers_are_written() {
        let mut row = surfel(0.5, [1.0; 2]);
        row.set(Column::Opacity, 0.9);
        [Column::Scale0, Column::Scale1].into_iter().for_each(|scale| row.set(scale, 0.2));
        let settings = CloudSettings {
            opacity: OpacityScale::Linear,
            scale: SizeScale::Metres,
            ..CloudSettings::default()
        };
        let rules = SurfelRules { settings, spacing_m: Some(0.05) };
        let Covered::Ellipse(ellipse) = rules.covered(&row) else { panic!("no ellipse") };
        assert!((ellipse.half_axes_m[0].norm() - 0.2 * 1.084_3).abs() < 1e-4);
    }
}
