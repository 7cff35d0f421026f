//! Lists of numbers, one after the other.

use spmesh_core::prefetch::prefetch;

/// A list for each class.
pub(super) struct Lists {
    numbers: Vec<u32>,
    /// Where each list begins, and where the last ends.
    starts: Vec<u32>,
}

impl Lists {
    pub(super) fn with_capacity(lists: usize, numbers: usize) -> Lists {
        let mut starts = Vec::with_capacity(lists + 1);
        starts.push(0);
        Lists { numbers: Vec::with_capacity(numbers), starts }
    }

    /// Number of lists.
    pub(super) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Number of numbers.
    pub(super) fn numbers(&self) -> usize {
        self.numbers.len()
    }

    /// A list.
    #[inline(always)]
    pub(super) fn get(&self, list: usize) -> &[u32] {
        &self.numbers[self.starts[list] as usize..self.starts[list + 1] as usize]
    }

    /// Prefetches a list.
    #[inline(always)]
    pub(super) fn fetch(&self, list: usize) {
        prefetch(&self.numbers, self.starts[list] as usize);
    }

    /// Ends a list of the numbers that were added since the last one ended; returns it.
    ///
    /// # Panics
    /// If there are 2^32 numbers or more.
    #[inline(always)]
    pub(super) fn end(&mut self) -> &mut [u32] {
        let start = self.starts[self.starts.len() - 1] as usize;
        self.starts.push(u32::try_from(self.numbers.len()).expect("at most 2^32 numbers of cells"));
        &mut self.numbers[start..]
    }

    #[inline(always)]
    pub(super) fn extend<const N: usize>(&mut self, numbers: [u32; N]) {
        self.numbers.extend(numbers);
    }

    /// Adds those numbers for which `wanted`. Both outcomes are written: they are unpredictable.
    #[inline(always)]
    pub(super) fn extend_if<const N: usize>(&mut self, numbers: [u32; N], mut wanted: impl FnMut(u32) -> bool) {
        let mut count = self.numbers.len();
        self.numbers.resize(count + N, 0);
        for number in numbers {
            self.numbers[count] = number;
            count += usize::from(wanted(number));
        }
        self.numbers.truncate(count);
    }
}
