//! Functions by their interior sets.

use spmesh_delaunay::predicates::Point2;

/// The interior sets of functions, with their factors.
#[derive(Debug, Clone, Default)]
pub(super) struct FunctionSets {
    pub(super) size: usize,
    knots: Vec<u32>,
    factors: Vec<f64>,
    offsets: Vec<u32>,
}

impl FunctionSets {
    pub(super) fn new(size: usize) -> FunctionSets {
        FunctionSets { size, offsets: vec![0], ..FunctionSets::default() }
    }

    pub(super) fn len(&self) -> usize {
        self.offsets.len() - 1
    }

    pub(super) fn push<'a>(&mut self, terms: impl Iterator<Item = (&'a [u32], f64)>) {
        for (set, factor) in terms {
            self.knots.extend_from_slice(set);
            self.factors.push(factor);
        }
        self.offsets.push(self.factors.len() as u32);
    }

    pub(super) fn terms(&self, function: usize) -> impl Iterator<Item = (&[u32], f64)> {
        let range = self.offsets[function] as usize..self.offsets[function + 1] as usize;
        range.map(|at| (&self.knots[at * self.size..][..self.size], self.factors[at]))
    }

    pub(super) fn greville(&self, function: usize, points: &[Point2]) -> Point2 {
        let whole: f64 = self.terms(function).map(|(_, factor)| factor).sum();
        // If the factors sum to zero, a weighted mean is undefined: all sets weigh the same.
        let weight = |factor: f64| {
            if whole == 0.0 { 1.0 / self.terms(function).count() as f64 } else { factor / whole }
        };
        let mean = |set: &[u32], axis: usize| {
            set.iter().map(|&id| points[id as usize][axis]).sum::<f64>() / self.size as f64
        };
        [0, 1].map(|axis| self.terms(function).map(|(set, factor)| mean(set, axis) * weight(factor)).sum())
    }
}
