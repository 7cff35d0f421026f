//! Memory for waiting points: pages of one size, chained per cell and recycled through a free list.

use spmesh_base::allocator::may_fail;
use spmesh_base::error::{Error, ErrorKind, Result};

/// End of a chain.
pub(super) const NO_PAGE: u32 = u32::MAX;

#[cold]
fn too_much(bytes: usize) -> Error {
    let message = format!("the system refuses {bytes} bytes for waiting points: give less --memory");
    Error::new(ErrorKind::Memory, message)
}

/// A fixed number of pages.
///
/// Memory: address space for all pages is reserved at once; a page takes memory from its first use.
pub(super) struct Pages {
    page_len: usize,
    pages_max: usize,
    bytes: Vec<u8>,
    /// Page after each page, in the chain of its cell or in the free list.
    next: Vec<u32>,
    free: u32,
    in_use: usize,
}

impl Pages {
    /// Pages of `page_len` bytes that take up at most `bytes`, including their links; no more than `needed`.
    ///
    /// # Panics
    /// If not even one page fits.
    pub(super) fn new(page_len: usize, bytes: u64, needed: u64) -> Result<Pages> {
        let fitting = bytes / (page_len as u64 + 4);
        assert!(fitting > 0, "a page fits");
        let pages_max = fitting.min(needed.max(1)).min(u64::from(NO_PAGE)) as usize;
        let (mut content, mut next) = (Vec::new(), Vec::new());
        let mut reserve = || {
            content.try_reserve_exact(pages_max * page_len).and_then(|()| next.try_reserve_exact(pages_max))
        };
        may_fail(&mut reserve).map_err(|_| too_much(pages_max * page_len))?;
        Ok(Pages { page_len, pages_max, bytes: content, next, free: NO_PAGE, in_use: 0 })
    }

    /// Bytes in a page.
    pub(super) fn page_len(&self) -> usize {
        self.page_len
    }

    /// Number of pages in chains.
    pub(super) fn in_use(&self) -> usize {
        self.in_use
    }

    /// High-water mark of the memory of pages, in bytes.
    pub(super) fn bytes_max(&self) -> u64 {
        self.bytes.len() as u64
    }

    /// A free page, not linked yet; `None` if all are in use.
    pub(super) fn take(&mut self) -> Option<u32> {
        let page = if self.free != NO_PAGE {
            let page = self.free;
            self.free = self.next[page as usize];
            page
        } else if self.next.len() < self.pages_max {
            self.bytes.resize(self.bytes.len() + self.page_len, 0);
            self.next.push(NO_PAGE);
            (self.next.len() - 1) as u32
        } else {
            return None;
        };
        self.next[page as usize] = NO_PAGE;
        self.in_use += 1;
        Some(page)
    }

    /// Puts `page` after `last` in its chain.
    pub(super) fn link(&mut self, last: u32, page: u32) {
        self.next[last as usize] = page;
    }

    /// Page after `page`, or [`NO_PAGE`].
    pub(super) fn after(&self, page: u32) -> u32 {
        self.next[page as usize]
    }

    /// Recycles the chain of `count` pages from `first` to `last`.
    pub(super) fn give_back(&mut self, first: u32, last: u32, count: usize) {
        debug_assert!(count <= self.in_use);
        self.next[last as usize] = self.free;
        self.free = first;
        self.in_use -= count;
    }

    /// Content of `page`.
    pub(super) fn content(&self, page: u32) -> &[u8] {
        &self.bytes[page as usize * self.page_len..][..self.page_len]
    }

    /// Content of `page`, to be written.
    pub(super) fn content_mut(&mut self, page: u32) -> &mut [u8] {
        &mut self.bytes[page as usize * self.page_len..][..self.page_len]
    }
}
