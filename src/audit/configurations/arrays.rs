//! Configurations as the audit holds them: flat arrays, as they came.

use super::{Claim, FARAWAY};
use spmesh_base::error::{Error, ErrorKind, Result};

/// The configurations (B, I) of one degree, grouped by I. In infinite ones, the last knot of B is
/// [`FARAWAY`].
///
/// Shape: 12 bytes per configuration, 4 (k + 1) per group.
#[derive(Debug, Clone)]
pub struct Configurations {
    degree: usize,
    claim: Claim,
    /// Interior sets, one after the other.
    interiors: Vec<u32>,
    /// For each group, the number of boundaries up to and including its last.
    ends: Vec<u32>,
    boundaries: Vec<[u32; 3]>,
    infinite: usize,
}

/// Configurations with one interior set.
#[derive(Debug, Clone, Copy)]
pub(super) struct Group<'a> {
    pub(super) interior: &'a [u32],
    /// Boundaries of finite and of infinite configurations.
    pub(super) boundaries: &'a [[u32; 3]],
}

impl Configurations {
    /// No configurations, to be given with [`Configurations::extend`].
    pub fn new(degree: usize, claim: Claim) -> Configurations {
        let (interiors, ends, boundaries) = (Vec::new(), Vec::new(), Vec::new());
        Configurations { degree, claim, interiors, ends, boundaries, infinite: 0 }
    }

    /// Appends configurations with one interior set, to the last group if that has the same set.
    ///
    /// Domain: interior sets are sorted and have as many knots as the degree says.
    ///
    /// # Errors
    /// If there are too many configurations to hold (kind [`ErrorKind::Memory`]).
    pub fn extend(&mut self, interior: &[u32], boundaries: &[[u32; 3]]) -> Result<()> {
        debug_assert_eq!(interior.len(), self.degree);
        let Ok(end) = u32::try_from(self.boundaries.len() + boundaries.len()) else {
            let message = "2^32 configurations of one degree or more cannot be held: use fewer knots";
            return Err(Error::new(ErrorKind::Memory, message));
        };
        if !self.ends.is_empty() && self.interiors.ends_with(interior) {
            self.ends.pop();
        } else {
            self.interiors.extend_from_slice(interior);
        }
        self.ends.push(end);
        self.infinite += boundaries.iter().filter(|boundary| boundary[2] == FARAWAY).count();
        self.boundaries.extend_from_slice(boundaries);
        Ok(())
    }

    /// The degree k: the size of interior sets.
    pub fn degree(&self) -> usize {
        self.degree
    }

    pub(super) fn claim(&self) -> Claim {
        self.claim
    }

    /// Number of configurations of three knots.
    pub(super) fn finite_len(&self) -> usize {
        self.boundaries.len() - self.infinite
    }

    /// Number of configurations of two knots and the faraway point.
    pub(super) fn infinite_len(&self) -> usize {
        self.infinite
    }

    /// All groups, as they came.
    pub(super) fn groups(&self) -> impl Iterator<Item = Group<'_>> {
        let mut start = 0;
        self.ends.iter().enumerate().map(move |(number, &end)| {
            let boundaries = &self.boundaries[start..end as usize];
            start = end as usize;
            Group { interior: &self.interiors[number * self.degree..][..self.degree], boundaries }
        })
    }

    /// All configurations of three knots: boundary and interior set.
    pub(super) fn finite(&self) -> impl Iterator<Item = ([u32; 3], &[u32])> {
        self.groups().flat_map(|Group { interior, boundaries }| {
            let finite = boundaries.iter().filter(|boundary| boundary[2] != FARAWAY);
            finite.map(move |&boundary| (boundary, interior))
        })
    }

    /// All configurations of two knots and the faraway point: the knots and the interior set.
    pub(super) fn infinite(&self) -> impl Iterator<Item = ([u32; 2], &[u32])> {
        self.groups().flat_map(|Group { interior, boundaries }| {
            let infinite = boundaries.iter().filter(|boundary| boundary[2] == FARAWAY);
            infinite.map(move |&[from, to, _]| ([from, to], interior))
        })
    }
}
