//! The start of a stream: its preamble, its header, and their checksum.

use std::io::Read;

use byteorder::{ByteOrder, LittleEndian as LE};

use super::header::Header;
use super::header_code::{MAGIC, PREAMBLE_LEN, decode_preamble};
use spmesh_base::error::{Error, Result};

/// Reads the header; returns it with its length.
pub(super) fn read_header(input: &mut impl Read) -> Result<(Header, u64)> {
    let mut bytes = vec![0; PREAMBLE_LEN];
    let found = read_full(input, &mut bytes)?;
    if found == 0 {
        return Err(Error::malformed("the input is empty, expected a spmesh stream"));
    }
    if !MAGIC.starts_with(&bytes[..found.min(MAGIC.len())]) {
        return Err(Error::malformed(
            "the first bytes are not those of a spmesh stream; LAS, LAZ and text go through spfinalize \
             first, other formats through spconvert",
        ));
    }
    if found < PREAMBLE_LEN {
        return Err(Error::malformed(format!("truncated: found {found} of the first {PREAMBLE_LEN} bytes")));
    }
    let (kind, body_len) = decode_preamble(&bytes)?;
    let end = PREAMBLE_LEN + body_len;
    bytes.resize(end + 4, 0);
    let found = read_full(input, &mut bytes[PREAMBLE_LEN..])?;
    if found < body_len + 4 {
        return Err(Error::malformed(format!("truncated: found {found} of {} bytes", body_len + 4)));
    }
    if crc32c::crc32c(&bytes[..end]) != LE::read_u32(&bytes[end..]) {
        return Err(Error::malformed("checksum does not match: the header is damaged"));
    }
    Ok((Header::decode(kind, &bytes[PREAMBLE_LEN..end])?, (end + 4) as u64))
}

/// Reads until `buffer` is full or the input ends; returns the number of bytes read.
pub(super) fn read_full(input: &mut impl Read, buffer: &mut [u8]) -> Result<usize> {
    let mut filled = 0;
    while filled < buffer.len() {
        match input.read(&mut buffer[filled..]) {
            Ok(0) => break,
            Ok(n) => filled += n,
            Err(e) if e.kind() == std::io::ErrorKind::Interrupted => {}
            Err(e) => return Err(Error::io("reading", e)),
        }
    }
    Ok(filled)
}
