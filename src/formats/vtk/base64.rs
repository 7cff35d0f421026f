//! Decodes base64.

use std::io::{self, BufRead, Read};

use data_encoding::BASE64;

/// Characters decoded at once, a multiple of four.
const CHUNK_LEN: usize = 1 << 15;

/// Decodes base64 up to the first `<` or the end of the input. White space is ignored. More groups may follow
/// padding, because VTK encodes lengths and data separately, one after the other.
pub(crate) struct Base64Reader<R> {
    input: R,
    /// Characters not yet decoded.
    encoded: Vec<u8>,
    decoded: Vec<u8>,
    /// Decoded bytes already returned.
    used: usize,
    /// Characters that were decoded.
    done: u64,
}

impl<R: BufRead> Base64Reader<R> {
    pub(crate) fn new(input: R) -> Self {
        Base64Reader { input, encoded: Vec::new(), decoded: Vec::new(), used: 0, done: 0 }
    }

    /// Fills `encoded` up to [`CHUNK_LEN`] characters, after any incomplete group of four from the last call;
    /// fewer only at the end.
    fn gather(&mut self) -> io::Result<()> {
        while self.encoded.len() < CHUNK_LEN {
            let bytes = match self.input.fill_buf() {
                Err(e) if e.kind() == io::ErrorKind::Interrupted => continue,
                bytes => bytes?,
            };
            let wanted = &bytes[..bytes.len().min(CHUNK_LEN - self.encoded.len())];
            let end = wanted.iter().position(|&byte| byte == b'<');
            let used = end.unwrap_or(wanted.len());
            let is_end = end.is_some() || bytes.is_empty();
            self.encoded.extend(wanted[..used].iter().filter(|byte| !byte.is_ascii_whitespace()));
            self.input.consume(used);
            if is_end {
                break;
            }
        }
        Ok(())
    }

    /// Decodes all complete groups of four characters.
    fn decode(&mut self) -> io::Result<()> {
        let invalid = |at: usize, what: &str| {
            let message = format!("the base64 data {what} at character {}", self.done + at as u64);
            io::Error::new(io::ErrorKind::InvalidData, message)
        };
        let groups = &self.encoded[..self.encoded.len() / 4 * 4];
        if groups.is_empty() && !self.encoded.is_empty() {
            return Err(invalid(self.encoded.len(), "end within a group of four"));
        }
        self.decoded.resize(groups.len() / 4 * 3, 0);
        self.used = 0;
        let decoded = BASE64.decode_mut(groups, &mut self.decoded);
        let len = decoded.map_err(|e| invalid(e.error.position, "are damaged"))?;
        self.decoded.truncate(len);
        self.done += groups.len() as u64;
        let used = groups.len();
        self.encoded.drain(..used);
        Ok(())
    }
}

impl<R: BufRead> Read for Base64Reader<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.used == self.decoded.len() {
            self.gather()?;
            self.decode()?;
        }
        let len = buffer.len().min(self.decoded.len() - self.used);
        buffer[..len].copy_from_slice(&self.decoded[self.used..self.used + len]);
        self.used += len;
        Ok(len)
    }
}
