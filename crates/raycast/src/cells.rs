//! What a voxel remembers of the rays that crossed it.

/// A voxel's crossings.
pub(crate) trait Cell: Copy + Default + Send + Sync {
    /// One more.
    fn cross(&mut self);

    /// How many there were.
    fn crossings(self) -> u32;
}

/// All of them.
impl Cell for u32 {
    #[inline(always)]
    fn cross(&mut self) {
        *self += 1;
    }

    #[inline(always)]
    fn crossings(self) -> u32 {
        self
    }
}

/// Whether there were any.
impl Cell for bool {
    #[inline(always)]
    fn cross(&mut self) {
        *self = true;
    }

    #[inline(always)]
    fn crossings(self) -> u32 {
        u32::from(self)
    }
}
