//! Values of points: a line per point, with one number or the two numbers of a gradient.

use std::io::Read;

use crate::text::lines::{Lines, number, quote};
use crate::text::read::{delimiter_of, fields, without_comment};
use spmesh_base::error::{Error, Result};

/// A value per point, in the order of the points.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// One number per point.
    Numbers(Vec<f64>),
    /// Two numbers per point.
    Vectors(Vec<[f64; 2]>),
}

/// Reads lines of one or two numbers; the first line decides. Blank lines and comments are skipped.
///
/// # Errors
/// If reading fails, a line has another number of columns or a word that is not a number, or there is no
/// line.
pub fn read_values(input: impl Read) -> Result<Values> {
    let mut lines = Lines::new(input, "");
    let (mut columns, mut all) = (0, Vec::new());
    while let Some(line) = lines.next_trimmed()? {
        let line = without_comment(line);
        if line.is_empty() {
            continue;
        }
        let before = all.len();
        let parsed = push_numbers(line, &mut all);
        parsed.map_err(|e| e.at(lines.position()))?;
        let found = all.len() - before;
        columns = if columns == 0 { found } else { columns };
        if found != columns || found > 2 {
            let expected = if before == 0 { "one or two".to_string() } else { columns.to_string() };
            let message = format!("found {found} numbers, expected {expected}");
            return Err(Error::malformed(message).at(lines.position()));
        }
    }
    match columns {
        0 => Err(Error::malformed("found no value")),
        1 => Ok(Values::Numbers(all)),
        _ => Ok(Values::Vectors(all.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect())),
    }
}

fn push_numbers(line: &[u8], all: &mut Vec<f64>) -> Result<()> {
    for field in fields(line, delimiter_of(line)) {
        let found = || Error::malformed(format!("found {}, expected a number", quote(field)));
        all.push(number(field).ok_or_else(found)?);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_line_tells_numbers_from_vectors() {
        let read = |text: &str| read_values(text.as_bytes());
        assert_eq!(read("1\n\n# two\n-2.5\n").unwrap(), Values::Numbers(vec![1.0, -2.5]));
        assert_eq!(read("1,2\n3 ; 4\n").unwrap(), Values::Vectors(vec![[1.0, 2.0], [3.0, 4.0]]));
        for (text, part) in
            [("1\n2 3\n", "line 2"), ("1 2 3\n", "one or two"), ("1\nx\n", "line 2"), ("#\n", "no value")]
        {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(part), "{message}");
        }
    }
}
