//! The floating-point 3D Delaunay program of the thesis, for experiments: fast, and wrong where rounding matters.
//!
//! Points are inserted one by one (Bowyer, 1981; Watson, 1981). Every tetrahedron keeps the equation of its sphere, so
//! that an in-sphere test is a dot product (`sphere`); the next point is located by a remembering stochastic walk that
//! takes orientations from the values of spheres (`locate`, thesis 3.4.2); the vertex at infinity is the only sentinel,
//! and a point on a sphere is taken to be inside (`insertion`, thesis 4.4). Bit levels and an order along a curve keep
//! walks short and rounding small (`sequence`, thesis 3.4.1).
//!
//! All arithmetic is that of `f64`, except where the first four points are chosen and where signs are checked. Coordinates
//! that are integers of at most 10 bits are triangulated without error. With others the result may not be Delaunay, but
//! its tetrahedra always fit together: a point whose insertion would break that is left out, and counted.

mod cavity;
mod check;
mod edges;
mod insertion;
mod locate;
mod mesh;
mod phase_timer;
mod sequence;
mod sphere;
mod star;

use crate::delaunay3::Tetrahedralization;
use crate::order::{Curve, Sequence};
use crate::predicates::{Extent, Point3};
use insertion::Insertion;
use sequence::Sorted;
use spmesh_core::error::{Error, Result};
use std::time::Instant;

/// Greatest number of points.
pub const MAX_POINTS: usize = 60_000_000;

/// How [`triangulate`] goes about it.
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

/// What a run did.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Stats {
    /// Tetrahedra created, infinite ones included.
    pub created: u64,
    /// Points tested against spheres, or against planes of the hull.
    pub in_sphere_tests: u64,
    /// Points tested against planes of facets in walks.
    pub orientation_tests: u64,
    /// Tetrahedra that walks stepped into.
    pub walk_steps: u64,
    /// In-sphere tests whose sign was wrong where the exact one is not zero. Only if signs are checked, like the next two.
    pub wrong_signs: u64,
    /// In-sphere tests whose exact value is zero, and the computed one is not.
    pub wrong_zeros: u64,
    /// In-sphere tests whose value was not the exact one. Known only of points with integer coordinates that differ by
    /// less than 2^23.
    pub rounded: u64,
    /// Orientations from spheres that were zero, so that the side was chosen at random.
    pub random_sides: u64,
    /// Walks that began again, elsewhere.
    pub restarts: u64,
    /// Points that rounding left in a tetrahedron but outside of its sphere: they were taken to be inside.
    pub forced: u64,
    /// Times that a cavity was changed so that the point sees all of its facets.
    pub repairs: u64,
    /// Distinct points that are no vertex of any tetrahedron: they were left out, or lost. If all points lie in a plane,
    /// these are all.
    pub missing: u64,
    /// Where the time went.
    pub seconds: Seconds,
    /// Memory in use at the end, the result not included.
    pub bytes: u64,
}

/// Seconds by part of the work. Those of the last three are shares, known from a sample, of the time for all insertions.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Seconds {
    /// Levels, order along the curve, removal of duplicates.
    pub order: f64,
    /// Walks, their tests included.
    pub locate: f64,
    /// Search of the cavity by in-sphere tests, and the equations of new spheres.
    pub predicates: f64,
    /// Linking and writing new tetrahedra.
    pub update: f64,
    /// Reading out the result.
    pub extract: f64,
}

/// Tetrahedralizes `points` in rounded arithmetic.
///
/// Domain: finite coordinates, up to [`MAX_POINTS`] points, in any order. Equal points are one vertex, the one of least
/// index. Points that all lie in a plane give no tetrahedra. The result is about Delaunay if the extent is between 1e-35
/// and 1e35: products of eight coordinates, or of five with other options, over- or underflow beyond, and points are left
/// out.
///
/// Errors: a coordinate that is not finite, too many points or tetrahedra.
///
/// Cost: O(n) for points that are spread evenly, apart from the sort; 580 to 730 bytes per point, 310 to 390 if spheres are not kept.
pub fn triangulate(points: &[Point3], options: &Options) -> Result<(Tetrahedralization, Stats)> {
    if points.len() > MAX_POINTS {
        return Err(Error::usage(format!(
            "{} points in one piece, floating-point arithmetic takes at most {MAX_POINTS}",
            points.len()
        )));
    }
    let extent = Extent::of(points);
    if !extent.finite {
        let bad = points.iter().position(|p| !p.iter().all(|c| c.is_finite())).unwrap_or_default();
        return Err(Error::malformed(format!("coordinate is not finite: {:?}", points[bad]))
            .at(format!("point {bad}")));
    }
    let begin = Instant::now();
    let Sorted { vertices, duplicates, insertions } = sequence::sort(points, &extent, options);
    let order = begin.elapsed().as_secs_f64();
    let (tetrahedra, mut stats) = match mesh::first_tetrahedron(&vertices, insertions.clone()) {
        Some(first) => Insertion::new(&vertices, options, first).run(insertions)?,
        None => (Vec::new(), Stats { missing: vertices.len() as u64, ..Stats::default() }),
    };
    stats.seconds.order = order;
    Ok((Tetrahedralization::from_parts(vertices, duplicates, tetrahedra), stats))
}
