//! Kernels compiled once for each instruction set, chosen when the program runs.
//!
//! The kernels themselves are plain loops over arrays of a fixed length, which the compiler turns
//! into vector instructions. This file only has them compiled for more than the oldest processor of
//! the target; it holds all `unsafe` of the project, and the results are the same at every level.

/// Loops over lanes that gain from wide registers.
///
/// `run`, and all that it calls in its loops, must be `#[inline(always)]`: what is not inlined is
/// compiled for the oldest processor.
pub trait Kernel {
    /// What it gives.
    type Output;

    /// Does the work.
    fn run(self) -> Self::Output;
}

/// An instruction set that kernels are compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// What every processor of the target has (x86-64: SSE2; arm64: NEON).
    Portable,
    /// 256-bit registers.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// 512-bit registers with masks.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Level {
    /// The levels that this processor has, the best one last.
    pub fn all() -> Vec<Self> {
        let mut levels = vec![Self::Portable];
        #[cfg(target_arch = "x86_64")]
        {
            levels.extend(is_x86_feature_detected!("avx2").then_some(Self::Avx2));
            levels.extend(has_avx512().then_some(Self::Avx512));
        }
        levels
    }

    /// The best level of this processor.
    pub fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if has_avx512() {
                return Self::Avx512;
            }
            if is_x86_feature_detected!("avx2") {
                return Self::Avx2;
            }
        }
        Self::Portable
    }

    /// Runs a kernel as compiled for this level.
    ///
    /// # Panics
    /// If this processor does not have the level.
    #[allow(unsafe_code)]
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self {
            Self::Portable => kernel.run(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => {
                assert!(is_x86_feature_detected!("avx2"), "no AVX2 here");
                // SAFETY: the processor has every feature that the function is compiled for.
                unsafe { x86::run_avx2(kernel) }
            }
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                assert!(has_avx512(), "no AVX-512 here");
                // SAFETY: the processor has every feature that the function is compiled for.
                unsafe { x86::run_avx512(kernel) }
            }
        }
    }
}

#[cfg(target_arch = "x86_64")]
fn has_avx512() -> bool {
    is_x86_feature_detected!("avx2")
        && is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512bw")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::Kernel;

    #[target_feature(enable = "avx2")]
    pub(super) fn run_avx2<K: Kernel>(kernel: K) -> K::Output {
        kernel.run()
    }

    #[target_feature(enable = "avx2,avx512f,avx512bw,avx512dq,avx512vl")]
    pub(super) fn run_avx512<K: Kernel>(kernel: K) -> K::Output {
        kernel.run()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Sum<'a>(&'a [u32; 64]);

    impl Kernel for Sum<'_> {
        type Output = u32;

        #[inline(always)]
        fn run(self) -> u32 {
            self.0.iter().sum()
        }
    }

    #[test]
    fn every_level_gives_the_same() {
        let numbers = std::array::from_fn(|i| i as u32);
        let levels = Level::all();
        assert!(levels.iter().all(|level| level.run(Sum(&numbers)) == 64 * 63 / 2));
        assert_eq!(levels.last(), Some(&Level::best()));
    }
}
