//! Reads the lines of text twins of configurations (`formats/text.md`).

use crate::twin::tokens::{expect_no_field, next_field, parse_integer, unexpected};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::configurations::{Claim, FARAWAY};
use spmesh_stream::{ConfigurationBlock, check_degree, claim_from_name};

/// Number of words from which an event takes no further line.
const BATCH_WORDS: usize = 1 << 14;

/// One line, parsed. Knots are counted from 0 here.
pub(crate) enum ConfigurationLine {
    Degree(u32, Claim),
    Interior(Vec<u32>),
    /// The last entry is [`FARAWAY`] for a line `line`.
    Boundary([u32; 3]),
}

/// Parses the line of `word` and the `fields` after it; `None` if it is not a line of configurations.
pub(crate) fn parse<'a>(
    word: &[u8],
    fields: &mut impl Iterator<Item = &'a [u8]>,
) -> Result<Option<ConfigurationLine>> {
    let line = match word {
        b"degree" => {
            let field = next_field(fields)?;
            let degree = u32::try_from(parse_integer(field)?).map_err(|_| unexpected(field, "a degree"))?;
            check_degree(degree)?;
            let name = next_field(fields)?;
            let claim = claim_from_name(name);
            ConfigurationLine::Degree(
                degree,
                claim.ok_or_else(|| unexpected(name, "any, delaunay or lifted"))?,
            )
        }
        b"in" => ConfigurationLine::Interior(fields.map(parse_knot).collect::<Result<_>>()?),
        b"on" => {
            let mut knot = || parse_knot(next_field(fields)?);
            ConfigurationLine::Boundary([knot()?, knot()?, knot()?])
        }
        b"line" => {
            let mut knot = || parse_knot(next_field(fields)?);
            ConfigurationLine::Boundary([knot()?, knot()?, FARAWAY])
        }
        _ => return Ok(None),
    };
    expect_no_field(fields)?;
    Ok(Some(line))
}

pub(crate) fn parse_knot(field: &[u8]) -> Result<u32> {
    let number = parse_integer(field)?.checked_sub(1).and_then(|number| u32::try_from(number).ok());
    let knot = number.filter(|&number| number != FARAWAY);
    knot.ok_or_else(|| unexpected(field, "a number from 1 to 2^32 - 1"))
}

/// The state that lines carry from one to the next, across events.
#[derive(Default)]
pub(crate) struct OpenLines {
    degree: Option<(u32, Claim)>,
    interior: Option<Vec<u32>>,
    /// Whether the interior set has no configuration yet.
    is_bare: bool,
}

impl OpenLines {
    /// Whether a degree has begun. Knots precede all degrees.
    pub(crate) fn is_begun(&self) -> bool {
        self.degree.is_some()
    }

    /// The empty event that `line` starts; `None` before the first degree.
    pub(crate) fn start(&mut self, line: &ConfigurationLine) -> Result<Option<ConfigurationBlock>> {
        if let &ConfigurationLine::Degree(degree, claim) = line {
            self.check_closed()?;
            if let Some((last, _)) = self.degree
                && degree <= last
            {
                return Err(Error::malformed(format!(
                    "configurations of degree {degree} after those of {last}"
                )));
            }
            *self = OpenLines { degree: Some((degree, claim)), ..OpenLines::default() };
        }
        Ok(self.degree.map(|(degree, claim)| ConfigurationBlock::new(degree, claim)))
    }

    /// Adds a line to an event; `degree` lines are ignored.
    pub(crate) fn push(&mut self, block: &mut ConfigurationBlock, line: ConfigurationLine) -> Result<()> {
        match (line, &self.interior) {
            (ConfigurationLine::Degree(..), _) => {}
            (ConfigurationLine::Interior(set), last) => {
                self.check_closed()?;
                if set.len() != block.degree as usize {
                    let (found, expected) = (set.len(), block.degree);
                    return Err(Error::malformed(format!(
                        "interior set of {found} knots, expected {expected}"
                    )));
                }
                if last.as_ref().is_some_and(|last| *last >= set) {
                    return Err(Error::malformed("the interior set does not follow the one before it"));
                }
                self.interior = Some(set);
                self.is_bare = true;
            }
            (ConfigurationLine::Boundary(boundary), Some(interior)) => {
                block.push(interior, &[boundary]);
                self.is_bare = false;
            }
            (ConfigurationLine::Boundary(_), None) => {
                return Err(Error::malformed(
                    "a configuration comes after the line \"in\" of its interior set",
                ));
            }
        }
        Ok(())
    }

    /// Checks that the last interior set has a configuration.
    pub(crate) fn check_closed(&self) -> Result<()> {
        if self.is_bare { Err(Error::malformed("an interior set has no configuration")) } else { Ok(()) }
    }
}

/// Whether `line` belongs to the event that holds `block`.
pub(crate) fn takes(block: &ConfigurationBlock, line: &ConfigurationLine) -> bool {
    !matches!(line, ConfigurationLine::Degree(..)) && block.words() < BATCH_WORDS
}
