//! Room for tetrahedra in an array whose length grows only when all is done: it can be divided among threads,
//! and pages are touched when they are used.

use super::tetrahedralization::Tetrahedron;
use std::mem::MaybeUninit;
use std::ops::{Deref, DerefMut};

/// The room of an array, used from the front.
#[derive(Debug)]
pub(super) struct Slots<'s> {
    room: &'s mut [MaybeUninit<Tetrahedron>],
    /// The first so many are initialized.
    len: usize,
}

impl<'s> Slots<'s> {
    /// Room for `count` tetrahedra in an array, those in it included. They stay where they are;
    /// [`Slots::give_back`] restores its length.
    ///
    /// # Panics
    /// If the array has less room.
    pub(super) fn of(array: &'s mut Vec<Tetrahedron>, count: usize) -> Slots<'s> {
        let len = array.len();
        array.clear();
        let (room, _) = array.spare_capacity_mut().split_at_mut(count);
        Slots { room, len }
    }

    /// Restores the length of the array that [`Slots::of`] took, of which `len` tetrahedra are in use.
    ///
    /// # Safety
    /// The first `len` tetrahedra of the array have been pushed.
    pub(super) unsafe fn give_back(array: &mut Vec<Tetrahedron>, len: usize) {
        assert!(len <= array.capacity());
        // SAFETY: the caller's promise.
        unsafe { array.set_len(len) }
    }

    /// Cuts empty room for `count` tetrahedra off the front of empty room.
    ///
    /// # Panics
    /// If there is less.
    pub(super) fn split_off_front(&mut self, count: usize) -> Slots<'s> {
        let (front, rest) = std::mem::take(&mut self.room).split_at_mut(count);
        (self.room, self.len) = (rest, 0);
        Slots { room: front, len: 0 }
    }

    /// How many more tetrahedra there is room for.
    #[inline(always)]
    pub(super) fn left(&self) -> usize {
        self.room.len() - self.len
    }

    /// Adds a tetrahedron.
    ///
    /// # Panics
    /// If there is no room left.
    #[inline(always)]
    pub(super) fn push(&mut self, tetrahedron: Tetrahedron) {
        self.room[self.len].write(tetrahedron);
        self.len += 1;
    }

    /// Forgets all but the first `len` tetrahedra.
    pub(super) fn truncate(&mut self, len: usize) {
        self.len = len.min(self.len);
    }
}

impl Deref for Slots<'_> {
    type Target = [Tetrahedron];

    #[inline(always)]
    fn deref(&self) -> &[Tetrahedron] {
        // SAFETY: only `push` raises the length, by what it has written.
        unsafe { std::slice::from_raw_parts(self.room.as_ptr().cast(), self.len) }
    }
}

impl DerefMut for Slots<'_> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [Tetrahedron] {
        // SAFETY: as above.
        unsafe { std::slice::from_raw_parts_mut(self.room.as_mut_ptr().cast(), self.len) }
    }
}
