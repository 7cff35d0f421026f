//! Large arrays in large pages.
//!
//! The first touch of a page of 4 KiB costs more than a microsecond; the arrays for ten million points at once are
//! half a million pages. The system gives pages of 2 MiB to those who ask.

/// Arrays of fewer bytes stay in small pages, so that a process takes no more memory than it uses.
const LEAST_BYTES: usize = 4 << 20;

/// Empties `array`, makes room for `capacity` elements, and asks for large pages if they are many.
pub(crate) fn reserve<T>(array: &mut Vec<T>, capacity: usize) {
    array.clear();
    if array.capacity() < capacity {
        array.reserve_exact(capacity);
        ask(array);
    }
}

/// Asks for large pages for the whole capacity of `array`.
#[cfg(target_os = "linux")]
pub(crate) fn ask<T>(array: &mut Vec<T>) {
    const PAGE: usize = 4096;
    let bytes = array.capacity() * size_of::<T>();
    if bytes >= LEAST_BYTES {
        let start = array.as_mut_ptr().cast::<libc::c_void>();
        let skipped = start.align_offset(PAGE);
        // SAFETY: the range lies in one allocation that is mutably borrowed, and starts at a page. The advice changes
        // neither its content nor its validity; where it is not taken nothing is lost, so that the result is ignored.
        unsafe { libc::madvise(start.wrapping_byte_add(skipped), bytes - skipped, libc::MADV_HUGEPAGE) };
    }
}

/// Other systems decide for themselves.
#[cfg(not(target_os = "linux"))]
pub(crate) fn ask<T>(_array: &mut Vec<T>) {}
