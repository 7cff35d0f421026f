//! Words of lines in small text files.

use std::io::Read;

use crate::text::lines::{Lines, number, quote};
use crate::text::read::without_comment;
use spmesh_base::error::{Error, Result};

/// Passes the words of each line that has any to `found`, and returns the number of these lines. Blank lines
/// and comments are skipped.
///
/// # Errors
/// If reading fails; or any error of `found`, with the position.
pub fn for_each_line(input: impl Read, mut found: impl FnMut(&[&[u8]]) -> Result<()>) -> Result<u64> {
    for_each_line_at(input, |_, words| found(words))
}

/// As [`for_each_line`], with the number of the line.
pub(crate) fn for_each_line_at(
    input: impl Read,
    mut found: impl FnMut(u64, &[&[u8]]) -> Result<()>,
) -> Result<u64> {
    let mut lines = Lines::new(input, "");
    let mut count = 0;
    while lines.next_trimmed()?.is_some() {
        let separators = |byte: &u8| byte.is_ascii_whitespace() || b",;:".contains(byte);
        let line = lines.current().trim_ascii();
        let words = without_comment(line).split(separators).filter(|word| !word.is_empty());
        let words: Vec<&[u8]> = words.collect();
        if !words.is_empty() {
            count += 1;
            found(lines.number(), &words).map_err(|e| e.at(lines.position()))?;
        }
    }
    Ok(count)
}

/// The finite number that a word denotes.
///
/// # Errors
/// Malformed, if the word is not a finite number.
pub fn finite(word: &[u8]) -> Result<f64> {
    let finite = number(word).filter(|number| number.is_finite());
    finite.ok_or_else(|| Error::malformed(format!("found {}, expected a finite number", quote(word))))
}
