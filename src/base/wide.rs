//! Loops compiled for wider registers, where the processor has them.

/// A loop over arrays. Implement [`Loop::run`] with `#[inline(always)]`: it is compiled twice.
pub trait Loop {
    /// What it returns.
    type Output;

    /// Runs it.
    fn run(self) -> Self::Output;
}

/// Runs a loop with AVX2 if the processor has it. The operations, and so the results, are the same: products
/// and sums are not fused.
#[inline]
pub fn run_wide<L: Loop>(task: L) -> L::Output {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has AVX2.
        return unsafe { run_avx2(task) };
    }
    task.run()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn run_avx2<L: Loop>(task: L) -> L::Output {
    task.run()
}
