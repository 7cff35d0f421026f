//! Runs the same insertion with the instructions of the processor at hand.

use super::build::Build;
use super::exact::Exact;
use super::lanes::Portable;
use super::weights::Weights;
#[cfg(target_arch = "x86_64")]
use {super::avx2::Avx2, crate::processor::Avx2Fma};

/// Runs `build` with the widest vectors of the processor, or with portable code if the build asks for it.
pub(super) fn run<W: Weights>(build: Build<'_, '_, W>, predicates: &mut dyn Exact) {
    #[cfg(target_arch = "x86_64")]
    if let Some(token) = Avx2Fma::detect()
        && !build.setting.is_portable
    {
        // SAFETY: the token proves that the processor has AVX2 and FMA.
        return unsafe { run_avx2(build, predicates, token) };
    }
    build.run::<Portable>(predicates, ());
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn run_avx2<W: Weights>(build: Build<'_, '_, W>, predicates: &mut dyn Exact, token: Avx2Fma) {
    build.run::<Avx2>(predicates, token);
}
