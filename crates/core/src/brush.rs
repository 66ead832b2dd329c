//! Whether a mask gave a point its class, and of which instance.

use crate::TrackId;

/// What a mask says of a point beside its class: nothing, that it painted it, or the instance too.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Brush(u32);

impl Brush {
    /// No mask painted the point.
    pub const NONE: Self = Self(0);

    /// A mask painted the point; instance 0 is none.
    pub fn of_instance(instance: u16) -> Self {
        Self(1 + u32::from(instance))
    }

    /// Whether a mask painted the point.
    pub fn is_painted(self) -> bool {
        self != Self::NONE
    }

    /// The instance, by a number that no track has.
    pub fn instance(self) -> Option<TrackId> {
        let number = u16::try_from(self.0.checked_sub(1)?).ok()?;
        (number > 0).then_some(TrackId(number))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_painted_point_need_not_have_an_instance() {
        let told = |brush: Brush| (brush.is_painted(), brush.instance());
        assert_eq!(told(Brush::NONE), (false, None));
        assert_eq!(told(Brush::of_instance(0)), (true, None));
        assert_eq!(told(Brush::of_instance(u16::MAX)), (true, Some(TrackId(u16::MAX))));
    }
}
