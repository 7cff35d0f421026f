//! Coordinates as numbers of 32 bits, which are differences from a local origin.

use crate::sink::world::local_origin;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::model::decimal::Decimal;

/// How places in a box become numbers of 32 bits.
pub(crate) struct Floats {
    /// What is subtracted.
    pub(crate) origin: Point,
    /// The box of the differences.
    pub(crate) min: [f32; 3],
    pub(crate) max: [f32; 3],
}

impl Floats {
    /// # Errors
    /// Usage, if the box is too large for 32 bits.
    pub(crate) fn of_box(bounds: &Bounds) -> Result<Self> {
        let mut floats = Floats { origin: local_origin(bounds), min: [0.0; 3], max: [0.0; 3] };
        // Rounding keeps the order, so the corners of the box become those of the differences.
        (floats.min, floats.max) = (floats.of(bounds.min), floats.of(bounds.max));
        let is_finite = floats.min.iter().chain(&floats.max).all(|number| number.is_finite());
        let refusal = || Error::usage("coordinates beyond 3.4e38 do not fit into 32 bits: scale them first");
        is_finite.then_some(floats).ok_or_else(refusal)
    }

    /// The numbers of a place.
    pub(crate) fn of(&self, place: Point) -> [f32; 3] {
        [0, 1, 2].map(|axis| (place[axis] - self.origin[axis]) as f32)
    }

    /// The origin as text; `None` if it is that of the world.
    pub(crate) fn origin_text(&self) -> Option<String> {
        let [x, y, z] = self.origin.map(Decimal);
        (self.origin != [0.0; 3]).then(|| format!("{x} {y} {z}"))
    }

    /// A notice about the rounding, which is at most half the last of 24 binary digits.
    pub(crate) fn notice(&self, format: &str) -> String {
        let greatest = self.min.iter().chain(&self.max).map(|number| number.abs()).fold(0.0, f32::max);
        let most = f64::from(greatest) * f64::from(f32::EPSILON) / 2.0;
        format!("{format} has numbers of 32 bits: coordinates are rounded by at most {most:.1e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn floats(min: Point, max: Point) -> Result<Floats> {
        Floats::of_box(&Bounds { min, max })
    }

    #[test]
    fn origins_have_few_digits_and_are_where_they_help() {
        let origin = |min, max| floats(min, max).unwrap().origin;
        assert_eq!(
            origin([499_000.1, 5e6, 300.0], [499_900.4, 5_000_800.0, 411.0]),
            [499_450.0, 5_000_400.0, 356.0]
        );
        // Degrees.
        assert_eq!(origin([8.51, 47.1, 0.0], [8.53, 47.119, 0.0]), [8.52, 47.11, 0.0]);
        assert_eq!(origin([-3.0, 0.0, 1.0], [5.0, 9.0, 2.0]), [0.0; 3]);
        // A single place is its own origin.
        assert_eq!(origin([1e9 / 3.0; 3], [1e9 / 3.0; 3]), [1e9 / 3.0; 3]);
        assert_eq!(origin([0.0; 3], [0.0; 3]), [0.0; 3]);
    }

    #[test]
    fn coordinates_beyond_32_bits_are_refused() {
        assert!(floats([-1e300; 3], [1e300; 3]).is_err());
        assert!(floats([-f64::MAX; 3], [f64::MAX; 3]).is_err());
        let far = floats([1e300; 3], [1e300; 3]).unwrap();
        assert_eq!(far.of([1e300; 3]), [0.0; 3]);
    }
}
