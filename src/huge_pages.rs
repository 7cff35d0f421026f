//! Large arrays in large pages.
//!
//! The first touch of a page of 4 KiB costs more than a microsecond; the arrays for ten million points at once are
//! half a million pages. The system gives pages of 2 MiB to those who ask.

use crate::system;

/// Arrays of fewer bytes stay in small pages, so that a process takes no more memory than it uses.
const LEAST_BYTES: usize = 4 << 20;

/// Empties `array`, makes room for `capacity` elements, and asks for large pages if they are many.
pub(crate) fn reserve<T>(array: &mut Vec<T>, capacity: usize) {
    array.clear();
    if array.capacity() < capacity {
        array.reserve_exact(capacity);
        ask(array.spare_capacity_mut());
    }
}

/// Asks for large pages for `memory`, which has not been touched, if it is large.
pub(crate) fn ask<T>(memory: &mut [T]) {
    if size_of_val(memory) >= LEAST_BYTES {
        system::ask_for_large_pages(memory);
    }
}
