//! The same insertion in the instructions of the processor at hand.

use super::build::{Build, Built};
use super::exact::Exact;
use super::lanes;

/// Runs `build` with the widest lanes there are, unless it wants those that are everywhere.
pub(super) fn run(build: Build, predicates: &mut dyn Exact) -> Built {
    #[cfg(target_arch = "x86_64")]
    if !build.is_portable
        && std::arch::is_x86_feature_detected!("avx2")
        && std::arch::is_x86_feature_detected!("fma")
    {
        // Safety: the processor has AVX2 and FMA.
        return unsafe { run_avx2(build, predicates) };
    }
    build.run::<lanes::Portable>(predicates)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn run_avx2(build: Build, predicates: &mut dyn Exact) -> Built {
    build.run::<lanes::avx2::Avx2>(predicates)
}
