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

/// The classes of one part among those of all parts, one part after the other.
pub(super) struct Section {
    pub(super) start: usize,
    /// Number of classes, and of the finite ones, which come first.
    pub(super) count: usize,
    pub(super) finite: usize,
    pub(super) numbers: Numbers,
}

/// The classes of all parts.
pub(in crate::diagram4) struct Joined(pub(super) Vec<Section>);

impl Joined {
    /// The places of the finite classes of each part.
    pub(in crate::diagram4) fn finite(&self) -> Vec<Range<usize>> {
        self.0.iter().map(|part| part.start..part.start + part.finite).collect()
    }

    /// The places of the infinite classes of each part.
    pub(super) fn infinite(&self) -> Vec<Range<usize>> {
        self.0.iter().map(|part| part.start + part.finite..part.start + part.count).collect()
    }

    /// The number of the class at a place.
    #[inline(always)]
    pub(super) fn number(&self, place: usize) -> u32 {
        let mut parts = self.0.iter().rev();
        parts.find(|part| part.start <= place).map_or(0, |part| part.numbers.of(place - part.start))
    }

    /// The place of the class of a number.
    #[inline(always)]
    pub(in crate::diagram4) fn place(&self, number: u32) -> u32 {
        let parts = self.0.len();
        (self.0[number as usize % parts].start + number as usize / parts) as u32
    }

    /// A number above those of all classes.
    pub(super) fn numbers_end(&self) -> usize {
        self.0.iter().map(|part| part.numbers.of(part.count) as usize).max().unwrap_or(0)
    }
}
