//! Features of the processor at hand, proved by tokens.

/// Proof that the processor has AVX2 and FMA. Only [`Avx2Fma::detect`] makes one.
#[derive(Debug, Clone, Copy)]
pub struct Avx2Fma(());

impl Avx2Fma {
    /// The proof, if the processor has both. Cost: the answer is cached.
    pub fn detect() -> Option<Avx2Fma> {
        let has_both =
            std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma");
        has_both.then_some(Avx2Fma(()))
    }
}
