//! The floating-point 3D Delaunay program of the thesis, for experiments: fast, and wrong where rounding
//! matters.
//!
//! Points are inserted one by one (Bowyer, 1981; Watson, 1981). Every tetrahedron keeps the equation of its
//! sphere, so that an in-sphere test is a dot product (`sphere`); the next point is located by a remembering
//! stochastic walk that takes orientations from the values of spheres (`locate`, thesis 3.4.2); the vertex at
//! infinity is the only sentinel, and a point on a sphere is taken to be inside (`insertion`, thesis 4.4).
//! Bit levels and an order along a curve keep walks short and rounding small (`insertion`, thesis 3.4.1).
//!
//! All arithmetic is that of `f64`, except where the first four points are chosen and where signs are
//! checked. Coordinates that are integers of at most 10 bits are triangulated without error. With others the
//! result may not be Delaunay, but its tetrahedra always fit together: a point whose insertion would break
//! that is left out, and counted.

mod cavity;
pub mod check;
mod insertion;
mod locate;
mod mesh;
mod phase_timer;
mod search;
pub mod sphere;
pub mod star;

use std::time::Instant;

pub use check::violations;
use insertion::{Sorted, State};
pub use phase_timer::{Seconds, Stats};
use spmesh_delaunay::delaunay3::Tetrahedralization;
use spmesh_delaunay::order::{Curve, Sequence};
use spmesh_delaunay::predicates::{Extent, Point3};
use spmesh_delaunay::{Error, Result};

/// Greatest number of points.
pub const MAX_POINTS: usize = 60_000_000;

/// Tetrahedralizes `points` in rounded arithmetic.
///
/// Domain: finite coordinates, up to [`MAX_POINTS`] points, in any order. Equal points are one vertex, the
/// one of least index. Points that all lie in a plane give no tetrahedra. The result is about Delaunay if the
/// extent is between 1e-35 and 1e35: products of eight coordinates, or of five with other options, over- or
/// underflow beyond, and points are left out.
///
/// # Errors
/// If a coordinate is not finite, or there are too many points or tetrahedra.
///
/// Cost: O(n) for points that are spread evenly, apart from the sort; 580 to 730 bytes per point, 310 to 390
/// if spheres are not kept.
pub fn triangulate(points: &[Point3], options: &Options) -> Result<(Tetrahedralization, Stats)> {
    if points.len() > MAX_POINTS {
        return Err(Error::TooManyPoints { count: points.len(), most: MAX_POINTS });
    }
    let extent = Extent::of(points);
    if !extent.finite {
        let bad = points.iter().position(|p| !p.iter().all(|c| c.is_finite())).unwrap_or_default();
        return Err(Error::not_finite(bad, &points[bad]));
    }
    let begin = Instant::now();
    let Sorted { vertices, duplicates, insertions } = insertion::sort(points, &extent, options);
    let order = begin.elapsed().as_secs_f64();
    let (tetrahedra, mut stats) = match check::first_tetrahedron(&vertices, insertions.clone()) {
        Some(first) => State::new(&vertices, options, first).run(insertions)?,
        None => (Vec::new(), Stats { missing: vertices.len() as u64, ..Stats::default() }),
    };
    stats.seconds.order = order;
    Ok((Tetrahedralization::from_parts(vertices, duplicates, tetrahedra), stats))
}

/// Options of [`triangulate`].
#[derive(Debug, Clone, Copy)]
pub struct Options {
    /// The curve along which points are stored and inserted.
    pub curve: Curve,
    /// In which sequence they are inserted, within each level.
    pub sequence: Sequence,
    /// Whether points that have more low bits in common are inserted first.
    pub by_bit_levels: bool,
    /// Seed of the choices in walks.
    pub seed: u64,
    /// Whether every in-sphere test is compared with the exact sign: many times slower.
    pub check_signs: bool,
    /// Whether sphere equations are kept; they are computed for each test if not.
    pub cache_spheres: bool,
    /// Whether a walk takes orientations from the values of two spheres, not from determinants.
    pub orientation_from_spheres: bool,
}

/// The program of the thesis.
impl Default for Options {
    fn default() -> Options {
        Options {
            curve: Curve::Hilbert,
            sequence: Sequence::Pass,
            by_bit_levels: true,
            seed: 1,
            check_signs: false,
            cache_spheres: true,
            orientation_from_spheres: true,
        }
    }
}
