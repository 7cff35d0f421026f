//! Special configurations of degree 1, for quadratic splines with box splines or sharp features (thesis,
//! chapter 8).
//!
//! A [`Special`] holds knots, a triangulation of them, and required diagonals of links of some knots. [`zp`]
//! and [`patches`] reproduce box splines on grids (`boxes`, thesis 8.2). [`features()`] makes corners and
//! creases sharp, and linear elements linear (8.3.1). [`Special::functions`] sums the B-splines of degree 2
//! that belong together, such as those of coinciding knots.

mod basis;
mod boxes;
mod constrained;
mod features;

pub use boxes::{Patch, ZpSplit, patches, zp};
pub use constrained::Diagonals;
pub use features::{Crease, Features, features};
pub use spmesh_stream::model::functions::{Function, FunctionKind};

use super::knots::Knots;
use super::rule::Rule;
use super::surface::Start;
use basis::Collection;
use spmesh_base::error::Result;
use spmesh_stream::model::configurations::{Configurations, Links};

/// Knots with a start and required diagonals for special configurations of degree 1.
#[derive(Debug, Clone)]
pub struct Special {
    /// The knots: the given ones, with the same ids, followed by added ones.
    pub knots: Knots,
    /// The triangulation.
    pub start: Start,
    /// Required diagonals of links of single knots.
    pub diagonals: Diagonals,
    collection: Collection,
}

/// The functions that quadratic splines are made of, where nothing is special except coinciding knots; as
/// [`Special::functions`].
///
/// # Errors
/// Links of another size.
pub fn functions(knots: &Knots, links: &Links) -> Result<Vec<Function>> {
    Collection::default().functions(knots, links)
}

impl Special {
    /// All degrees from 0 to `degree`, in order; `rule` triangulates the parts of links that the required
    /// diagonals leave open.
    ///
    /// # Errors
    /// Those of [`super::generate`].
    pub fn generate(&self, rule: &Rule, degree: usize) -> Result<Vec<Configurations>> {
        super::check_degree(&self.knots, degree)?;
        let mut all = vec![self.start.configurations()];
        for lower in 0..degree {
            let diagonals = if lower == 0 { &self.diagonals } else { &Diagonals::default() };
            let next = super::step(&self.knots, &all[lower], rule, diagonals)?;
            all.push(next);
        }
        Ok(all)
    }

    /// The functions that quadratic splines are made of, as sums of B-splines; `links` are those of degree 1.
    ///
    /// The shares of each B-spline sum to one, so the functions sum to one where the B-splines do. B-splines
    /// of null links are zero and left out. The B-spline of a link through the faraway point consists of its
    /// finite edges.
    ///
    /// # Errors
    /// Links of another size.
    pub fn functions(&self, links: &Links) -> Result<Vec<Function>> {
        self.collection.functions(&self.knots, links)
    }
}
