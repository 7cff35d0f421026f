//! Elevations that files state, against those of points around.

use spmesh_stream::Coordinates;

/// A stated elevation is far from points if it is so much lower or higher than all of those around, in world
/// units, and farther than these are from each other.
const FAR: f64 = 10.0;

/// The same for 0, which many files have for elevations that are not known.
const FAR_ZERO: f64 = 1.0;

/// What to do about elevations that are far from points.
pub const ABOUT_FAR: &str =
    "an elevation of 0 often means that none is known: leave such out (ogr2ogr -dim XY)";

/// Whether a stored elevation is far from points around it, of which the least and the greatest one are
/// given.
pub fn is_far(coordinates: &Coordinates, z: f64, [least, most]: [f64; 2]) -> bool {
    let [z, least, most] = [z, least, most].map(|z| coordinates.to_decimal([0.0, 0.0, z])[2]);
    let limit = if z == 0.0 { FAR_ZERO } else { FAR };
    (least - z).max(z - most) > limit + (most - least)
}
