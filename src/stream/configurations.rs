//! Configurations as blocks hold them: a piece of one degree.

use byteorder::{ByteOrder, LittleEndian as LE};

use spmesh_core::error::{Error, Result};
use spmesh_core::limits::CONFIGURATION_DEGREE_MAX;
use spmesh_model::configurations::Standing;

/// Length of degree, standing and number of groups, in bytes.
const FIXED_LEN: usize = 12;

/// Standings by their codes, with their names in text twins.
const STANDINGS: [(Standing, &str); 3] =
    [(Standing::Any, "any"), (Standing::Delaunay, "delaunay"), (Standing::Lifted, "lifted")];

/// The name of a standing in text twins.
pub fn standing_name(standing: Standing) -> &'static str {
    STANDINGS.iter().find(|(known, _)| *known == standing).expect("every standing has its name").1
}

/// The standing of this name, if there is one.
pub fn standing_from_name(name: &[u8]) -> Option<Standing> {
    STANDINGS.iter().find(|(_, known)| known.as_bytes() == name).map(|(standing, _)| *standing)
}

/// Configurations of one degree that follow each other, in groups of one interior set each.
///
/// The first group may go on with the last one of the block before.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConfigurationBlock {
    /// The size of interior sets.
    pub degree: u32,
    /// What the degree claims to be.
    pub standing: Standing,
    /// Interior sets, one after the other, each sorted.
    pub interiors: Vec<u32>,
    /// Number of configurations of each group.
    pub counts: Vec<u32>,
    /// Boundaries, group by group; [`spmesh_model::configurations::FARAWAY`] is in the last place of infinite ones.
    pub boundaries: Vec<[u32; 3]>,
}

impl ConfigurationBlock {
    /// No configurations of this degree.
    #[must_use]
    pub fn new(degree: u32, standing: Standing) -> Self {
        ConfigurationBlock {
            degree,
            standing,
            interiors: Vec::new(),
            counts: Vec::new(),
            boundaries: Vec::new(),
        }
    }

    /// Appends configurations, to the last group if that has the same interior set.
    ///
    /// Domain: `interior` has as many knots as the degree says.
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

    /// The groups: interior set, boundaries.
    pub fn groups(&self) -> impl Iterator<Item = (&[u32], &[[u32; 3]])> {
        let (degree, mut start) = (self.degree as usize, 0);
        self.counts.iter().enumerate().map(move |(group, &count)| {
            let boundaries = &self.boundaries[start..start + count as usize];
            start += count as usize;
            (&self.interiors[group * degree..][..degree], boundaries)
        })
    }

    /// Interior set of the last group.
    #[must_use]
    pub fn last_interior(&self) -> Option<&[u32]> {
        let degree = self.degree as usize;
        (!self.counts.is_empty()).then(|| &self.interiors[(self.counts.len() - 1) * degree..])
    }

    /// Whether there is no group.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.counts.is_empty()
    }

    /// Words of the payload.
    pub fn words(&self) -> usize {
        3 + self.interiors.len() + self.counts.len() + 3 * self.boundaries.len()
    }

    /// Takes all groups away.
    pub(super) fn clear(&mut self) {
        self.interiors.clear();
        self.counts.clear();
        self.boundaries.clear();
    }

    /// Appends the payload.
    pub(super) fn encode(&self, payload: &mut Vec<u8>) {
        let standing = STANDINGS.iter().position(|(standing, _)| *standing == self.standing);
        let head =
            [self.degree, standing.expect("every standing has its code") as u32, self.counts.len() as u32];
        let words =
            head.iter().chain(&self.interiors).chain(&self.counts).chain(self.boundaries.as_flattened());
        words.for_each(|word| payload.extend_from_slice(&word.to_le_bytes()));
    }

    /// A block whose counts fit its length and each other.
    pub(super) fn decode(payload: &[u8]) -> Result<Self> {
        let Some((head, rest)) = payload.split_at_checked(FIXED_LEN) else {
            return Err(Error::malformed(format!(
                "configurations in {} bytes, expected at least {FIXED_LEN}",
                payload.len()
            )));
        };
        let [degree, standing, groups] = [0, 4, 8].map(|at| LE::read_u32(&head[at..]));
        check_degree(degree)?;
        let Some(&(standing, _)) = STANDINGS.get(standing as usize) else {
            return Err(Error::malformed(format!(
                "configurations of standing {standing}, expected 0, 1 or 2"
            )));
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
        Ok(ConfigurationBlock { degree, standing, interiors: numbers(interiors), counts, boundaries })
    }
}

/// That a degree is one that streams may have.
pub fn check_degree(degree: u32) -> Result<()> {
    if degree <= CONFIGURATION_DEGREE_MAX {
        return Ok(());
    }
    Err(Error::malformed(format!(
        "configurations of degree {degree}, the maximum is {CONFIGURATION_DEGREE_MAX}"
    )))
}
