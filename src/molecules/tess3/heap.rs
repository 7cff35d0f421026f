//! Counts the heap memory of each thread. `--stats` and the column `peak_memory_bytes` of a sweep's summary
//! report it.

use std::alloc::{GlobalAlloc, Layout};
use std::cell::Cell;

use spmesh_base::allocator::Allocator;

thread_local! {
    /// Bytes that this thread has allocated, less those it has freed.
    static LIVE: Cell<isize> = const { Cell::new(0) };
    /// Maximum of `LIVE`.
    static PEAK: Cell<isize> = const { Cell::new(0) };
}

/// The allocator of all programs, with counts per thread. A program that reports these counts installs it as
/// its global allocator.
///
/// A sweep works on several files at a time. The system reports the memory of the whole process only; the
/// heap of each thread is the memory that each file took.
#[derive(Debug)]
pub struct CountingHeap;

fn count(bytes: isize) {
    // Fails in a thread that is being torn down; its counts no longer matter.
    let _ = LIVE.try_with(|live| {
        live.set(live.get() + bytes);
        PEAK.try_with(|peak| peak.set(peak.get().max(live.get())))
    });
}

// SAFETY: every call is forwarded unchanged to the other allocator; counting does not allocate.
unsafe impl GlobalAlloc for CountingHeap {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { Allocator.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        // SAFETY: the caller keeps the contract of `alloc_zeroed`.
        unsafe { Allocator.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, bytes: usize) -> *mut u8 {
        count(bytes as isize - layout.size() as isize);
        // SAFETY: the caller keeps the contract of `realloc`, and `pointer` came from that allocator.
        unsafe { Allocator.realloc(pointer, layout, bytes) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count(-(layout.size() as isize));
        // SAFETY: the caller keeps the contract of `dealloc`, and `pointer` came from that allocator.
        unsafe { Allocator.dealloc(pointer, layout) }
    }
}

/// Runs `work`. Also returns the peak of this thread's heap memory in bytes above the level before; `None`
/// without [`CountingHeap`].
pub fn peak_during<T>(work: impl FnOnce() -> T) -> (T, Option<u64>) {
    let (before, outer) = (LIVE.get(), PEAK.get());
    PEAK.set(before);
    let result = work();
    let peak = PEAK.get();
    PEAK.set(outer.max(peak));
    (result, u64::try_from(peak - before).ok().filter(|&peak| peak > 0))
}
