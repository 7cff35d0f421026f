//! Where the index of LAStools is: in a record of the file, or in a file beside it.

use std::fs;
use std::io::{ErrorKind, Read};
use std::path::Path;

use crate::las::header::{EVLR_HEADER_LEN, LAX, LasHeader};
use crate::source::origin::{FileView, Origin};
use spmesh_base::error::{Error, Result};
use spmesh_base::inputs;
use spmesh_base::limits::{LAX_LEN_MAX, check_len};

/// Finds an index, and returns its name in messages and its bytes; `None` if there is none.
pub(crate) fn find(
    origin: &Origin,
    file: &FileView,
    header: &LasHeader,
) -> Option<(String, Result<Vec<u8>>)> {
    let record = header.indices.lax.clone().or_else(|| appended(file, header));
    if let Some(record) = record {
        let name = format!("the index at byte {}", record.start);
        let content = file.range(record.start, record.end);
        return Some((name, read(content, record.end - record.start)));
    }
    let path = origin.path()?;
    let beside = ["lax", "LAX"].map(|ending| path.with_extension(ending));
    let found = beside.into_iter().find(|beside| beside != path && fs::metadata(beside).is_ok())?;
    Some((format!("the index {}", found.display()), read_beside(path, &found)))
}

/// Bytes of an index in a record that LAStools appended to the file.
fn appended(file: &FileView, header: &LasHeader) -> Option<std::ops::Range<u64>> {
    let at = header.laz.as_ref()?.appended?;
    let mut head = [0; EVLR_HEADER_LEN as usize];
    file.read_at(at, &mut head).ok()?;
    let user = head[2..18].split(|&byte| byte == 0).next()?;
    let number = u16::from_le_bytes([head[18], head[19]]);
    let len = u64::from_le_bytes(head[20..28].try_into().ok()?);
    let start = at.checked_add(EVLR_HEADER_LEN)?;
    let end = start.checked_add(len)?;
    ((user, number) == LAX && end <= file.len()).then_some(start..end)
}

/// Reads an index beside the file `of`.
fn read_beside(of: &Path, path: &Path) -> Result<Vec<u8>> {
    let changed = |path: &Path| fs::metadata(path).and_then(|metadata| metadata.modified());
    let changed = |path: &Path| changed(path).map_err(|e| Error::io("reading its time", e));
    if changed(path)? < changed(of)? {
        return Err(Error::malformed("it is older than the file"));
    }
    let file = inputs::open(path)?;
    let len = file.metadata().map_err(|e| Error::io("reading", e))?.len();
    read(file, len)
}

fn read(mut from: impl Read, len: u64) -> Result<Vec<u8>> {
    check_len("it has", len, LAX_LEN_MAX)?;
    let mut bytes = vec![0; len as usize];
    match from.read_exact(&mut bytes) {
        Err(e) if e.kind() == ErrorKind::UnexpectedEof => Err(Error::malformed("it is cut off")),
        outcome => outcome.map(|()| bytes).map_err(|e| Error::io("reading", e)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn length_has_a_limit() {
        let read = |len| read(std::io::repeat(0), len).map(|bytes| bytes.len() as u64);
        assert_eq!(read(LAX_LEN_MAX).unwrap(), LAX_LEN_MAX);
        let message = read(LAX_LEN_MAX + 1).unwrap_err().to_string();
        assert!(message.contains("33554433 bytes, the maximum is 33554432"), "{message}");
    }
}
