//! Recognizes formats by the first bytes of an input: one table for all tools. File names are not used: data
//! arrives through pipes, and extensions can be wrong.

pub(crate) mod binary;
mod readers;
pub(crate) mod structures;
mod text;

use std::io::{self, Read};

use crate::drivers::{Row, formats_with};
use spmesh_base::error::{Error, Result};

pub use crate::drivers::Format;
pub use readers::{
    CONFIGGEN, DD4, READERS, Reader, SPCANOPY, SPCONVERT, SPFINALIZE, SPGROUND, SPGROUND_MESH, SPHEIGHT,
    SPINFO, SPLINEFIT, SPREPORT, TESS3,
};
pub(crate) use text::is_off;

/// Bytes from the start of an input that recognition needs.
pub const HEAD_LEN: u64 = 1 << 16;

/// The byte order mark that some editors write before UTF-8 text.
pub const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// How a format is recognized.
pub(crate) enum Test {
    /// The input starts with one of these.
    Magic(&'static [&'static [u8]]),
    /// A test of the first bytes, after a byte order mark if there is one.
    Look(fn(&[u8]) -> bool),
    /// Text, recognized by its lines.
    Lines,
    /// A format that is written only.
    Never,
}

/// The format of an input that starts with `head`, its first [`HEAD_LEN`] bytes or all it has.
///
/// # Errors
/// Malformed, if the input is empty.
pub fn detect(head: &[u8]) -> Result<Format> {
    if head.is_empty() {
        return Err(Error::malformed("empty: the input has no bytes"));
    }
    let body = head.strip_prefix(BYTE_ORDER_MARK).unwrap_or(head);
    let fits = |row: &Row| match row.test {
        Test::Magic(starts) => starts.iter().any(|start| body.starts_with(start)),
        Test::Look(fits) => fits(body),
        Test::Lines | Test::Never => false,
    };
    Ok(formats_with(fits).first().copied().unwrap_or_else(|| text::detect(body)))
}

/// The first bytes of `input`, as many as [`detect`] needs.
///
/// # Errors
/// If reading fails.
pub fn read_head(input: &mut impl Read) -> io::Result<Vec<u8>> {
    let mut head = Vec::new();
    input.take(HEAD_LEN).read_to_end(&mut head)?;
    Ok(head)
}
