//! The values of a volume, in one file or several.

use std::io::{self, BufRead, BufReader, Read};

use crate::raw::byte_order::ByteOrder;
use crate::raw::sample::SampleType;
use crate::source::gzip::Gunzip;
use crate::source::origin::Origin;
use crate::text::numbers::{NumberReader, Writing, truncated};
use spmesh_base::error::{Error, Result};

/// Values decoded at once.
const BATCH_VALUES: u64 = 1 << 13;

/// How values are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Encoding {
    Raw(ByteOrder),
    Gzip(ByteOrder),
    Text,
}

/// Where the values of a volume are, and how they are written.
#[derive(Debug)]
pub(crate) struct Data {
    /// The files in order, each with the same number of values.
    pub parts: Vec<Part>,
    pub sample: SampleType,
    pub encoding: Encoding,
    /// Number of lines to skip in each part before its values, as stored.
    pub line_skip: u64,
    /// Bytes to skip after these lines, decompressed.
    pub byte_skip: Skip,
    /// Whether bytes after the values are an error, as where no header states the sizes.
    pub is_exact: bool,
}

/// Bytes before values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Skip {
    Bytes(u64),
    /// All bytes up to the values, which end the file.
    ToEnd,
}

/// A file with values.
#[derive(Debug)]
pub(crate) struct Part {
    pub origin: Origin,
    /// Its name in messages, if it is another file than the input.
    pub name: Option<String>,
    /// Whether the file is compressed as a whole.
    pub is_gzip: bool,
    /// Bytes of the header before the data, decompressed.
    pub header_len: u64,
}

impl Data {
    /// Passes all `total` values to `visit`, in batches. Returns a warning if other bytes follow the values.
    ///
    /// Memory: a batch. Compressed data are read to their end, which verifies their checksums.
    ///
    /// # Errors
    /// If there are fewer values, one of them cannot be parsed, or compressed data are damaged; or any error
    /// of `visit`.
    pub(crate) fn scan(
        &self,
        total: u64,
        visit: &mut dyn FnMut(&[f64]) -> Result<()>,
    ) -> Result<Option<String>> {
        let share = total / self.parts.len() as u64;
        let mut warning = None;
        for part in &self.parts {
            let scanned = self.scan_part(part, share, visit);
            let goes_on = scanned.map_err(|e| part.name.iter().fold(e, |e, name| e.of_input(name)))?;
            if goes_on && warning.is_none() {
                let name = part.name.iter().map(|name| format!("{name}: ")).collect::<String>();
                warning = Some(format!(
                    "{name}the bytes that follow the {share} values are ignored: are the stated sizes and \
                     the type right?"
                ));
            }
        }
        Ok(warning)
    }

    /// True if other bytes follow the values.
    fn scan_part(
        &self,
        part: &Part,
        total: u64,
        visit: &mut dyn FnMut(&[f64]) -> Result<()>,
    ) -> Result<bool> {
        let writing = match self.encoding {
            Encoding::Raw(order) | Encoding::Gzip(order) => Writing::Binary(order),
            Encoding::Text => Writing::Text,
        };
        let mut input = self.open(part, total)?;
        let mut reader = NumberReader::new(&mut input, self.sample, writing, total);
        let mut values = Vec::new();
        loop {
            values.clear();
            let read = reader.read(BATCH_VALUES, &mut values);
            if !read.map_err(|e| self.locate(e, reader.done()))? {
                break;
            }
            visit(&values)?;
        }
        let goes_on = reader.goes_on()?;
        if self.is_exact && goes_on {
            let bytes = total * self.sample.len() as u64;
            let reason = format!("has more than {bytes} bytes: the stated sizes or the type are wrong");
            return Err(Error::malformed(reason));
        }
        if part.is_gzip || matches!(self.encoding, Encoding::Gzip(_)) {
            io::copy(&mut input, &mut io::sink()).map_err(|e| Error::io("reading", e))?;
        }
        Ok(goes_on)
    }

    /// Adds the number of the value after `done` others to an error, where no byte offset tells the position.
    fn locate(&self, error: Error, done: u64) -> Error {
        match self.encoding {
            Encoding::Text => error.at(format!("value {}", done + 1)),
            Encoding::Raw(_) | Encoding::Gzip(_) => error,
        }
    }

    /// Opens the values of a part.
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
}

fn buffered<'i>(input: impl Read + 'i) -> Box<dyn BufRead + 'i> {
    Box::new(BufReader::with_capacity(1 << 17, input))
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
