//! Arrays whose indices are not checked in release builds, like those of [`Words`](super::words::Words).

use std::ops::{Deref, DerefMut, Index, IndexMut};

/// A reference to an array that is used at indices in bounds only. Debug builds, as tests are, check that.
#[derive(Debug)]
pub(super) struct Trusted<A>(A);

impl<A> Trusted<A> {
    /// # Safety
    /// As long as this exists, it is used at indices in bounds only.
    #[inline(always)]
    pub(super) unsafe fn new(array: A) -> Trusted<A> {
        Trusted(array)
    }
}

impl<T, A: Deref<Target = [T]>> Index<usize> for Trusted<A> {
    type Output = T;

    #[inline(always)]
    fn index(&self, index: usize) -> &T {
        debug_assert!(index < self.0.len());
        // SAFETY: the promise made to `new`.
        unsafe { self.0.get_unchecked(index) }
    }
}

impl<T, A: DerefMut<Target = [T]>> IndexMut<usize> for Trusted<A> {
    #[inline(always)]
    fn index_mut(&mut self, index: usize) -> &mut T {
        debug_assert!(index < self.0.len());
        // SAFETY: the promise made to `new`.
        unsafe { self.0.get_unchecked_mut(index) }
    }
}
