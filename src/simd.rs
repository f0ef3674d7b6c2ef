//! Which instructions this processor has, asked at run time.

/// The code paths that kernels come in. Each computes with the same structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Simd {
    /// Any processor.
    Portable,
    /// x86-64 with AVX2 and FMA. Public functions that take it fall back where [`Simd::detect`] would not return it.
    Avx2,
}

impl Simd {
    /// The best path of this processor. With the feature `std`, whose standard library remembers the answer, it costs nothing; without, a few
    /// microseconds on a virtual machine: ask once a kernel, not once a row.
    ///
    /// ```
    /// use fixpair::simd::Simd;
    ///
    /// println!("{:?}", Simd::detect()); // what kernels use unless told otherwise
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub fn detect() -> Self {
        #[cfg(all(target_arch = "x86_64", feature = "std"))]
        let has = std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma");
        #[cfg(all(target_arch = "x86_64", not(feature = "std")))]
        let has = asked::avx2_and_fma();
        #[cfg(not(target_arch = "x86_64"))]
        let has = false;
        if has { Self::Avx2 } else { Self::Portable }
    }

    /// Runs a loop compiled for this path. Only the width of the instructions differs: the compiler never fuses or reorders
    /// floating-point operations, so the results are the same bits. `body` has to be `#[inline(always)]` to gain.
    #[inline(always)]
    pub(crate) fn vectorise<R>(self, body: impl FnOnce() -> R) -> R {
        #[cfg(target_arch = "x86_64")]
        {
            #[target_feature(enable = "avx2")]
            fn wide<R>(body: impl FnOnce() -> R) -> R {
                body()
            }
            if self == Self::Avx2 {
                // SAFETY: inside the crate `Avx2` comes from `detect`, so the processor has it.
                return unsafe { wide(body) };
            }
        }
        body()
    }
}

/// The processor itself, asked without an operating system.
#[cfg(all(target_arch = "x86_64", any(test, not(feature = "std"))))]
mod asked {
    use core::arch::x86_64::{__cpuid, __cpuid_count, _xgetbv};

    const FMA: u32 = 1 << 12;
    const OSXSAVE: u32 = 1 << 27;
    const AVX: u32 = 1 << 28;
    const AVX2: u32 = 1 << 5;

    #[target_feature(enable = "xsave")]
    fn system_saves_ymm() -> bool {
        // SAFETY: register 0 exists wherever xgetbv does.
        unsafe { _xgetbv(0) & 0b110 == 0b110 }
    }

    pub(super) fn avx2_and_fma() -> bool {
        let wanted = FMA | OSXSAVE | AVX;
        if __cpuid(0).eax < 7 || __cpuid(1).ecx & wanted != wanted {
            return false;
        }
        // SAFETY: OSXSAVE says that the system lets programs execute xgetbv.
        let saved = unsafe { system_saves_ymm() };
        saved && __cpuid_count(7, 0).ebx & AVX2 != 0
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::{Simd, asked};

    #[test]
    fn the_processor_says_what_the_standard_library_says() {
        let expected = std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma");
        assert_eq!(asked::avx2_and_fma(), expected);
        assert_eq!(Simd::detect() == Simd::Avx2, expected);
    }
}
