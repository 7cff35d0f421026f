//! Recognizes formats by their first bytes, and by the name of the file where those leave a doubt.

use std::path::Path;

use super::Format;
use spmesh_core::error::{Error, Result};

/// Bytes from the start of an input that are looked at.
pub(super) const HEAD_LEN: u64 = 1 << 14;

/// The format of an input that starts with `head`.
///
/// # Errors
/// Malformed, if it is empty; usage, if it is of no known format or could be of several.
pub(super) fn detect(head: &[u8], name: &Path) -> Result<Format> {
    if head.is_empty() {
        return Err(Error::malformed("the input is empty"));
    }
    let by_content = by_magic(head).or_else(|| by_statements(head));
    let by_name = || Format::from_path(name).filter(|format| format.is_read());
    by_content.or_else(by_name).ok_or_else(|| {
        Error::usage("cannot tell the format from the first bytes and the name: give it with --from")
    })
}

/// Binary formats, and texts that say what they are.
fn by_magic(head: &[u8]) -> Option<Format> {
    match head {
        [0x89, b'S', ..] => Some(Format::Spm),
        [7, 0 | 1, ..] => Some(Format::Spb),
        [0, 0 | 1, ..] => Some(Format::Smb),
        _ if head.starts_with(b"#spmesh ") => Some(Format::Text),
        _ if head.starts_with(b"ply\n") || head.starts_with(b"ply\r") => Some(Format::Ply),
        _ => None,
    }
}

/// Texts that are recognized by a statement that only one of them has.
fn by_statements(head: &[u8]) -> Option<Format> {
    let mut has_vertices = false;
    for line in head.split(|&byte| byte == b'\n') {
        let mut fields = line.split(u8::is_ascii_whitespace).filter(|field| !field.is_empty());
        let (first, second) = (fields.next().unwrap_or_default(), fields.next().unwrap_or_default());
        let found = match (first, second) {
            (b"#", b"nverts" | b"nfaces" | b"SMA") => Format::Sma,
            (b"#", b"npoints" | b"datatype" | b"finalizemethod" | b"SPA") => Format::Spa,
            (b"#", b"OBJ") | (b"vn" | b"vt" | b"o" | b"g" | b"mtllib" | b"usemtl" | b"s", _) => Format::Obj,
            (b"x", b"cell") | (b"p", _) => Format::Spa,
            (b"x", _) => Format::Sma,
            (b"f", _) if !has_vertices => Format::Sma,
            (b"f", corner) if corner.contains(&b'/') => Format::Obj,
            (b"v", _) => {
                has_vertices = true;
                continue;
            }
            _ => continue,
        };
        return Some(found);
    }
    None
}
