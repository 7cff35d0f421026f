//! Prefetching memory into the cache.

/// Prefetches what a pointer points at into the cache. Any address will do.
#[inline(always)]
fn prefetch_at<T>(place: *const T) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: any address may be prefetched.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(place.cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = place;
}

/// Prefetches both ends of an element into the cache. `index` may be out of bounds.
#[inline(always)]
pub fn prefetch<T>(elements: &[T], index: usize) {
    let start = elements.as_ptr().wrapping_add(index).cast::<u8>();
    prefetch_at(start);
    if size_of::<T>() > 32 {
        prefetch_at(start.wrapping_add(size_of::<T>() - 1));
    }
}
