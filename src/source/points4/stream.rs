//! Streams of this project with points of four dimensions.

use super::scan::Supply;
use crate::error::{Error, Result};
use crate::source::origin::Origin;

/// First bytes of a stream, and of its text twin.
pub(super) const MAGICS: [&[u8]; 2] = [b"\x89SPM", b"#spmesh "];

/// The points of the stream in `origin`, for any number of passes.
///
/// # Errors
/// Always: streams hold points of two and three dimensions.
pub(super) fn open(_origin: Origin) -> Result<Supply> {
    Err(Error::malformed(
        "is a spmesh stream, expected points of four dimensions: lines of x y z t, or a volume",
    ))
}
