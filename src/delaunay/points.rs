//! Points by their coordinates.

/// A point of the plane: x, y; both finite. Integer coordinates are stored as integer-valued `f64`.
pub type Point2 = [f64; 2];

/// A point of space: x, y, z; all finite. Integer coordinates are stored as integer-valued `f64`.
pub type Point3 = [f64; 3];

/// Whether all coordinates are finite.
#[inline]
pub fn is_finite<const D: usize>(point: &[f64; D]) -> bool {
    point.iter().all(|coordinate| coordinate.is_finite())
}

/// What has the coordinates of a point, exactly: arrays of `f32`, of `f64` and of integers up to 32 bits, and
/// references to them; with the feature `mint` its points too.
///
/// mint itself makes its points of arrays: `mint::Point2::from(mesh.points()[0])`.
pub trait Coordinates<const D: usize> {
    /// The same point.
    fn coordinates(self) -> [f64; D];
}

// Conversions from other numbers to `f64` by `Into` are exact.
impl<T: Into<f64>, const D: usize> Coordinates<D> for [T; D] {
    fn coordinates(self) -> [f64; D] {
        self.map(T::into)
    }
}

impl<T: Into<f64> + Copy, const D: usize> Coordinates<D> for &[T; D] {
    fn coordinates(self) -> [f64; D] {
        self.map(T::into)
    }
}

#[cfg(feature = "mint")]
impl<T: Into<f64>> Coordinates<2> for mint::Point2<T> {
    fn coordinates(self) -> [f64; 2] {
        [self.x, self.y].map(T::into)
    }
}

#[cfg(feature = "mint")]
impl<T: Into<f64>> Coordinates<3> for mint::Point3<T> {
    fn coordinates(self) -> [f64; 3] {
        [self.x, self.y, self.z].map(T::into)
    }
}

/// Points with coordinates of any type that `f64` represents exactly.
///
/// ```
/// use spmesh_delaunay::{delaunay2, points::points};
///
/// let singles = [[0.1_f32, 0.0], [1.0, 0.0], [0.0, 1.0]];
/// let mesh = delaunay2::triangulate(&points(&singles))?;
/// assert_eq!(mesh.points()[0], [f64::from(0.1_f32), 0.0]);
/// # Ok::<(), spmesh_delaunay::Error>(())
/// ```
pub fn points<P: Coordinates<D>, const D: usize>(items: impl IntoIterator<Item = P>) -> Vec<[f64; D]> {
    items.into_iter().map(P::coordinates).collect()
}

#[cfg(all(test, feature = "mint"))]
mod tests {
    use super::points;

    #[test]
    fn points_of_mint_go_in_and_out() {
        let plane = points([mint::Point2 { x: 0.1_f32, y: 2.0 }]);
        assert_eq!(plane, [[f64::from(0.1_f32), 2.0]]);
        let space = points([mint::Point3 { x: 1, y: 2, z: -3 }]);
        assert_eq!(mint::Point3::from(space[0]), mint::Point3 { x: 1.0, y: 2.0, z: -3.0 });
    }
}
