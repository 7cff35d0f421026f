//! Linear factors of closed forms.

use super::elements::Elements;
use super::linear_simplex::{Line, LinearSimplex, line_of, scaled};
use spmesh_delaunay::predicates::Point2;

/// Linear factors of functions in elements, as functions of the offset from the origin of the closed form.
#[derive(Debug, Clone, Default)]
pub(super) struct Factors {
    pub(super) offsets: Vec<u32>,
    pub(super) all: Vec<(u32, Line)>,
}

impl Factors {
    /// The factors of elements that have closed forms; `sizes` are the areas of their supports.
    pub(super) fn of(
        elements: &Elements,
        linear_simplices: &[LinearSimplex],
        sizes: &[f64],
        points: &[Point2],
    ) -> Factors {
        let mut factors = Factors { offsets: vec![0], all: Vec::new() };
        for (at, (linear_simplex, size)) in linear_simplices.iter().zip(sizes).enumerate() {
            for shares in elements.shares(at).chunk_by(|a, b| a.function == b.function) {
                let mut sum = [0.0; 3];
                for share in shares {
                    let edge = share.edge.map(|id| points[id as usize]);
                    let line = scaled(line_of(edge, linear_simplex.origin), share.factor / size);
                    sum = [0, 1, 2].map(|place| sum[place] + line[place]);
                }
                factors.all.push((shares[0].function, sum));
            }
            factors.offsets.push(factors.all.len() as u32);
        }
        factors
    }

    #[inline(always)]
    pub(super) fn of_element(&self, element: usize) -> &[(u32, Line)] {
        &self.all[self.offsets[element] as usize..self.offsets[element + 1] as usize]
    }
}
