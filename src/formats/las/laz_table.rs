//! Where the chunk table of a LAZ file is.

use crate::source::origin::FileView;
use spmesh_base::error::{Error, Result};

/// Length of the position of the chunk table, which precedes the chunks.
pub(crate) const TABLE_POSITION_LEN: u64 = 8;

/// Bytes from the end of the table's position, which is stored at `points_start`, to the chunk table; without
/// a table, to `points_end`.
pub(crate) fn room(file: &FileView, points_start: u64, points_end: u64) -> Result<u64> {
    let start = points_start.saturating_add(TABLE_POSITION_LEN);
    if start > file.len() {
        return Ok(0);
    }
    let end = table_position(file, points_start)?.unwrap_or(points_end);
    Ok(end.saturating_sub(start))
}

/// Where the file states its chunk table, if none is there: then the file was cut off. `None` also if its
/// writer stated no place.
pub(crate) fn stated_missing(file: &FileView, points_start: u64) -> Result<Option<String>> {
    if table_position(file, points_start)?.is_some() {
        return Ok(None);
    }
    let stated = stated_at(file, points_start)?;
    Ok(match u64::try_from(stated) {
        Ok(position) => (position > points_start).then(|| format!("at byte {position}")),
        Err(_) => Some("by the last 8 bytes".to_string()),
    })
}

/// The position of the chunk table, read from before the points or, if the writer could not seek back, from
/// the end of the file. `None` if neither position lies between the points and the end of the file.
pub(crate) fn table_position(file: &FileView, points_start: u64) -> Result<Option<u64>> {
    let start = points_start + TABLE_POSITION_LEN;
    for at in [points_start, file.len().saturating_sub(TABLE_POSITION_LEN)] {
        if let Ok(position) = u64::try_from(stated_at(file, at)?)
            && (start..file.len().saturating_sub(7)).contains(&position)
        {
            return Ok(Some(position));
        }
    }
    Ok(None)
}

/// The position stated at a byte; negative if its writer could not seek back.
fn stated_at(file: &FileView, at: u64) -> Result<i64> {
    let mut bytes = [0; TABLE_POSITION_LEN as usize];
    file.read_at(at, &mut bytes)
        .map_err(|e| Error::io("reading the position of the chunk table", e).at(format!("byte {at}")))?;
    Ok(i64::from_le_bytes(bytes))
}
