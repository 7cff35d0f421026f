//! Exact Delaunay diagrams in four dimensions (thesis 3.6 and 4).
//!
//! The Delaunay diagram has a cell for each empty sphere through points that span space: the convex hull of
//! all points on the sphere. Where many points are cospherical, as in a grid, the diagram is small and
//! unique, but a triangulation is large and arbitrary. Infinite cells have the faraway point as a vertex;
//! each corresponds to a facet of a finite cell on the hull.
//!
//! `sites` sorts and scales the points. `determinant`, `exact` and `side` compute signs. `simplices`
//! triangulates, and `merge` joins cospherical simplices to cells. `direct`, for experiments, does both at once
//! as the thesis does.

mod canonical;
mod determinant;
mod direct;
mod exact;
mod merge;
mod side;
mod simplices;
mod sites;
mod sweep;

use exact::Exactness;
pub use merge::sort_distinct;
pub use side::orient4d;
use sites::Sites;
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::POINTS4_MAX;
use spmesh_stream::model::cells4::{Cells4, Point4};
use spmesh_stream::model::diagram4::Diagram4;
use std::num::NonZeroUsize;
use std::time::{Duration, Instant};
pub use sweep::{CellSink, Room};

/// Times and counts of a run.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Stats {
    /// Time to sort the points.
    pub order: Duration,
    /// Time to insert them.
    pub insertion: Duration,
    /// Time to join simplices to cells.
    pub merge: Duration,
    /// Simplices created, infinite ones included.
    pub created: u64,
    /// In-sphere tests in the search of cavities.
    pub in_sphere_tests: u64,
    /// Finite simplices of the triangulation that was joined to cells.
    pub simplices: u64,
    /// Infinite simplices of it.
    pub infinite_simplices: u64,
}

/// How cells are found. Every route gives the same result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Route {
    /// Triangulates in flat arrays, then joins simplices to cells.
    #[default]
    Simplices,
    /// Updates the cells with each point, in integers (thesis 3.6.4). Slower; for comparison.
    Direct,
}

/// Computes the Delaunay diagram of points in any order. The result depends on the set of points only.
///
/// Domain: finite coordinates. Equal points become one vertex, with the value of the first of them. Signs are
/// exact for all f64: integers that differ by at most 1,180,000 are computed in 128 bits; other coordinates
/// in big integers where the rounded value is inconclusive.
///
/// Cost: proportional to the number of simplices of a triangulation of the cells: 64 bytes per simplex if
/// coordinates are integers that differ by at most 26, otherwise 88; and then up to 100 while cells are made.
///
/// # Errors
/// Malformed, if a coordinate is not finite. Usage, if there are too many points, or all lie in a hyperplane;
/// the message gives their dimension.
pub fn diagram(points: Vec<Point4>, values: Option<Vec<f64>>) -> Result<(Diagram4, Stats)> {
    diagram_by(Route::default(), NonZeroUsize::MIN, points, values)
}

/// As [`diagram`], by a given route. The result does not depend on the number of threads, which join
/// simplices to cells.
///
/// # Errors
/// As [`diagram`].
pub fn diagram_by(
    route: Route,
    threads: NonZeroUsize,
    points: Vec<Point4>,
    values: Option<Vec<f64>>,
) -> Result<(Diagram4, Stats)> {
    let mut stats = Stats::default();
    let (sites, values, merged) = sites_of(points, values, &mut stats)?;
    let cells = match route {
        Route::Simplices => {
            if sites.exactness == Exactness::Small {
                through_simplices::<i32>(&sites, threads, &mut stats)?
            } else {
                through_simplices::<f64>(&sites, threads, &mut stats)?
            }
        }
        Route::Direct => direct::cells(&sites, &mut stats)?,
    };
    Ok((Diagram4 { points: sites.points, values, merged, cells }, stats))
}

/// As [`diagram`], in stages that fit some room, for more points than would fit memory at once: gives the
/// cells to `sink`, and returns the diagram without them.
///
/// # Errors
/// As [`diagram`], and those of the sink; memory, if the room is too small.
pub fn sweep(
    points: Vec<Point4>,
    values: Option<Vec<f64>>,
    room: Room,
    threads: NonZeroUsize,
    sink: &mut impl CellSink,
) -> Result<(Diagram4, Stats)> {
    let mut stats = Stats::default();
    let (sites, values, merged) = sites_of(points, values, &mut stats)?;
    if sites.exactness == Exactness::Small {
        sweep::cells::<i32>(&sites, room, threads, sink, &mut stats)?;
    } else {
        sweep::cells::<f64>(&sites, room, threads, sink, &mut stats)?;
    }
    Ok((Diagram4 { points: sites.points, values, merged, cells: Cells4::default() }, stats))
}

/// The distinct points, their values, and how many points were merged.
fn sites_of(
    points: Vec<Point4>,
    values: Option<Vec<f64>>,
    stats: &mut Stats,
) -> Result<(Sites, Option<Vec<f64>>, u64)> {
    check(&points)?;
    let started = Instant::now();
    let (points, values, merged) = sites::distinct(points, values);
    let sites = Sites::new(points);
    stats.order += started.elapsed();
    Ok((sites, values, merged))
}

fn through_simplices<C: simplices::Coefficient>(
    sites: &Sites,
    threads: NonZeroUsize,
    stats: &mut Stats,
) -> Result<Cells4> {
    let complex = simplices::triangulate::<C>(sites, stats)?;
    let started = Instant::now();
    let cells = merge::cells(complex, threads, stats);
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
