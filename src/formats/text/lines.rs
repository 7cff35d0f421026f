//! Lines of text inputs, of bounded length, counted for messages.

use std::io::{BufRead, BufReader, ErrorKind, Read};

use crate::detect::BYTE_ORDER_MARK;
use crate::source::origin::FileView;
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::{TEXT_HEADER_LINE_MAX, TEXT_LINE_MAX};

/// Bytes read at once.
const BUFFER_LEN: usize = 1 << 17;

/// Start of lines that may be longer than others: the header of a text twin holds the CRS.
const HEADER_START: &[u8] = b"#spmesh ";

/// Reads an input line by line. Memory: one line and a buffer.
pub(crate) struct Lines<R> {
    input: BufReader<R>,
    /// Name of the input in messages; empty if the caller adds the name.
    name: String,
    line: Vec<u8>,
    number: u64,
    ended: bool,
    /// Whether a carriage return came before the last line end.
    returned: bool,
    longest: usize,
    /// Number of the input's last line, if that has no line end.
    unended: Option<u64>,
    /// Bytes of all lines so far, with their line ends.
    bytes: u64,
}

impl<R: Read> Lines<R> {
    /// Lines of at most [`TEXT_LINE_MAX`] bytes. `name` is the name of the input in messages, or empty if the
    /// caller adds it.
    pub(crate) fn new(input: R, name: impl Into<String>) -> Self {
        Lines::with_longest(input, name, TEXT_LINE_MAX)
    }

    /// As `new`, for formats whose lines may have up to `longest` bytes.
    pub(crate) fn with_longest(input: R, name: impl Into<String>, longest: usize) -> Self {
        Lines {
            input: BufReader::with_capacity(BUFFER_LEN, input),
            name: name.into(),
            line: Vec::new(),
            number: 0,
            ended: true,
            returned: false,
            longest,
            unended: None,
            bytes: 0,
        }
    }

    /// The next line without its line end (LF or CR LF) and without a byte order mark; `None` at the end of
    /// the input.
    pub(crate) fn next_line(&mut self) -> Result<Option<&[u8]>> {
        self.line.clear();
        self.number += 1;
        self.ended = false;
        while !self.ended {
            let bytes = match self.input.fill_buf() {
                Ok(bytes) => bytes,
                Err(e) if e.kind() == ErrorKind::Interrupted => continue,
                Err(e) => return Err(self.locate(Error::io("reading", e))),
            };
            if bytes.is_empty() {
                break;
            }
            let end = memchr::memchr(b'\n', bytes);
            self.line.extend_from_slice(&bytes[..end.unwrap_or(bytes.len())]);
            let used = end.map_or(bytes.len(), |end| end + 1);
            self.input.consume(used);
            self.bytes += used as u64;
            self.ended = end.is_some();
            if self.line.len() > self.longest {
                self.check_len()?;
            }
        }
        self.returned = self.line.last() == Some(&b'\r');
        if self.returned {
            self.line.pop();
        }
        if self.number == 1 && self.line.starts_with(BYTE_ORDER_MARK) {
            self.line.drain(..BYTE_ORDER_MARK.len());
        }
        if !self.ended && !self.line.is_empty() {
            self.unended = Some(self.number);
        }
        Ok((self.ended || !self.line.is_empty()).then_some(&self.line))
    }

    /// As `next_line`, for texts that people write: strips white space around the line.
    pub(crate) fn next_trimmed(&mut self) -> Result<Option<&[u8]>> {
        if self.next_line()?.is_none() {
            return Ok(None);
        }
        if memchr::memchr(0, &self.line).is_some() {
            return Err(self.locate(Error::malformed("zero byte: not a text")));
        }
        let line = self.line.trim_ascii();
        if memchr::memchr(b'\r', line).is_some() {
            let reason = "carriage return inside of a line: lines must end with LF or CR LF";
            return Err(self.locate(Error::malformed(reason)));
        }
        Ok(Some(line))
    }

    #[cold]
    fn check_len(&self) -> Result<()> {
        let longest = if self.line.starts_with(HEADER_START) { TEXT_HEADER_LINE_MAX } else { self.longest };
        if self.line.len() <= longest {
            return Ok(());
        }
        let message = format!("line of more than {longest} bytes: not a text of this format");
        Err(self.locate(Error::malformed(message)))
    }

    /// The input after the last line read, for formats with only a text header.
    pub(crate) fn input(&mut self) -> &mut BufReader<R> {
        &mut self.input
    }

    /// The last line read.
    pub(crate) fn current(&self) -> &[u8] {
        &self.line
    }

    /// Number of the last line read, counted from 1.
    pub(crate) fn number(&self) -> u64 {
        self.number
    }

    /// Number of the input's last line, if that has no line end.
    pub(crate) fn unended(&self) -> Option<u64> {
        self.unended
    }

    /// Whether the last line read has a line end. Truncated texts mostly end without one.
    pub(crate) fn is_ended(&self) -> bool {
        self.ended
    }

    /// The line end of the last line read.
    pub(crate) fn line_end(&self) -> &'static [u8] {
        match (self.returned, self.ended) {
            (false, false) => b"",
            (true, false) => b"\r",
            (false, true) => b"\n",
            (true, true) => b"\r\n",
        }
    }

    /// Bytes of all lines so far, with their line ends.
    pub(crate) fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Position of the last line read, for messages.
    pub(crate) fn position(&self) -> String {
        format!("line {}", self.number)
    }

    /// Adds input and line to an error about the last line read.
    pub(crate) fn locate(&self, error: Error) -> Error {
        let error = error.at(self.position());
        if self.name.is_empty() { error } else { error.of_input(&self.name) }
    }
}

impl Lines<FileView> {
    /// Offset in the file after everything read so far, lines or not.
    pub(crate) fn byte(&self) -> u64 {
        self.input.get_ref().position() - self.input.buffer().len() as u64
    }
}

/// A piece of input for messages: invalid UTF-8 is replaced, long pieces are cut.
pub fn quote(bytes: &[u8]) -> String {
    const SHOWN: usize = 40;
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(SHOWN)]);
    let rest = if bytes.len() > SHOWN { "..." } else { "" };
    format!("{:?}{rest}", text)
}

/// The number that `field` denotes, rounded to f64.
pub(crate) fn number(field: &[u8]) -> Option<f64> {
    std::str::from_utf8(field).ok()?.parse().ok()
}
