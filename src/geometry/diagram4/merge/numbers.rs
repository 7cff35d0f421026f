//! Numbers of classes that several parts of a search give out at once.

use std::ops::Range;

/// The numbers that one part gives out: every `parts`-th.
#[derive(Debug, Clone, Copy)]
pub(super) struct Numbers {
    pub(super) part: usize,
    pub(super) parts: usize,
}

impl Numbers {
    /// The number of a class of the part.
    #[inline(always)]
    pub(super) fn of(self, class: usize) -> u32 {
        (self.part + self.parts * class) as u32
    }
}

/// The classes of all parts, one part after the other.
pub(super) struct Joined {
    /// Start, count of finite classes, which come first, and numbers of each part.
    pub(super) parts: Vec<(usize, usize, Numbers)>,
    /// Number of all classes.
    pub(super) end: usize,
}

impl Joined {
    /// The places of the finite classes of each part.
    pub(super) fn finite(&self) -> Vec<Range<usize>> {
        self.parts.iter().map(|&(start, finite, _)| start..start + finite).collect()
    }

    /// The places of the infinite classes of each part.
    pub(super) fn infinite(&self) -> Vec<Range<usize>> {
        let ends = self.parts.iter().skip(1).map(|part| part.0).chain([self.end]);
        self.parts.iter().zip(ends).map(|(&(start, finite, _), end)| start + finite..end).collect()
    }

    /// The number of the class at a place.
    #[inline(always)]
    pub(super) fn number(&self, place: usize) -> u32 {
        let mut parts = self.parts.iter().rev();
        parts.find(|part| part.0 <= place).map_or(0, |&(start, _, numbers)| numbers.of(place - start))
    }

    /// A number above those of all classes.
    pub(super) fn numbers_end(&self) -> usize {
        let parts = self.parts.len();
        self.finite().into_iter().zip(self.infinite()).map(|(a, b)| b.end - a.start).max().unwrap_or(0)
            * parts
    }
}
