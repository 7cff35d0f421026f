//! The words of tetrahedra, which the parts of a complex share.
//!
//! Parts read some of the same words, but no part writes a word that another one uses. A reference to the
//! whole array would claim more than that, so the words are behind a pointer. Indices come from the kernel's
//! own arrays, so only debug builds, which tests are, check them: checks of bounds took 8 % of all time.

use std::marker::PhantomData;
use std::ops::{Deref, DerefMut, Index, IndexMut};

use super::tetrahedralization::{Tetrahedron, WORDS};
use crate::prefetch::prefetch_at;

/// The words of an array of tetrahedra and of the room behind them.
#[derive(Debug)]
pub(super) struct Words<'s> {
    first: *mut u32,
    len: usize,
    room: PhantomData<&'s mut [u32]>,
}

// SAFETY: it is a reference to words, which may be used on any thread.
unsafe impl Send for Words<'_> {}

impl<'s> Words<'s> {
    /// The words of an array and of the room behind it.
    ///
    /// # Safety
    /// As long as this exists,
    /// * it is used at indices of words that are in the array or were written;
    /// * of all that is made of the same array, none reads or writes a word that another one writes;
    /// * the array is not used otherwise.
    pub(super) unsafe fn of(array: &'s mut Vec<Tetrahedron>) -> Words<'s> {
        let len = array.capacity() * WORDS;
        Words { first: array.as_mut_ptr().cast(), len, room: PhantomData }
    }

    /// The same words, for another part.
    ///
    /// # Safety
    /// The promise of [`Words::of`].
    pub(super) unsafe fn share(&self) -> Words<'s> {
        Words { ..*self }
    }

    #[inline(always)]
    pub(super) fn get(&self, index: usize) -> u32 {
        debug_assert!(index < self.len);
        // SAFETY: the promise made to `of`.
        unsafe { *self.first.add(index) }
    }

    /// Changes the word at this index.
    #[inline(always)]
    pub(super) fn set(&mut self, index: usize, word: u32) {
        debug_assert!(index < self.len);
        // SAFETY: the promise made to `of`.
        unsafe { *self.first.add(index) = word }
    }

    /// Four words from this index on.
    #[inline(always)]
    pub(super) fn four(&self, index: usize) -> [u32; 4] {
        [self.get(index), self.get(index + 1), self.get(index + 2), self.get(index + 3)]
    }

    /// Writes the words of the tetrahedron that begins at `t`.
    #[inline(always)]
    pub(super) fn write(&mut self, t: u32, vertices: [u32; 4], neighbours: [u32; 4]) {
        for i in 0..4 {
            self.set(t as usize + i, vertices[i]);
            self.set(t as usize + 4 + i, neighbours[i]);
        }
    }

    /// Prefetches the word at this index, which may be any.
    #[inline(always)]
    pub(super) fn prefetch(&self, index: usize) {
        prefetch_at(self.first.wrapping_add(index));
    }
}

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
