//! Points in files of nothing but numbers: x, y and z of one point after the other.

use std::path::Path;

use super::numbers::Writing;
use super::origin::FileView;
use super::point_arrays::{Place, PointArray};
use super::raw_type::RawType;
use spmesh_core::error::{Error, Result};

/// Whether a file of raw numbers is compressed, by its name: raw numbers may start with any bytes.
pub(super) fn is_compressed(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("gz"))
}

/// The whole file as an array.
///
/// # Errors
/// If the file is empty or ends within a point.
pub(super) fn open(view: &FileView, kind: RawType) -> Result<PointArray> {
    let point_len = 3 * kind.sample.len() as u64;
    let (len, points) = (view.len(), view.len() / point_len);
    if len == 0 {
        return Err(Error::malformed("empty: found no point"));
    }
    if len > points * point_len {
        let rest = len - points * point_len;
        let message = format!(
            "the file ends {rest} bytes into a point, which has {point_len} bytes of type {kind}: it was cut \
             off, or the type is another"
        );
        return Err(Error::malformed(message).at(format!("point {} at byte {}", points + 1, len - rest)));
    }
    Ok(PointArray {
        piece: None,
        points,
        components: 3,
        sample: kind.sample,
        writing: Writing::Binary(kind.order),
        place: Place::Plain { start: 0, end: len },
        is_exact: true,
        data: Vec::new(),
    })
}
