//! Polygons of mesh formats, as triangles.

use std::collections::VecDeque;

use spmesh_base::error::{Error, Result};

/// The triangles of a polygon, around its first vertex.
pub(crate) fn fan(corners: &[u64]) -> Result<VecDeque<[u64; 3]>> {
    match corners {
        [first, rest @ ..] if rest.len() >= 2 => {
            Ok(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]).collect())
        }
        _ => Err(Error::malformed(format!("face of {} vertices, expected at least 3", corners.len()))),
    }
}
