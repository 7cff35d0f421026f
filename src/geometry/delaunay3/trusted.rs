//! Arrays whose indices are not checked in release builds.
//!
//! The search of a cavity takes nearly all indices from arrays of the kernel. Checks of bounds took 8 % of all
//! time.

use std::ops::{Index, IndexMut};

/// An array that is used at indices in bounds only. Debug builds, as tests are, check that.
#[derive(Debug)]
pub(super) struct Trusted<'a, T>(&'a mut [T]);

impl<'a, T> Trusted<'a, T> {
    /// # Safety
    /// As long as this exists, it is used at indices in bounds only.
    #[inline(always)]
    pub(super) unsafe fn new(array: &'a mut [T]) -> Trusted<'a, T> {
        Trusted(array)
    }

    /// The whole array.
    #[inline(always)]
    pub(super) fn as_slice(&self) -> &[T] {
        self.0
    }
}

impl<T> Index<usize> for Trusted<'_, T> {
    type Output = T;

    #[inline(always)]
    fn index(&self, index: usize) -> &T {
        debug_assert!(index < self.0.len());
        // SAFETY: the promise made to `new`.
        unsafe { self.0.get_unchecked(index) }
    }
}

impl<T> IndexMut<usize> for Trusted<'_, T> {
    #[inline(always)]
    fn index_mut(&mut self, index: usize) -> &mut T {
        debug_assert!(index < self.0.len());
        // SAFETY: the promise made to `new`.
        unsafe { self.0.get_unchecked_mut(index) }
    }
}
