//! Memory that each thread holds on the heap, counted.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

thread_local! {
    /// Bytes that this thread has allocated more than it has freed.
    static LIVE: Cell<isize> = const { Cell::new(0) };
    /// Most that were live at a time.
    static PEAK: Cell<isize> = const { Cell::new(0) };
}

/// The system's allocator, with counts per thread. A program that wants them has it as its global allocator.
///
/// Among files that are worked on at the same time only the heap of each thread tells which one took how
/// much: the system knows of the whole process.
#[derive(Debug)]
pub struct CountingHeap;

fn count(bytes: isize) {
    // A thread that is being torn down has no cells any more, and nothing to tell.
    let _ = LIVE.try_with(|live| {
        live.set(live.get() + bytes);
        PEAK.try_with(|peak| peak.set(peak.get().max(live.get())))
    });
}

// SAFETY: every call goes to the system's allocator as it came; counting does not allocate.
unsafe impl GlobalAlloc for CountingHeap {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        // SAFETY: the caller keeps the contract of `alloc_zeroed`.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, bytes: usize) -> *mut u8 {
        count(bytes as isize - layout.size() as isize);
        // SAFETY: the caller keeps the contract of `realloc`, and `pointer` came from the system's allocator.
        unsafe { System.realloc(pointer, layout, bytes) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count(-(layout.size() as isize));
        // SAFETY: the caller keeps the contract of `dealloc`, and `pointer` came from the system's allocator.
        unsafe { System.dealloc(pointer, layout) }
    }
}

/// Does `work`, and says how many bytes more this thread held at a time than before; `None` without
/// [`CountingHeap`].
pub fn peak_during<T>(work: impl FnOnce() -> T) -> (T, Option<u64>) {
    let (before, outer) = (LIVE.get(), PEAK.get());
    PEAK.set(before);
    let result = work();
    let peak = PEAK.get();
    PEAK.set(outer.max(peak));
    (result, u64::try_from(peak - before).ok().filter(|&peak| peak > 0))
}
