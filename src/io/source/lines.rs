//! Lines of text files, of bounded length.

use std::io::{BufRead, Read};

use spmesh_core::error::{Error, Result};
use spmesh_core::limits::TEXT_LINE_MAX;

/// Reads lines and counts them.
pub(super) struct LineReader<R> {
    input: R,
    line: Vec<u8>,
    number: u64,
}

impl<R: BufRead> LineReader<R> {
    pub(super) fn new(input: R) -> Self {
        LineReader { input, line: Vec::new(), number: 0 }
    }

    /// Number of the line that was read last, counted from 1.
    pub(super) fn number(&self) -> u64 {
        self.number
    }

    /// The next line without white space around it, whatever its end is; `None` at the end.
    ///
    /// # Errors
    /// If reading fails, the line is too long, or has a zero byte or a carriage return in it.
    pub(super) fn next_line(&mut self) -> Result<Option<&[u8]>> {
        self.number += 1;
        self.line.clear();
        let mut input = (&mut self.input).take(TEXT_LINE_MAX as u64 + 1);
        input.read_until(b'\n', &mut self.line).map_err(|e| Error::io("reading", e).at(self.position()))?;
        if self.line.is_empty() {
            return Ok(None);
        }
        if self.line.len() > TEXT_LINE_MAX {
            let reason = format!("longer than {TEXT_LINE_MAX} bytes: not a text of points");
            return Err(Error::malformed(reason).at(self.position()));
        }
        if self.line.contains(&0) {
            return Err(Error::malformed("zero byte: not a text").at(self.position()));
        }
        let line = match self.number {
            1 => self.line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&self.line),
            _ => &self.line,
        };
        let line = line.trim_ascii();
        if line.contains(&b'\r') {
            let reason = "carriage return inside of a line: lines must end with LF or CR LF";
            return Err(Error::malformed(reason).at(self.position()));
        }
        Ok(Some(line))
    }

    /// Where the reader is, for messages.
    pub(super) fn position(&self) -> String {
        format!("line {}", self.number)
    }
}

/// A piece of a line for messages: what is not text is replaced, what is long is cut.
pub fn quote(bytes: &[u8]) -> String {
    const SHOWN: usize = 40;
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(SHOWN)]);
    let rest = if bytes.len() > SHOWN { "..." } else { "" };
    format!("{:?}{rest}", text)
}

/// The number that `field` is, exactly as `f64` has it.
pub(super) fn number(field: &[u8]) -> Option<f64> {
    std::str::from_utf8(field).ok()?.parse().ok()
}
