//! Counts the content of a stream of configurations.

use super::configurations::{Claim, FARAWAY};
use spmesh_stream::ConfigurationBlock;

/// Counts of the configurations of one degree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DegreeInventory {
    /// The degree.
    pub degree: u32,
    /// What they claim to be.
    pub claim: Claim,
    /// Interior sets.
    pub groups: u64,
    /// Configurations of three knots.
    pub finite: u64,
    /// Configurations of two knots and the faraway point.
    pub infinite: u64,
}

/// Counts of all degrees, gathered block by block.
#[derive(Debug, Default)]
pub struct ConfigurationInventory {
    degrees: Vec<DegreeInventory>,
    last: Option<Vec<u32>>,
}

impl ConfigurationInventory {
    /// Counts by increasing degree.
    pub fn degrees(&self) -> &[DegreeInventory] {
        &self.degrees
    }

    /// Adds a block.
    pub(super) fn block(&mut self, block: &ConfigurationBlock) {
        if self.degrees.last().is_none_or(|last| last.degree != block.degree) {
            let (degree, claim) = (block.degree, block.claim);
            self.degrees.push(DegreeInventory { degree, claim, groups: 0, finite: 0, infinite: 0 });
            self.last = None;
        }
        let Some(inventory) = self.degrees.last_mut() else { return };
        let goes_on = block.groups().next().is_some_and(|(first, _)| self.last.as_deref() == Some(first));
        let infinite = block.boundaries.iter().filter(|boundary| boundary[2] == FARAWAY).count() as u64;
        inventory.groups += block.counts.len() as u64 - u64::from(goes_on);
        inventory.finite += block.boundaries.len() as u64 - infinite;
        inventory.infinite += infinite;
        self.last = block.last_interior().map(<[u32]>::to_vec).or(self.last.take());
    }
}
