//! Poses of the tables, checked.

use nalgebra::{Quaternion, Translation3, UnitQuaternion};
use occlabel_core::{Fault, Pose};

use super::number::{Number, plain};
use super::rows::{CalibratedSensor, EgoPose, SampleAnnotation};
use super::table::{Row, Table};
use crate::notes::Notes;
use crate::transform::{A_PLACE, is_place};

/// A quaternion's norm may be off by this much: rounding of 32-bit numbers and printed digits.
const SILENT_NORM_ERROR: f64 = 1e-6;
/// A norm off by more than this tells no rotation.
const LARGEST_NORM_ERROR: f64 = 1e-2;

/// The order in which quaternions stand in the tables.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum QuaternionOrder {
    /// The real part first, as nuScenes has it.
    #[default]
    Wxyz,
    /// The real part last, as some converters write it.
    Xyzw,
}

/// A row that places something.
pub(super) trait Placed: Table {
    /// Translation in metres, and rotation as it stands in the table.
    fn placement(&self) -> (&[Number; 3], &[Number; 4]);
}

impl Placed for EgoPose {
    fn placement(&self) -> (&[Number; 3], &[Number; 4]) {
        (&self.translation, &self.rotation)
    }
}

impl Placed for CalibratedSensor {
    fn placement(&self) -> (&[Number; 3], &[Number; 4]) {
        (&self.translation, &self.rotation)
    }
}

impl Placed for SampleAnnotation {
    fn placement(&self) -> (&[Number; 3], &[Number; 4]) {
        (&self.translation, &self.rotation)
    }
}

impl<T: Placed> Row<T> {
    /// The row's pose, its rotation renormalised. A norm off by more than 1e-6 is noted.
    ///
    /// # Errors
    /// If the norm is off by more than 1e-2, a number is not finite, or the place beyond 1e9 m.
    pub(super) fn pose(&self, order: QuaternionOrder, notes: &mut Notes) -> Result<Pose, Fault> {
        let (translation, rotation) = self.placement();
        let translation = plain(translation);
        if !is_place(&translation) {
            let found = format!("{translation:?}");
            return Err(self.fault("translation", A_PLACE, found));
        }
        let rotation = quaternion(plain(rotation), order);
        let off = (rotation.norm() - 1.0).abs();
        if off.is_nan() || off > LARGEST_NORM_ERROR {
            let expected = format!("a quaternion of norm 1 to {LARGEST_NORM_ERROR}");
            return Err(self.fault("quaternion-norm", expected, norm(&rotation)));
        }
        if off > SILENT_NORM_ERROR {
            let expected = format!("a quaternion of norm 1 to {SILENT_NORM_ERROR}");
            notes.warn(self.fault("quaternion-norm", expected, norm(&rotation)));
        }
        let rotation = UnitQuaternion::new_normalize(rotation);
        Ok(Pose::from_parts(Translation3::from(translation), rotation))
    }
}

fn quaternion(rotation: [f64; 4], order: QuaternionOrder) -> Quaternion<f64> {
    let [w, x, y, z] = match order {
        QuaternionOrder::Wxyz => rotation,
        QuaternionOrder::Xyzw => [rotation[3], rotation[0], rotation[1], rotation[2]],
    };
    Quaternion::new(w, x, y, z)
}

fn norm(rotation: &Quaternion<f64>) -> String {
    format!("norm {}", rotation.norm())
}
