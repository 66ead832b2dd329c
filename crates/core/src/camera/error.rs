//! What can be wrong with a calibration.

/// A calibration that no camera can have.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CameraError {
    /// A number outside of what the model allows.
    #[error("{name}: {found}, expected {expected}")]
    Number {
        /// Which number.
        name: &'static str,
        /// What the model allows.
        expected: &'static str,
        /// What was given.
        found: f64,
    },
    /// A list of coefficients of the wrong length.
    #[error("{name}: {found} coefficients, expected {expected}")]
    Count {
        /// Which list.
        name: &'static str,
        /// The lengths the model allows.
        expected: &'static str,
        /// What was given.
        found: usize,
    },
    /// A body mask that does not fill its image.
    #[error("body mask: {found} pixels, expected {width} x {height}")]
    BodyMaskSize {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// Pixels given.
        found: usize,
    },
}

/// Refuses a number for which `allowed` does not hold.
pub(super) fn check(
    name: &'static str,
    found: f64,
    expected: &'static str,
    allowed: impl Fn(f64) -> bool,
) -> Result<(), CameraError> {
    if allowed(found) {
        return Ok(());
    }
    Err(CameraError::Number { name, expected, found })
}

/// Refuses a list that holds a NaN or an infinity.
pub(super) fn check_finite(name: &'static str, numbers: &[f64]) -> Result<(), CameraError> {
    numbers.iter().try_for_each(|&number| check(name, number, "a finite number", f64::is_finite))
}

/// A list as an array of the only length a model allows, all finite.
pub(super) fn exactly<const N: usize>(
    name: &'static str,
    expected: &'static str,
    numbers: &[f64],
) -> Result<[f64; N], CameraError> {
    check_finite(name, numbers)?;
    let found = numbers.len();
    numbers.try_into().map_err(|_| CameraError::Count { name, expected, found })
}
