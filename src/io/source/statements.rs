//! Lines of a text input, of bounded length, counted for messages.

use std::io::{BufRead, BufReader, Read};

use super::lines::{number, quote};
use super::origin::FileView;
use spmesh_core::error::{Error, Result};
use spmesh_core::limits::{TEXT_HEADER_LINE_MAX, TEXT_LINE_MAX};

/// Lines that may be longer than others: the header of a text twin holds the CRS.
const HEADER_START: &[u8] = b"#spmesh ";

/// Reads an input line by line. Memory: one line and a buffer.
pub(super) struct Lines<R> {
    input: BufReader<R>,
    name: String,
    line: Vec<u8>,
    number: u64,
    ended: bool,
    longest: usize,
    /// The last line of the input, if it has no line end.
    unended: Option<u64>,
}

impl<R: Read> Lines<R> {
    pub(super) fn new(input: R, name: impl Into<String>) -> Self {
        Lines::with_longest(input, name, TEXT_LINE_MAX)
    }

    /// As `new`, for formats whose lines may have up to `longest` bytes.
    pub(super) fn with_longest(input: R, name: impl Into<String>, longest: usize) -> Self {
        let input = BufReader::with_capacity(1 << 17, input);
        Lines { input, name: name.into(), line: Vec::new(), number: 0, ended: true, longest, unended: None }
    }

    /// The next line without its line end (LF or CR LF); `None` at the end of the input.
    pub(super) fn next_line(&mut self) -> Result<Option<&[u8]>> {
        self.line.clear();
        self.number += 1;
        self.ended = false;
        while !self.ended {
            let bytes = match self.input.fill_buf() {
                Ok(bytes) => bytes,
                Err(e) if e.kind() == std::io::ErrorKind::Interrupted => continue,
                Err(e) => return Err(self.locate(Error::io("reading", e))),
            };
            if bytes.is_empty() {
                break;
            }
            let end = memchr::memchr(b'\n', bytes);
            self.line.extend_from_slice(&bytes[..end.unwrap_or(bytes.len())]);
            let used = end.map_or(bytes.len(), |end| end + 1);
            self.input.consume(used);
            self.ended = end.is_some();
            let longest =
                if self.line.starts_with(HEADER_START) { TEXT_HEADER_LINE_MAX } else { self.longest };
            if self.line.len() > longest {
                let message = format!("line of more than {longest} bytes: not a text of this format");
                return Err(self.locate(Error::malformed(message)));
            }
        }
        if self.line.last() == Some(&b'\r') {
            self.line.pop();
        }
        if !self.ended && !self.line.is_empty() {
            self.unended = Some(self.number);
        }
        Ok((self.ended || !self.line.is_empty()).then_some(&self.line))
    }

    /// What follows the line that was read last, for formats whose header alone is text.
    pub(super) fn input(&mut self) -> &mut BufReader<R> {
        &mut self.input
    }

    /// The line that was read last.
    pub(super) fn current(&self) -> &[u8] {
        &self.line
    }

    /// Number of the line that was read last, counted from 1.
    pub(super) fn number(&self) -> u64 {
        self.number
    }

    /// Number of the line without a line end, at the end of the input.
    pub(super) fn unended(&self) -> Option<u64> {
        self.unended
    }

    /// Whether the line that was read last has a line end: a text that was cut off mostly ends without one.
    pub(super) fn is_ended(&self) -> bool {
        self.ended
    }

    /// Adds input and line to an error about the line that was read last.
    pub(super) fn locate(&self, error: Error) -> Error {
        error.at(format!("line {}", self.number)).of_input(&self.name)
    }
}

impl Lines<FileView> {
    /// Byte of the file behind the line that was read last.
    pub(super) fn byte(&self) -> u64 {
        self.input.get_ref().position() - self.input.buffer().len() as u64
    }
}

/// The fields of a line: runs of bytes without spaces and tabs.
pub(super) fn fields(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|&byte| byte == b' ' || byte == b'\t').filter(|field| !field.is_empty())
}

/// A finite number in any decimal notation.
pub(super) fn parse_decimal(field: &[u8]) -> Result<f64> {
    number(field).filter(|number| number.is_finite()).ok_or_else(|| unexpected(field, "a finite number"))
}

/// An integer without sign.
pub(super) fn parse_integer(field: &[u8]) -> Result<u64> {
    let digits = field.iter().all(u8::is_ascii_digit).then_some(field);
    let number = digits.and_then(|digits| std::str::from_utf8(digits).ok()?.parse().ok());
    number.ok_or_else(|| unexpected(field, "an integer"))
}

/// An integer with an optional sign.
pub(super) fn parse_signed(field: &[u8]) -> Result<i64> {
    let number = std::str::from_utf8(field).ok().and_then(|text| text.parse().ok());
    number.ok_or_else(|| unexpected(field, "an integer"))
}

/// The next `N` fields as finite numbers.
pub(super) fn parse_decimals<'a, const N: usize>(
    fields: &mut impl Iterator<Item = &'a [u8]>,
) -> Result<[f64; N]> {
    let mut numbers = [0.0; N];
    for number in &mut numbers {
        *number = parse_decimal(next_field(fields)?)?;
    }
    Ok(numbers)
}

/// The next field, which must be there.
pub(super) fn next_field<'a>(fields: &mut impl Iterator<Item = &'a [u8]>) -> Result<&'a [u8]> {
    fields.next().ok_or_else(|| Error::malformed("the line ends early: a field is missing"))
}

/// That no field is left.
pub(super) fn expect_no_field<'a>(fields: &mut impl Iterator<Item = &'a [u8]>) -> Result<()> {
    fields.next().map_or(Ok(()), |field| Err(unexpected(field, "the end of the line")))
}

/// An error that quotes the beginning of what was found.
pub(super) fn unexpected(found: &[u8], expected: &str) -> Error {
    Error::malformed(format!("found {}, expected {expected}", quote(found)))
}
