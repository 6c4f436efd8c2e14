//! Runs a kernel with the widest vector instructions of the processor at hand.
//!
//! A kernel is plain Rust over fixed-size arrays; the compiler vectorises one copy of it for each level. Every kernel
//! rounds in a fixed order (a fixed number of lanes, explicit `mul_add`), so that all levels give the same bits.
//! Kernels have no closures: the compiler may leave one out of line, and then compiles it for the portable level only.

/// A computation worth compiling for several instruction sets.
pub trait Kernel {
    /// What it computes.
    type Output;

    /// Computes it. Implementations are `#[inline(always)]`, and so is all that they call.
    fn run(self) -> Self::Output;
}

/// A set of vector instructions; what this processor lacks cannot be made outside this module.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Level(Instructions);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Instructions {
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Level {
    /// The levels that this processor has, the widest first.
    pub fn available() -> Vec<Self> {
        let mut levels = Self::wide();
        levels.push(Self(Instructions::Portable));
        levels
    }

    #[cfg(target_arch = "x86_64")]
    fn wide() -> Vec<Self> {
        let mut levels = Vec::new();
        let avx2 = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
        if avx2 && is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512dq") {
            levels.push(Self(Instructions::Avx512));
        }
        if avx2 {
            levels.push(Self(Instructions::Avx2));
        }
        levels
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn wide() -> Vec<Self> {
        Vec::new()
    }

    /// The widest level that this processor has.
    pub fn best() -> Self {
        Self::available()[0]
    }

    /// Runs `kernel` with this level's instructions.
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self.0 {
            Instructions::Portable => kernel.run(),
            // SAFETY: a `Level` of these instructions is only made by `available`, after the processor said that it
            // has them.
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx2 => unsafe { run_avx2(kernel) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx512 => unsafe { run_avx512(kernel) },
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn run_avx2<K: Kernel>(kernel: K) -> K::Output {
    kernel.run()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx2,fma")]
fn run_avx512<K: Kernel>(kernel: K) -> K::Output {
    kernel.run()
}
