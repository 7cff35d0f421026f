//! Points in files of nothing but numbers: x, y and z of one point after the other.

use std::path::Path;

use crate::raw::number::RawType;
use crate::source::cut::Cut;
use crate::source::origin::FileView;
use crate::source::pass::Content;
use crate::source::point_arrays::{self, Place, PointArray};
use crate::text::numbers::Writing;
use spmesh_base::error::{Error, Result};

/// Whether a file of raw numbers is compressed, by its name: raw numbers may start with any bytes.
pub(crate) fn is_compressed(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("gz"))
}

/// The whole file as an array of points; without the last bytes if it ends within a point and is to be
/// salvaged.
pub(crate) fn open(view: &FileView, kind: RawType, is_salvaged: bool) -> Result<Content> {
    let point_len = 3 * kind.sample.len() as u64;
    let (len, points) = (view.len(), view.len() / point_len);
    if len == 0 {
        return Err(Error::malformed("empty: found no point"));
    }
    let is_cut = len > points * point_len;
    if is_cut && !(is_salvaged && points > 0) {
        let rest = len - points * point_len;
        let message = format!(
            "the file ends {rest} bytes into a point, which has {point_len} bytes of type {kind}: it was cut \
             off, or the type is another"
        );
        return Err(Error::malformed(message).at(format!("point {} at byte {}", points + 1, len - rest)));
    }
    let array = PointArray {
        piece: None,
        points,
        components: 3,
        sample: kind.sample,
        writing: Writing::Binary(kind.order),
        place: Place::Plain { start: 0, end: points * point_len },
        is_exact: true,
        data: Vec::new(),
    };
    let cut = is_cut.then_some(Cut { read: points, lost: None });
    Ok(Content { cut, ..point_arrays::content(vec![array]) })
}
