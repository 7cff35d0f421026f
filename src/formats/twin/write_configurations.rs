//! Lines of text twins of configurations (`formats/text.md`).

use std::io::Write;

use crate::sink::write_error;
use spmesh_base::error::Result;
use spmesh_stream::model::configurations::FARAWAY;
use spmesh_stream::{ConfigurationBlock, claim_name};

/// Degree and interior set of the lines written last.
#[derive(Debug, Default)]
pub(crate) struct OpenGroup {
    degree: Option<u32>,
    interior: Option<Vec<u32>>,
}

impl OpenGroup {
    /// Writes lines `degree` and `in` where degree or interior set change, and lines `on` and `line`.
    pub(crate) fn write(&mut self, output: &mut impl Write, block: &ConfigurationBlock) -> Result<()> {
        if self.degree != Some(block.degree) {
            let claim = claim_name(block.claim);
            writeln!(output, "degree {} {claim}", block.degree).map_err(write_error)?;
            *self = OpenGroup { degree: Some(block.degree), interior: None };
        }
        for (interior, boundaries) in block.groups() {
            if self.interior.as_deref() != Some(interior) {
                numbers(output, "in", interior)?;
                self.interior = Some(interior.to_vec());
            }
            for boundary in boundaries {
                match boundary {
                    [from, to, FARAWAY] => numbers(output, "line", &[*from, *to])?,
                    knots => numbers(output, "on", knots)?,
                }
            }
        }
        Ok(())
    }
}

/// A line of numbers counted from 1.
pub(crate) fn numbers(output: &mut impl Write, word: &str, numbers: &[u32]) -> Result<()> {
    output.write_all(word.as_bytes()).map_err(write_error)?;
    numbers
        .iter()
        .try_for_each(|&number| write!(output, " {}", u64::from(number) + 1))
        .map_err(write_error)?;
    output.write_all(b"\n").map_err(write_error)
}
