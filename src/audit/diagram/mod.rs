//! Audit of Delaunay diagrams of four dimensions, and of simplicial complexes that claim to be Delaunay.
//!
//! # Why the checks are enough
//! A *cell* is the convex hull of its vertices, which are on a sphere, so each of them is a corner. A *ridge*
//! is a face of two dimensions.
//!
//! *The facets of a cell are known.* What a cell shares with a neighbour spans a hyperplane, and all other
//! vertices of the cell are strictly on one side: so it is a facet, with all its corners. All facets are
//! there: two facets of a polytope share a ridge exactly if they share three vertices, since no three points
//! of a sphere are on a line; a ridge of k vertices has k edges; so if k different edges of each ridge are
//! shared with other ridges of a facet, the ridges found are closed under adjacency in the border of the
//! facet, which is connected, and are all that the facet has. Then the facets found are closed under
//! adjacency in the border of the cell, and are all that it has.
//!
//! *The cells cover a star.* Every facet belongs to two cells on opposite sides of it that name each other,
//! or to one cell and an infinite one, and then it is on the *boundary*. Let `o` be a point in no hyperplane
//! of a facet, strictly inside of the hyperplane of every facet of the boundary, and inside of one cell only.
//! Along a ray from `o` that meets no ridge, as almost all do, the number of cells around is 1 in the
//! beginning and 0 far away, does not change at facets between two cells, and becomes less by one at facets
//! of the boundary, which it crosses outwards only. So it crosses one of them, and the number is 1 before and
//! 0 after: no two cells overlap, and the cells cover a solid that is a star around `o`. In particular no
//! facet belongs to a third cell, and near a point inside of a ridge of the boundary are exactly two facets
//! of the boundary, because these cover the directions from `o` once.
//!
//! *The star is convex.* An infinite cell has one neighbour for each ridge of its facet, with which it shares
//! exactly that: these are the two. No vertex of a neighbour lies beyond the hyperplane of the facet. If the
//! solid were not convex, a segment between two of its inner points would leave it, also after any small
//! change of these points, and the plane through them and `o` would avoid all edges of the boundary. It cuts
//! a polygon from the solid that is a star around `o`, so simple, and whose corners are in ridges of the
//! boundary. None is concave; but a simple polygon without a concave corner is convex. So the cells tile the
//! convex hull of the points, all of which are vertices.
//!
//! *It is the Delaunay diagram.* Lift the points to the paraboloid. The lifts of the vertices of a cell are
//! in a hyperplane, which is the graph of a function on the cell. Cells that share a facet agree there, so
//! all of these make one function on the hull: two cells at any point are linked by a path near it that
//! crosses facets only. At a facet between two cells the function is strictly convex, because vertices of one
//! cell that are not on the facet are outside of the sphere of the other. (One vertex is enough: the
//! difference of the two powers is linear, and zero on the facet.) So it is convex along almost all segments,
//! hence everywhere, and its graph is the lower hull of the lifts; and the cells are where it is linear. A
//! point on or inside of the sphere of a cell has its lift on or below the hyperplane of the cell, which is
//! below the function outside of the cell, and the function has the lift's height at all points. So it is in
//! the cell and on the sphere, hence at a corner, and points are distinct: it is that vertex. So spheres are
//! empty, each cell has all points of its sphere, and there are no other cells.
//!
//! *Infinite cells* are one for each facet of the boundary of each cell, with their neighbours across ridges.
//! Hence the order of cells being canonical, no other diagram of the points passes.
//!
//! Euler's relation follows. It is checked as a test of the audit itself.

mod cells;
mod count;
mod covering;
mod faces;
mod form;
mod number;
mod simplices;
mod sites;
mod space;
mod stream;
mod violation;

pub use simplices::check_simplices;
pub use stream::StreamAudit;
pub use violation::{Claim, Violation};

use cells::CellsAudit;
use spmesh_model::cells4::{Cells4, Point4};

/// What was proved, in figures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Proof {
    /// Points, which are all vertices.
    pub vertices: usize,
    /// Edges of finite cells, each counted once.
    pub edges: usize,
    /// Ridges of finite cells: faces of two dimensions.
    pub polygons: usize,
    /// Facets of finite cells: faces of three dimensions.
    pub facets: usize,
    /// Finite cells.
    pub cells: usize,
    /// Infinite cells: facets of the boundary.
    pub infinite: usize,
    /// Finite cells that are simplices.
    pub simplices: usize,
    /// Most vertices of a finite cell.
    pub largest: usize,
    /// Questions of geometry that were asked: one per cell and per facet, each with all vertices that matter
    /// there.
    pub questions: u64,
    /// Questions that were left to integers without limit.
    pub exactly: u64,
}

/// Proves that cells are the Delaunay diagram of points, in canonical order, with infinite cells and
/// neighbours.
///
/// Domain: any points and cells, however wrong. If all points lie in a hyperplane the diagram has no cells.
///
/// Cost: per cell, the number of incidences of its vertices with its facets times the facets at a vertex;
/// 128-bit arithmetic where coordinates have up to 20 bits relative to each other, a filter and integers
/// without limit elsewhere.
///
/// Memory: 32 bytes per point; 16 bytes per edge and 24 per polygon of the diagram, at most twice as many.
///
/// # Errors
/// The first violation that was met.
pub fn check(points: &[Point4], cells: &Cells4) -> Result<Proof, Violation> {
    form::check_points(points)?;
    let finite = form::check_cells(points, cells)?;
    if finite > 0 {
        form::check_vertices(points, cells.iter().take(finite).map(|cell| cell.vertices))?;
    }
    let proof = CellsAudit::new(points, cells, finite).check()?;
    if finite > 0 {
        count::check_euler(&proof)?;
    }
    Ok(proof)
}
