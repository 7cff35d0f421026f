//! Tests whether a file ends with an END block, without reading the rest.

use std::io::{self, Read, Seek, SeekFrom};

use super::block::{FRAME_LEN, Frame, Tag};
use super::event::Totals;

/// Length of the END block in bytes.
const END_LEN: usize = FRAME_LEN + 8 * Totals::FIELDS;

/// Whether the last bytes of a file are a valid END block. Nothing before it is read.
///
/// # Errors
/// If the file cannot be read.
pub fn ends_with_end(file: &mut (impl Read + Seek)) -> io::Result<bool> {
    if file.seek(SeekFrom::End(0))? < END_LEN as u64 {
        return Ok(false);
    }
    file.seek(SeekFrom::End(-(END_LEN as i64)))?;
    let mut bytes = [0; END_LEN];
    file.read_exact(&mut bytes)?;
    let (head, payload) = bytes.split_first_chunk::<FRAME_LEN>().expect("longer than a frame");
    let frame = Frame::decode(head);
    let is_end = frame.tag == Tag::End.bytes() && !frame.is_compressed;
    Ok(is_end && frame.len as usize == payload.len() && frame.verifies(payload))
}
