//! Exact Delaunay diagrams in four dimensions (thesis 3.6 and 4).
//!
//! The Delaunay diagram has a cell for each empty sphere through points that span space: the convex hull of
//! all points on it. Where many points are cospherical, as those of a grid, it is small and unique, where a
//! triangulation is large and arbitrary. Cells beyond the hull have the faraway point as a vertex, and
//! correspond to the facets of cells on the hull.
//!
//! `sites` makes points ready, `determinant`, `exact` and `side` are the geometry. `simplices` triangulates,
//! `merge` makes cells of what is cospherical; `direct` is the way of the thesis, which does both at once.

mod canonical;
mod determinant;
#[cfg(feature = "experiments")]
mod direct;
mod exact;
mod merge;
mod side;
mod simplices;
mod sites;

use exact::Exactness;
pub use side::orient4d;
use sites::Sites;
use spmesh_core::error::{Error, Result};
use spmesh_core::limits::POINTS4_MAX;
use spmesh_model::cells4::{Cells4, Point4};
use spmesh_model::diagram4::Diagram4;
use std::time::{Duration, Instant};

/// What a run did.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Stats {
    /// Putting points in order.
    pub order: Duration,
    /// Inserting them.
    pub insertion: Duration,
    /// Making cells of simplices.
    pub merge: Duration,
    /// Simplices created, infinite ones included.
    pub created: u64,
    /// In-sphere tests in the search of cavities.
    pub in_sphere_tests: u64,
    /// Finite simplices of the triangulation that cells were made of.
    pub simplices: u64,
    /// Infinite ones.
    pub infinite_simplices: u64,
}

/// How cells are found. The result is the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Route {
    /// Simplices in flat arrays, made into cells at the end.
    #[default]
    Simplices,
    /// Cells as points come, in integers (thesis 3.6.4): slower, for comparison.
    #[cfg(feature = "experiments")]
    Direct,
}

/// The Delaunay diagram of points in any order, which depends on the set of points only.
///
/// Domain: finite coordinates. Of equal points one is a vertex, with the value of the first of them. Signs
/// are exact for all f64: integers that differ by at most 1,180,000 take 128 bits, others integers of any
/// size where rounded values do not tell.
///
/// Cost: proportional to the number of simplices of a triangulation of the cells: 64 bytes each if
/// coordinates are integers that differ by at most 26, otherwise 88.
///
/// # Errors
/// A coordinate that is not finite, too many points; all points in a hyperplane, with the dimension found.
pub fn diagram(points: Vec<Point4>, values: Option<Vec<f64>>) -> Result<(Diagram4, Stats)> {
    diagram_by(Route::default(), points, values)
}

/// [`diagram`] by a route of choice.
///
/// # Errors
/// As `diagram`.
pub fn diagram_by(route: Route, points: Vec<Point4>, values: Option<Vec<f64>>) -> Result<(Diagram4, Stats)> {
    check(&points)?;
    let mut stats = Stats::default();
    let started = Instant::now();
    let (points, values, merged) = sites::distinct(points, values);
    let sites = Sites::new(points);
    let sorting = started.elapsed();
    let cells = match route {
        Route::Simplices => {
            if sites.exactness == Exactness::Small {
                through_simplices::<i32>(&sites, &mut stats)?
            } else {
                through_simplices::<f64>(&sites, &mut stats)?
            }
        }
        #[cfg(feature = "experiments")]
        Route::Direct => direct::cells(&sites, &mut stats)?,
    };
    stats.order += sorting;
    Ok((Diagram4 { points: sites.points, values, merged, cells }, stats))
}

fn through_simplices<C: simplices::Coefficient>(sites: &Sites, stats: &mut Stats) -> Result<Cells4> {
    let complex = simplices::triangulate::<C>(sites, stats)?;
    let started = Instant::now();
    let cells = merge::cells(complex, stats);
    stats.merge = started.elapsed();
    Ok(cells)
}

fn check(points: &[Point4]) -> Result<()> {
    if points.len() as u64 > POINTS4_MAX {
        return Err(Error::usage(format!("{} points, dd4 takes at most {POINTS4_MAX}", points.len())));
    }
    match points.iter().position(|point| !point.iter().all(|x| x.is_finite())) {
        Some(bad) => Err(Error::malformed(format!("coordinate is not finite: {:?}", points[bad]))
            .at(format!("point {bad}"))),
        None => Ok(()),
    }
}
