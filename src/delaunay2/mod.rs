//! The bulk kernel in 2D: the canonical Delaunay triangulation of an array of points.
//!
//! Divide and conquer (Guibas and Stolfi, "Primitives for the manipulation of general subdivisions and the
//! computation of Voronoi diagrams", 1985) with alternating cuts (Dwyer, 1987). The points are put in Morton order,
//! copied, and divided along the Morton trie: `divide` has the recursion, `merge` the stitching, `edges` the data
//! structure, `extract` what comes out.

mod distinct;
mod divide;
mod edges;
mod extract;
mod merge;
mod triangulation;

pub use distinct::distinct;
pub use triangulation::{Corner, NONE, Triangulation};

use crate::error::{Error, Result};
use crate::huge_pages;
use crate::order::MortonOrder;
use crate::predicates::{Arithmetic, Extent, Point2, PredicateCounts, lexicographic};
use edges::EdgeMemory;

/// Greatest number of points: corners of triangles, up to six per point, are numbered in 32 bits.
pub const MAX_POINTS: usize = 700_000_000;

/// The kernel with its buffers. One that is used again touches no new page: faster than a fresh one.
#[derive(Debug, Default)]
pub struct Kernel {
    order: MortonOrder,
    /// Morton keys of the distinct points, in Morton order.
    keys: Vec<u64>,
    /// Input indices of the distinct points, in Morton order.
    indices: Vec<u32>,
    /// The distinct points, in Morton order.
    points: Vec<Point2>,
    edges: EdgeMemory,
    /// For each distinct point, a triangle at it.
    triangle_at: Vec<u32>,
    counts: PredicateCounts,
}

impl Kernel {
    /// A kernel without buffers yet.
    #[must_use]
    pub fn new() -> Kernel {
        Kernel::default()
    }

    /// Triangulates `points` into `triangulation`, whose buffers are reused.
    ///
    /// Domain: finite coordinates, up to [`MAX_POINTS`] points, in any order. Equal points are one vertex, the one
    /// of least index; the others are listed in [`Triangulation::duplicates`]. Degenerate input of every kind is
    /// fine: cocircular points are triangulated canonically, and collinear points give no triangles.
    ///
    /// Errors: a coordinate that is not finite, too many points.
    ///
    /// Cost: O(n) expected for points that are spread evenly, O(n) per level at worst, of which there are at most 96;
    /// about 160 bytes per point in the kernel and 52 in the triangulation.
    pub fn triangulate(&mut self, points: &[Point2], triangulation: &mut Triangulation) -> Result<()> {
        if points.len() > MAX_POINTS {
            return Err(Error::usage(format!(
                "{} points in one piece, the kernel takes at most {MAX_POINTS}",
                points.len()
            )));
        }
        let extent = Extent::of(points);
        if !extent.finite {
            let bad = points.iter().position(|p| !p.iter().all(|c| c.is_finite())).unwrap_or_default();
            return Err(Error::malformed(format!("coordinate is not finite: {:?}", points[bad]))
                .at(format!("point {bad}")));
        }
        triangulation.clear();
        self.take_sorted(points, &extent, &mut triangulation.duplicates);
        let mut edges = self.edges.edges(self.points.len());
        let division = divide::Division { points: &self.points, keys: &self.keys, edges: &mut edges };
        let hull = Arithmetic::of(&extent).run(&extent, division, &mut self.counts);
        extract::Extraction {
            points: &self.points,
            indices: &self.indices,
            edges: &mut edges,
            triangle_at: &mut self.triangle_at,
        }
        .run(hull, points.len(), triangulation);
        Ok(())
    }

    /// Decisions of the predicates in all triangulations of this kernel so far.
    #[must_use]
    pub fn counts(&self) -> &PredicateCounts {
        &self.counts
    }

    /// Fills `keys`, `indices` and `points` with the distinct points in Morton order.
    fn take_sorted(&mut self, points: &[Point2], extent: &Extent, duplicates: &mut Vec<[u32; 2]>) {
        huge_pages::reserve(&mut self.keys, points.len());
        huge_pages::reserve(&mut self.indices, points.len());
        huge_pages::reserve(&mut self.points, points.len());
        for item in self.order.sort(points, extent) {
            let point = points[item.index as usize];
            if self.keys.last() == Some(&item.key)
                && self.points.last().is_some_and(|&last| lexicographic(last, point).is_eq())
            {
                duplicates.push([item.index, self.indices[self.indices.len() - 1]]);
                continue;
            }
            self.keys.push(item.key);
            self.indices.push(item.index);
            self.points.push(point);
        }
    }
}

/// Canonical Delaunay triangulation of `points` with a kernel of its own; see [`Kernel::triangulate`].
pub fn triangulate(points: &[Point2]) -> Result<Triangulation> {
    let mut triangulation = Triangulation::default();
    Kernel::new().triangulate(points, &mut triangulation)?;
    Ok(triangulation)
}
