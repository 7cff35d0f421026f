//! Configurations as held by blocks: a part of one degree.

use byteorder::{ByteOrder, LittleEndian as LE};

use crate::model::configurations::Claim;
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::CONFIGURATION_DEGREE_MAX;

/// Length of degree, claim and number of groups, in bytes.
const FIXED_LEN: usize = 12;

/// Claims, at their codes, with their names in text twins.
const CLAIMS: [(Claim, &str); 3] =
    [(Claim::Any, "any"), (Claim::Delaunay, "delaunay"), (Claim::Lifted, "lifted")];

/// The name of a claim in text twins.
pub fn claim_name(claim: Claim) -> &'static str {
    CLAIMS.iter().find(|(known, _)| *known == claim).expect("every claim has its name").1
}

/// The claim of this name, if there is one.
pub fn claim_from_name(name: &[u8]) -> Option<Claim> {
    CLAIMS.iter().find(|(_, known)| known.as_bytes() == name).map(|(claim, _)| *claim)
}

/// Consecutive configurations of one degree, in groups of one interior set each.
///
/// The first group may continue the last group of the previous block.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConfigurationBlock {
    /// The size of interior sets.
    pub degree: u32,
    /// The claim of the degree.
    pub claim: Claim,
    /// Interior sets, concatenated; each is sorted.
    pub interiors: Vec<u32>,
    /// Number of configurations of each group.
    pub counts: Vec<u32>,
    /// Boundaries, group by group; those of infinite configurations have
    /// [`crate::model::configurations::FARAWAY`] in the last place.
    pub boundaries: Vec<[u32; 3]>,
}

impl ConfigurationBlock {
    /// A block of this degree without configurations.
    pub fn new(degree: u32, claim: Claim) -> Self {
        ConfigurationBlock {
            degree,
            claim,
            interiors: Vec::new(),
            counts: Vec::new(),
            boundaries: Vec::new(),
        }
    }

    /// Appends configurations; they join the last group if it has the same interior set.
    ///
    /// Domain: `interior` has as many knots as the degree.
    pub fn push(&mut self, interior: &[u32], boundaries: &[[u32; 3]]) {
        debug_assert_eq!(interior.len(), self.degree as usize);
        if self.last_interior() != Some(interior) {
            self.interiors.extend_from_slice(interior);
            self.counts.push(0);
        }
        if let Some(count) = self.counts.last_mut() {
            *count += boundaries.len() as u32;
        }
        self.boundaries.extend_from_slice(boundaries);
    }

    /// The groups: interior sets with their boundaries.
    pub fn groups(&self) -> impl Iterator<Item = (&[u32], &[[u32; 3]])> {
        let (degree, mut start) = (self.degree as usize, 0);
        self.counts.iter().enumerate().map(move |(group, &count)| {
            let boundaries = &self.boundaries[start..start + count as usize];
            start += count as usize;
            (&self.interiors[group * degree..][..degree], boundaries)
        })
    }

    /// Interior set of the last group.
    pub fn last_interior(&self) -> Option<&[u32]> {
        let degree = self.degree as usize;
        (!self.counts.is_empty()).then(|| &self.interiors[(self.counts.len() - 1) * degree..])
    }

    /// Whether there is no group.
    pub fn is_empty(&self) -> bool {
        self.counts.is_empty()
    }

    /// Number of 32-bit words of the payload.
    pub fn words(&self) -> usize {
        3 + self.interiors.len() + self.counts.len() + 3 * self.boundaries.len()
    }

    /// Removes all groups.
    pub(super) fn clear(&mut self) {
        self.interiors.clear();
        self.counts.clear();
        self.boundaries.clear();
    }

    /// Appends the encoded block to a payload.
    pub(super) fn encode(&self, payload: &mut Vec<u8>) {
        let claim = CLAIMS.iter().position(|(claim, _)| *claim == self.claim);
        let head = [self.degree, claim.expect("every claim has its code") as u32, self.counts.len() as u32];
        let words =
            head.iter().chain(&self.interiors).chain(&self.counts).chain(self.boundaries.as_flattened());
        words.for_each(|word| payload.extend_from_slice(&word.to_le_bytes()));
    }

    /// Decodes a block, and checks that its counts match its length and each other.
    pub(super) fn decode(payload: &[u8]) -> Result<Self> {
        let Some((head, rest)) = payload.split_at_checked(FIXED_LEN) else {
            return Err(Error::malformed(format!(
                "configurations in {} bytes, expected at least {FIXED_LEN}",
                payload.len()
            )));
        };
        let [degree, claim, groups] = [0, 4, 8].map(|at| LE::read_u32(&head[at..]));
        check_degree(degree)?;
        let Some(&(claim, _)) = CLAIMS.get(claim as usize) else {
            return Err(Error::malformed(format!("configurations of standing {claim}, expected 0, 1 or 2")));
        };
        let unfit =
            || Error::malformed("the counts of the configurations do not add up to the block's length");
        let split = |bytes: &[u8], len: u64| {
            usize::try_from(len).ok().filter(|&len| len <= bytes.len()).ok_or_else(unfit)
        };
        let groups = u64::from(groups);
        let (interiors, rest) = rest.split_at(split(rest, groups * u64::from(degree) * 4)?);
        let (counts, boundaries) = rest.split_at(split(rest, groups * 4)?);
        let numbers = |bytes: &[u8]| -> Vec<u32> { bytes.chunks_exact(4).map(LE::read_u32).collect() };
        let counts = numbers(counts);
        if counts.iter().map(|&count| u64::from(count) * 12).sum::<u64>() != boundaries.len() as u64 {
            return Err(unfit());
        }
        let triple = |bytes: &[u8]| [0, 4, 8].map(|at| LE::read_u32(&bytes[at..]));
        let boundaries = boundaries.chunks_exact(12).map(triple).collect();
        Ok(ConfigurationBlock { degree, claim, interiors: numbers(interiors), counts, boundaries })
    }
}

/// Checks that the format allows a degree.
///
/// # Errors
/// Malformed, if the degree is above the maximum.
pub fn check_degree(degree: u32) -> Result<()> {
    if degree <= CONFIGURATION_DEGREE_MAX {
        return Ok(());
    }
    Err(Error::malformed(format!(
        "configurations of degree {degree}, the maximum is {CONFIGURATION_DEGREE_MAX}"
    )))
}
