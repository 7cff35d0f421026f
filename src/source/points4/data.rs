//! The values of a volume, where they are in one file or several.

use std::io::{self, BufRead, BufReader, Read};

use crate::error::{Error, Result};
use crate::limits::VOLUME_NUMBER_MAX;
use crate::source::byte_order::ByteOrder;
use crate::source::gzip::Gunzip;
use crate::source::lines::quote;
use crate::source::origin::Origin;
use crate::source::sample_type::SampleType;

/// Values decoded at once.
const BATCH_VALUES: u64 = 1 << 13;

/// How values are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Raw(ByteOrder),
    Gzip(ByteOrder),
    Text,
}

/// Where the values of a volume are, and how they are written.
#[derive(Debug)]
pub(super) struct Data {
    /// Files, each with as many of the values, in order.
    pub parts: Vec<Part>,
    pub sample: SampleType,
    pub encoding: Encoding,
    /// Lines of each part before its values, as it is stored.
    pub line_skip: u64,
    /// Bytes after those and before the values, decompressed.
    pub byte_skip: Skip,
    /// Whether bytes behind the values are an error: the size was not stated by the file.
    pub is_exact: bool,
}

/// Bytes before values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Skip {
    Bytes(u64),
    /// All but the values, which end the file.
    ToEnd,
}

/// A file with values.
#[derive(Debug)]
pub(super) struct Part {
    pub origin: Origin,
    /// What messages call it, if it is another file than the input.
    pub name: Option<String>,
    /// Whether the file is compressed as a whole.
    pub is_gzip: bool,
    /// Bytes of the header before the data, decompressed.
    pub header_len: u64,
}

impl Data {
    /// Gives all `total` values to `visit`, in batches.
    ///
    /// Memory: a batch. Reads no more than `total` values and a byte, however much a compressed file would give.
    ///
    /// # Errors
    /// If there are fewer values, or one of them is none; or whatever `visit` returns.
    pub(super) fn scan(&self, total: u64, visit: &mut dyn FnMut(&[f64]) -> Result<()>) -> Result<()> {
        let share = total / self.parts.len() as u64;
        for part in &self.parts {
            let scanned = self.scan_part(part, share, visit);
            scanned.map_err(|e| part.name.iter().fold(e, |e, name| e.of_input(name)))?;
        }
        Ok(())
    }

    fn scan_part(&self, part: &Part, total: u64, visit: &mut dyn FnMut(&[f64]) -> Result<()>) -> Result<()> {
        let mut input = self.open(part, total)?;
        match self.encoding {
            Encoding::Raw(order) | Encoding::Gzip(order) => {
                self.scan_bytes(&mut input, order, total, visit)?
            }
            Encoding::Text => self.scan_text(&mut input, total, visit)?,
        }
        if self.is_exact && !fill(&mut input)?.is_empty() {
            let bytes = total * self.sample.len() as u64;
            let reason = format!("has more than {bytes} bytes: the stated sizes or the type are wrong");
            return Err(Error::malformed(reason));
        }
        Ok(())
    }

    /// The data of a part.
    fn open(&self, part: &Part, total: u64) -> Result<Box<dyn BufRead>> {
        let view = part.origin.view()?;
        if self.byte_skip == Skip::ToEnd {
            let wanted = total.saturating_mul(self.sample.len() as u64);
            let Some(start) = view.len().checked_sub(wanted) else {
                return Err(truncated(view.len() / self.sample.len() as u64, total));
            };
            return Ok(Box::new(BufReader::new(view.range(start, view.len()))));
        }
        let mut input: Box<dyn BufRead> =
            if part.is_gzip { buffered(Gunzip::new(view)) } else { buffered(view) };
        skip_bytes(&mut input, part.header_len)?;
        skip_lines(&mut input, self.line_skip)?;
        if let Encoding::Gzip(_) = self.encoding {
            input = buffered(Gunzip::new(input));
        }
        if let Skip::Bytes(bytes) = self.byte_skip {
            skip_bytes(&mut input, bytes)?;
        }
        Ok(input)
    }

