//! Sequences of numbers, as text or binary.

use std::io::{self, BufRead, Read};

use crate::raw::byte_order::ByteOrder;
use crate::raw::sample::SampleType;
use crate::text::lines::quote;
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::NUMBER_LEN_MAX;

/// How numbers are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Writing {
    Binary(ByteOrder),
    /// Decimals with white space or commas between them.
    Text,
}

/// Reads as many numbers as the file states. Memory: the numbers of one call.
pub(crate) struct NumberReader<R> {
    input: R,
    sample: SampleType,
    writing: Writing,
    /// Stated number of numbers, and numbers read so far.
    total: u64,
    done: u64,
    bytes: Vec<u8>,
}

impl<R: BufRead> NumberReader<R> {
    /// The next `total` numbers of `input`.
    pub(crate) fn new(input: R, sample: SampleType, writing: Writing, total: u64) -> Self {
        NumberReader { input, sample, writing, total, done: 0, bytes: Vec::new() }
    }

    /// Bytes of a number that is stored.
    pub(crate) fn number_len(&self) -> usize {
        self.sample.len()
    }

    /// Numbers read so far.
    pub(crate) fn done(&self) -> u64 {
        self.done
    }

    /// Appends the next `most` numbers to `numbers`, fewer only at the end. False if none are left.
    pub(crate) fn read(&mut self, most: u64, numbers: &mut Vec<f64>) -> Result<bool> {
        let wanted = most.min(self.total - self.done);
        match self.writing {
            Writing::Binary(order) => self.read_bytes(wanted, order, numbers)?,
            Writing::Text => (0..wanted).try_for_each(|_| self.read_text(numbers))?,
        }
        Ok(wanted > 0)
    }

    /// Appends the next `wanted` numbers as they are stored, little-endian.
    pub(crate) fn read_stored(&mut self, wanted: u64, stored: &mut Vec<u8>) -> Result<()> {
        if wanted > self.total - self.done {
            return Err(self.truncated());
        }
        match self.writing {
            Writing::Binary(order) => {
                let start = stored.len();
                let len = self.sample.len();
                let mut input = (&mut self.input).take(wanted * len as u64);
                input.read_to_end(stored).map_err(|e| Error::io("reading", e))?;
                if ((stored.len() - start) as u64) < wanted * len as u64 {
                    return Err(self.truncated());
                }
                if order == ByteOrder::Big {
                    stored[start..].chunks_exact_mut(len).for_each(<[u8]>::reverse);
                }
            }
            Writing::Text => {
                for _ in 0..wanted {
                    next_number(&mut self.input, &mut self.bytes)?;
                    self.sample.parse_stored(&self.bytes, stored)?;
                }
            }
        }
        self.done += wanted;
        Ok(())
    }

    fn read_bytes(&mut self, wanted: u64, order: ByteOrder, numbers: &mut Vec<f64>) -> Result<()> {
        let len = self.sample.len() as u64;
        self.bytes.clear();
        let mut input = (&mut self.input).take(wanted * len);
        input.read_to_end(&mut self.bytes).map_err(|e| Error::io("reading", e))?;
        self.sample.decode(&self.bytes, order, numbers);
        let found = self.bytes.len() as u64 / len;
        self.done += found;
        if found < wanted { Err(self.truncated()) } else { Ok(()) }
    }

    fn read_text(&mut self, numbers: &mut Vec<f64>) -> Result<()> {
        next_number(&mut self.input, &mut self.bytes)?;
        if self.bytes.is_empty() {
            return Err(self.truncated());
        }
        numbers.push(self.sample.parse(&self.bytes)?);
        self.done += 1;
        Ok(())
    }

    /// Whether the input goes on after the numbers. White space does not count in text.
    pub(crate) fn goes_on(&mut self) -> Result<bool> {
        Ok(match self.writing {
            Writing::Binary(_) => !fill(&mut self.input)?.is_empty(),
            Writing::Text => {
                skip_separators(&mut self.input)?;
                !fill(&mut self.input)?.is_empty()
            }
        })
    }

    /// Checks that the input ends after the numbers.
    pub(crate) fn expect_end(&mut self) -> Result<()> {
        if self.goes_on()? {
            let message = format!("there is more behind the {} numbers that are stated", self.total);
            return Err(Error::malformed(message));
        }
        Ok(())
    }

    fn truncated(&self) -> Error {
        truncated(self.done, self.total)
    }
}

/// The error of an input with fewer numbers than stated.
pub(crate) fn truncated(found: u64, expected: u64) -> Error {
    Error::malformed(format!("truncated: found {found} of {expected} values"))
}

/// The next bytes of the buffer; empty at the end.
pub(crate) fn fill(input: &mut impl BufRead) -> Result<&[u8]> {
    // Interrupted reads are retried here, because a loop cannot return the slice that it borrows from
    // `fill_buf`.
    while let Err(e) = input.fill_buf() {
        if e.kind() != io::ErrorKind::Interrupted {
            return Err(Error::io("reading", e));
        }
    }
    input.fill_buf().map_err(|e| Error::io("reading", e))
}

/// Replaces `number` by the next field between white space and commas; empty at the end.
pub(crate) fn next_number(input: &mut impl BufRead, number: &mut Vec<u8>) -> Result<()> {
    number.clear();
    skip_separators(input)?;
    loop {
        let bytes = fill(input)?;
        if bytes.is_empty() {
            return Ok(());
        }
        let len = bytes.iter().position(is_separator).unwrap_or(bytes.len());
        if number.len() + len > NUMBER_LEN_MAX {
            let found = quote(if number.is_empty() { bytes } else { number });
            let message = format!("found {found}, expected a number of at most {NUMBER_LEN_MAX} bytes");
            return Err(Error::malformed(message));
        }
        number.extend_from_slice(&bytes[..len]);
        let is_whole = len < bytes.len();
        input.consume(len);
        if is_whole {
            return Ok(());
        }
    }
}

fn is_separator(byte: &u8) -> bool {
    byte.is_ascii_whitespace() || *byte == b','
}

/// Skips white space and commas.
fn skip_separators(input: &mut impl BufRead) -> Result<()> {
    loop {
        let bytes = fill(input)?;
        let separators = bytes.iter().take_while(|byte| is_separator(byte)).count();
        if separators == 0 {
            return Ok(());
        }
        input.consume(separators);
    }
}
