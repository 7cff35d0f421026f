//! Prefetching memory into the cache.

/// Prefetches both ends of an element into the cache. `index` may be out of bounds.
#[inline(always)]
pub fn prefetch<T>(elements: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let start = elements.as_ptr().wrapping_add(index).cast::<i8>();
        let last = start.wrapping_add(size_of::<T>() - 1);
        // SAFETY: any address may be prefetched.
        unsafe {
            _mm_prefetch::<_MM_HINT_T0>(start);
            if size_of::<T>() > 32 {
                _mm_prefetch::<_MM_HINT_T0>(last);
            }
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (elements, index);
}
