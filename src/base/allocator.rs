//! The allocator of the programs: that of the system, but if there is no memory, the program ends with its
//! message.
//!
//! Without it, Rust would print a message of its own before that, which speaks of backtraces.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use crate::system;

thread_local! {
    static MAY_FAIL: Cell<bool> = const { Cell::new(false) };
}

/// For `#[global_allocator]` of a program, which must call [`system::exit_at_abort`] before it has any
/// effect.
#[derive(Debug)]
pub struct Allocator;

/// Does work whose requests for memory may fail, such as `try_reserve`, without ending the program.
pub fn may_fail<T>(work: impl FnOnce() -> T) -> T {
    let before = MAY_FAIL.replace(true);
    let done = work();
    MAY_FAIL.set(before);
    done
}

/// The answer of the system, unless it has no memory and the caller does not expect that.
fn expected(pointer: *mut u8) -> *mut u8 {
    // A thread that is being torn down has no thread-local any more.
    if pointer.is_null() && !MAY_FAIL.try_with(Cell::get).unwrap_or(false) {
        system::exit_without_memory();
    }
    pointer
}

// SAFETY: every call is passed unchanged to the system's allocator, and so is its answer.
unsafe impl GlobalAlloc for Allocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller keeps the contract of `alloc`.
        expected(unsafe { System.alloc(layout) })
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller keeps the contract of `alloc_zeroed`.
        expected(unsafe { System.alloc_zeroed(layout) })
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, bytes: usize) -> *mut u8 {
        // SAFETY: the caller keeps the contract of `realloc`, and `pointer` came from the system's allocator.
        expected(unsafe { System.realloc(pointer, layout, bytes) })
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the contract of `dealloc`, and `pointer` came from the system's allocator.
        unsafe { System.dealloc(pointer, layout) }
    }
}
