//! Polygons of mesh formats, as triangles.

use std::collections::VecDeque;

use spmesh_base::error::{Error, Result};

/// Stands for the number -1, which ends a strip and starts another one.
pub(crate) const RESTART: u64 = u64::MAX;

/// The triangles of a polygon, around its first vertex.
pub(crate) fn fan(corners: &[u64]) -> Result<VecDeque<[u64; 3]>> {
    match corners {
        [first, rest @ ..] if rest.len() >= 2 => {
            Ok(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]).collect())
        }
        _ => Err(Error::malformed(format!("face of {} vertices, expected at least 3", corners.len()))),
    }
}

/// The triangles of strips, all with the orientation of the first one. Those with a vertex twice join parts
/// of a strip, and are left out.
pub(crate) fn strips(corners: &[u64]) -> Result<VecDeque<[u64; 3]>> {
    let mut triangles = VecDeque::new();
    for strip in corners.split(|&corner| corner == RESTART).filter(|strip| !strip.is_empty()) {
        if strip.len() < 3 {
            return Err(Error::malformed(format!("strip of {} vertices, expected at least 3", strip.len())));
        }
        for (number, corners) in strip.windows(3).enumerate() {
            let [a, b, c] = [corners[0], corners[1], corners[2]];
            if a != b && b != c && a != c {
                triangles.push_back(if number % 2 == 0 { [a, b, c] } else { [b, a, c] });
            }
        }
    }
    Ok(triangles)
}
