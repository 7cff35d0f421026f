//! Audit of Delaunay diagrams of four dimensions, and of simplicial complexes that claim to be Delaunay.
//!
//! # Why the checks are enough
//! A *cell* is the convex hull of its vertices, which are on a sphere, so each of them is a corner. A *ridge*
//! is a face of two dimensions.
//!
//! *The facets of a cell are known.* What a cell shares with a neighbour spans a hyperplane, and all other
//! vertices of the cell are strictly on one side: so it is a facet, with all its corners. No facet is
//! missing. Two facets of a polytope share a ridge exactly if they share three vertices, since no three
//! points of a sphere are on a line, and a ridge of k vertices has k edges. So if k different edges of each
//! ridge are shared with other ridges of a facet, the ridges found are closed under adjacency in the border
//! of the facet. That border is connected, so they are all ridges of the facet. Then the facets found are
//! closed under adjacency in the border of the cell, and are all facets of the cell.
//!
//! *The cells cover a star.* Every facet belongs to two cells on opposite sides of it that name each other,
//! or to one cell and an infinite one, and then it is on the *boundary*. Let `o` be a point in no hyperplane
//! of a facet, strictly inside of the hyperplane of every facet of the boundary, and inside of one cell only.
//! Along a ray from `o` that meets no ridge, as almost all do, the number of cells around is 1 at first and 0
//! far away. It does not change at facets between two cells, and decreases by one at facets of the boundary,
//! which the ray crosses outwards only. So the ray crosses one of them, and the number is 1 before and 0
//! after: no two cells overlap, and the cells cover a solid that is a star around `o`. In particular no facet
//! belongs to a third cell, and near a point inside of a ridge of the boundary are exactly two facets of the
//! boundary, because these cover the directions from `o` once.
//!
//! *The star is convex.* An infinite cell has one neighbour for each ridge of its facet, and shares exactly
//! that ridge with it: the facets of these two cells are the two facets of the boundary at the ridge. No
//! vertex of a neighbour lies beyond the hyperplane of the facet. If the solid were not convex, a segment
//! between two of its inner points would leave it, also after any small change of these points, and the plane
//! through them and `o` would avoid all edges of the boundary. The plane cuts a polygon from the solid that
//! is a star around `o`, so simple, and whose corners are in ridges of the boundary. None of the corners is
//! concave; but a simple polygon without a concave corner is convex. So the cells tile the convex hull of the
//! points, all of which are vertices.
//!
//! *It is the Delaunay diagram.* Lift the points to the paraboloid. The lifts of the vertices of a cell are
//! in a hyperplane, which is the graph of a function on the cell. Cells that share a facet agree there, so
//! the functions of all cells make one function on the hull: two cells at any point are linked by a path near
//! it that crosses facets only. At a facet between two cells the function is strictly convex, because
//! vertices of one cell that are not on the facet are outside of the sphere of the other. (One vertex is
//! enough: the difference of the two powers is linear, and zero on the facet.) So the function is convex
//! along almost all segments, hence everywhere. Its graph is the lower hull of the lifts, and the cells are
//! where it is linear.
//!
//! Let a point be on or inside of the sphere of a cell. Its lift is on or below the hyperplane of the cell.
//! Outside of the cell, that hyperplane is below the function, which has the height of the lift at every
//! given point. So the point is in the cell and on the sphere, hence at a corner; and since points are
//! distinct, it is that vertex. So spheres are empty, each cell has all points of its sphere, and there are
//! no other cells.
//!
//! *Infinite cells.* Each facet of the boundary has one, with its neighbours across ridges. The order of
//! cells is canonical, so no other diagram of the points passes.
//!
//! Euler's relation follows. It is checked as a test of the audit itself.

mod cells;
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
use spmesh_stream::model::cells4::{Cells4, Point4};

/// Counts of what was proved.
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
    /// Geometric tests: one per cell and per facet, each for all vertices concerned.
    pub questions: u64,
    /// Geometric tests that needed big integers.
    pub exactly: u64,
}

/// Proves that cells are the Delaunay diagram of points, in canonical order, with infinite cells and
/// neighbours.
///
/// Domain: any points and cells, however wrong. If all points lie in a hyperplane the diagram has no cells.
///
/// Cost: per cell, the number of incidences of its vertices with its facets times the facets at a vertex;
/// 128-bit arithmetic where coordinates have up to 20 bits relative to each other, a filter and big integers
/// elsewhere.
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
        form::check_euler(&proof)?;
    }
    Ok(proof)
}
