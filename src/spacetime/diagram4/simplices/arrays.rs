//! The simplices and spheres of a complex, and the room behind them, where a star is made.

use super::coefficient::Coefficient;
use super::complex::{FACETS, Facet, Simplex, Sphere, facet_of, simplex_of};
use std::marker::PhantomData;

/// The simplices and spheres in arrays, and in the room behind them.
///
/// New simplices are written to the room directly, not over dummies. Indices come from the kernel's own
/// arrays, so only debug builds, which tests are, check them. Together this saves up to 3 % of the time.
#[derive(Debug)]
pub(super) struct Arrays<'s, C> {
    simplices: *mut Simplex,
    spheres: *mut Sphere<C>,
    /// How many there is room for.
    len: usize,
    arrays: PhantomData<&'s mut [Sphere<C>]>,
}

impl<'s, C: Coefficient> Arrays<'s, C> {
    /// The simplices and spheres of arrays, and of the room behind them.
    ///
    /// # Safety
    /// All facets and simplices that this is used with are in the arrays or in the room behind them, and what
    /// is read from the room was written.
    pub(super) unsafe fn of(
        simplices: &'s mut Vec<Simplex>,
        spheres: &'s mut Vec<Sphere<C>>,
    ) -> Arrays<'s, C> {
        let len = simplices.capacity().min(spheres.capacity());
        Arrays { simplices: simplices.as_mut_ptr(), spheres: spheres.as_mut_ptr(), len, arrays: PhantomData }
    }

    #[inline(always)]
    pub(super) fn vertices(&self, simplex: usize) -> [u32; FACETS] {
        debug_assert!(simplex < self.len);
        // SAFETY: the promise made to `of`.
        unsafe { (*self.simplices.add(simplex)).vertices }
    }

    #[inline(always)]
    pub(super) fn neighbour(&self, facet: Facet) -> Facet {
        debug_assert!(simplex_of(facet) < self.len);
        // SAFETY: the promise made to `of`.
        unsafe { (*self.simplices.add(simplex_of(facet))).neighbours[facet_of(facet)] }
    }

    #[inline(always)]
    pub(super) fn set_neighbour(&mut self, facet: Facet, neighbour: Facet) {
        debug_assert!(simplex_of(facet) < self.len);
        // SAFETY: the promise made to `of`.
        unsafe { (*self.simplices.add(simplex_of(facet))).neighbours[facet_of(facet)] = neighbour }
    }

    #[inline(always)]
    pub(super) fn set(&mut self, simplex: usize, vertices: [u32; FACETS], sphere: Sphere<C>) {
        debug_assert!(simplex < self.len);
        // SAFETY: the promise made to `of`.
        unsafe {
            (*self.simplices.add(simplex)).vertices = vertices;
            *self.spheres.add(simplex) = sphere;
        }
    }
}
