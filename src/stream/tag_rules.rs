//! Tags of header records and of blocks that this version does not know: which may be skipped, and what is
//! said about the others.

use std::fmt;

use spmesh_base::error::{Error, Result};

/// Four characters that name a record of the header or a block.
pub(super) type TagBytes = [u8; 4];

/// Bit of the first byte of a tag: a reader that does not know the tag may skip what it names.
const MAY_BE_SKIPPED: u8 = 1 << 5;

/// Checks the characters of the tag of a `part`: ASCII letters, digits and spaces, of which the first is a
/// letter.
pub(super) fn check_tag(tag: TagBytes, part: &str) -> Result<()> {
    let is_character = |byte: &u8| byte.is_ascii_alphanumeric() || *byte == b' ';
    if tag[0].is_ascii_alphabetic() && tag.iter().all(is_character) {
        return Ok(());
    }
    Err(Error::malformed(format!(
        "{part} tag \"{}\", expected a letter, then letters, digits or spaces",
        tag.escape_ascii()
    )))
}

/// Whether a reader that does not know `tag` skips what it names. The tag must be valid.
pub(super) fn may_be_skipped(tag: TagBytes) -> bool {
    tag[0] & MAY_BE_SKIPPED != 0
}

/// The error about a `part` of a stream that this version does not know and must not skip.
pub(super) fn needs_newer(part: impl fmt::Display) -> Error {
    Error::unsupported(format!(
        "the stream needs {part}, which this program does not know: a newer spmesh made it"
    ))
}