    fn scan_bytes(
        &self,
        input: &mut dyn BufRead,
        order: ByteOrder,
        total: u64,
        visit: &mut dyn FnMut(&[f64]) -> Result<()>,
    ) -> Result<()> {
        let (mut bytes, mut values) = (Vec::new(), Vec::new());
        let mut done = 0;
        while done < total {
            let wanted = BATCH_VALUES.min(total - done) * self.sample.len() as u64;
            bytes.clear();
            values.clear();
            input.take(wanted).read_to_end(&mut bytes).map_err(|e| Error::io("reading", e))?;
            self.sample.decode(&bytes, order, &mut values);
            visit(&values)?;
            done += values.len() as u64;
            if (bytes.len() as u64) < wanted {
                return Err(truncated(done, total));
            }
        }
        Ok(())
    }

    fn scan_text(
        &self,
        input: &mut dyn BufRead,
        total: u64,
        visit: &mut dyn FnMut(&[f64]) -> Result<()>,
    ) -> Result<()> {
        let mut number = Vec::new();
        for done in 0..total {
            next_number(input, &mut number).map_err(|e| e.at(format!("value {}", done + 1)))?;
            if number.is_empty() {
                return Err(truncated(done, total));
            }
            let value = self.sample.parse(&number).map_err(|e| e.at(format!("value {}", done + 1)))?;
            visit(&[value])?;
        }
        Ok(())
    }
}

fn buffered<'i>(input: impl Read + 'i) -> Box<dyn BufRead + 'i> {
    Box::new(BufReader::with_capacity(1 << 17, input))
}

fn truncated(found: u64, expected: u64) -> Error {
    Error::malformed(format!("truncated: found {found} of {expected} values"))
}

/// The bytes that come next; none at the end.
fn fill(input: &mut dyn BufRead) -> Result<&[u8]> {
    // Interrupted reads are repeated here, since the slice of a failed try cannot be returned from a loop.
    while let Err(e) = input.fill_buf() {
        if e.kind() != io::ErrorKind::Interrupted {
            return Err(Error::io("reading", e));
        }
    }
    input.fill_buf().map_err(|e| Error::io("reading", e))
}

fn skip_bytes(input: &mut dyn BufRead, bytes: u64) -> Result<()> {
    let skipped = io::copy(&mut input.take(bytes), &mut io::sink()).map_err(|e| Error::io("reading", e))?;
    if skipped < bytes {
        return Err(Error::malformed(format!(
            "ends early: {bytes} bytes are to be skipped, found {skipped}"
        )));
    }
    Ok(())
}

fn skip_lines(input: &mut dyn BufRead, lines: u64) -> Result<()> {
    for line in 0..lines {
        let skipped = input.skip_until(b'\n').map_err(|e| Error::io("reading", e))?;
        if skipped == 0 {
            return Err(Error::malformed(format!(
                "ends early: {lines} lines are to be skipped, found {line}"
            )));
        }
    }
    Ok(())
}

/// Replaces `number` by what comes next between white space and commas; nothing at the end.
fn next_number(input: &mut dyn BufRead, number: &mut Vec<u8>) -> Result<()> {
    number.clear();
    loop {
        let bytes = fill(input)?;
        if bytes.is_empty() {
            return Ok(());
        }
        let is_between = |byte: &u8| byte.is_ascii_whitespace() || *byte == b',';
        let start =
            if number.is_empty() { bytes.iter().take_while(|byte| is_between(byte)).count() } else { 0 };
        let rest = &bytes[start..];
        let len = rest.iter().position(is_between).unwrap_or(rest.len());
        if number.len() + len > VOLUME_NUMBER_MAX {
            let found = quote(if number.is_empty() { rest } else { number });
            let message = format!("found {found}, expected a number of at most {VOLUME_NUMBER_MAX} bytes");
            return Err(Error::malformed(message));
        }
        number.extend_from_slice(&rest[..len]);
        let is_whole = len < rest.len() && !number.is_empty();
        input.consume(start + len);
        if is_whole {
            return Ok(());
        }
    }
}
