//! Number of decisions by each stage of the predicates.

/// Decisions by stage. Every call of `orient2d`, `incircle`, `orient3d` or `insphere` is one decision in
/// exactly one of the first five.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct PredicateCounts {
    /// Decided in `f64` because the value exceeds its error bound.
    pub filter: u64,
    /// Decided exactly in integers (of `f64`, `i64`, `i128` or a pair of these).
    pub integer: u64,
    /// Decided by pairs of `f64`.
    pub pairs: u64,
    /// Decided by residues, which tell ties.
    pub residues: u64,
    /// Decided by arbitrary-precision integers.
    pub bigint: u64,
    /// Among the decisions above, in-circle and in-sphere tests that were zero and fell to the perturbation.
    pub perturbed: u64,
}

impl PredicateCounts {
    /// Adds the decisions of `other`.
    pub fn merge(&mut self, other: &PredicateCounts) {
        self.filter += other.filter;
        self.integer += other.integer;
        self.pairs += other.pairs;
        self.residues += other.residues;
        self.bigint += other.bigint;
        self.perturbed += other.perturbed;
    }

    /// Each count with a label for people and a key for programs.
    pub fn rows(&self) -> [(&'static str, &'static str, u64); 6] {
        [
            ("predicates: filter", "predicates_filter", self.filter),
            ("predicates: integer", "predicates_integer", self.integer),
            ("predicates: pairs", "predicates_pairs", self.pairs),
            ("predicates: residues", "predicates_residues", self.residues),
            ("predicates: big integer", "predicates_bigint", self.bigint),
            ("predicates: ties broken", "predicates_perturbed", self.perturbed),
        ]
    }

    /// Number of decisions, whatever the stage.
    pub fn total(&self) -> u64 {
        self.filter + self.integer + self.pairs + self.residues + self.bigint
    }
}
