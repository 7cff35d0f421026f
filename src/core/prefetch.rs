//! Memory that will be wanted soon.

/// Has an element brought into the cache, both ends of it. Any index will do.
#[inline(always)]
pub fn prefetch<T>(elements: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let start = elements.as_ptr().wrapping_add(index).cast::<i8>();
        let last = start.wrapping_add(size_of::<T>() - 1);
        // Safety: any address may be prefetched.
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
