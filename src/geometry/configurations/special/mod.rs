//! Special configurations of degree 1, for quadratic splines of a purpose (thesis, chapter 8).
//!
//! Each is knots, a triangulation of them, and diagonals that links of some knots must have: a [`Special`].
//! [`zp`] and [`patches`] reproduce box splines on grids (`boxes`, thesis 8.2), [`features()`] makes corners
//! and creases sharp, and linear elements linear (8.3.1). The B-splines of degree 2 that belong together, on
//! account of knots at one place for instance, are summed: [`Special::functions`] says how.

mod basis;
mod boxes;
mod constrained;
mod diagonals;
mod features;

pub use boxes::{Patch, ZpSplit, patches, zp};
pub use diagonals::Diagonals;
pub use features::{Crease, Features, features};
pub use spmesh_model::functions::{Function, FunctionKind};

use super::knots::Knots;
use super::rule::Rule;
use super::surface::Start;
use basis::Collection;
use spmesh_core::error::Result;
use spmesh_model::configurations::{Configurations, Links};

/// Knots with what configurations of degree 1 need for a purpose.
#[derive(Debug, Clone)]
pub struct Special {
    /// The knots: those given, with the same ids, and after them those that the purpose needs.
    pub knots: Knots,
    /// The triangulation.
    pub start: Start,
    /// What links of single knots must have.
    pub diagonals: Diagonals,
    collection: Collection,
}

/// The functions that quadratic splines are made of, if nothing is special but knots at one place: as
/// [`Special::functions`].
///
/// # Errors
/// Links of another size.
pub fn functions(knots: &Knots, links: &Links) -> Result<Vec<Function>> {
    Collection::default().functions(knots, links)
}

impl Special {
    /// All degrees from 0 to `degree`, in order: `rule` triangulates what is not determined.
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
    /// Each B-spline has shares of one altogether: so the functions sum to one where the B-splines do. Those
    /// of null links are zero, and left out; of a link through the faraway point, the finite edges make the
    /// B-spline.
    ///
    /// # Errors
    /// Links of another size.
    pub fn functions(&self, links: &Links) -> Result<Vec<Function>> {
        self.collection.functions(&self.knots, links)
    }
}
