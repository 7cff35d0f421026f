//! The bulk kernel in 2D: the canonical Delaunay triangulation of an array of points.
//!
//! The points are put in order along a Hilbert curve, copied, and inserted one by one, in a few rounds that
//! each go along the curve ([`Rounds`]), so that the next point is near and finds small triangles around it.
//! `mesh` is the data structure, `locate` the walk to the next point, `insertion` what it changes, `extract`
//! what comes out. Points on the nodes of a grid take a shorter way: `grid`.

mod build;
mod distinct;
mod extract;
mod grid;
mod half_edge;
mod insert;
mod insertion;
pub mod interpolation;
mod line;
mod locate;
mod mesh;
mod nearest;
mod star;
mod triangles;
mod triangulation;
mod voronoi;

pub use distinct::distinct;
pub use half_edge::NONE;
pub use triangles::{Corner, Triangle, Triangles};
pub use triangulation::Triangulation;

use crate::error::{Error, Result};
use crate::order::{Curve, Rounds, sort_in};
use crate::points::is_finite;
use crate::predicates::{Arithmetic, Extent, Point2, PredicateCounts};
use crate::watch::Watch;
use build::Build;
use extract::Extraction;
use grid::Grid;
use insertion::Cavity;
use line::OffLine;
use mesh::INFINITE;
use std::num::NonZeroUsize;
use std::sync::Arc;

/// Greatest number of points: the words of triangles, 16 per point, are numbered in 32 bits.
pub const MAX_POINTS: usize = 268_000_000;
const _: () = assert!(16 * (MAX_POINTS + 2) < u32::MAX as usize);

/// The kernel with its buffers. A kernel that is used again touches no new memory pages, which makes it
/// faster than a new one.
#[derive(Debug, Default)]
pub struct Kernel {
    inserter: Inserter,
    grid: Grid,
    counts: PredicateCounts,
    /// Who is told how far the kernel is, and may stop it.
    pub watch: Option<Arc<Watch>>,
}

/// What triangulates by insertion, with its buffers.
#[derive(Debug, Default)]
struct Inserter {
    /// Input index of each vertex.
    indices: Vec<u32>,
    /// The vertices: one at infinity, then the distinct points, in order along the curve.
    points: Vec<Point2>,
    /// The vertices in the order of insertion; afterwards, for each vertex, a triangle at it.
    sequence: Vec<u32>,
    cavity: Cavity,
}

impl Kernel {
    /// A kernel without buffers yet.
    pub fn new() -> Kernel {
        Kernel::default()
    }

    /// Triangulates `points` into `triangles`, whose buffers are reused.
    ///
    /// Domain: finite coordinates, up to [`MAX_POINTS`] points, in any order. Equal points are one vertex,
    /// the one of least index; the others are listed in [`Triangles::duplicates`]. Degenerate input of every
    /// kind is fine: cocircular points are triangulated canonically, and collinear points give no triangles.
    ///
    /// # Errors
    /// Malformed, if a coordinate is not finite; usage, if there are too many points. `triangles` is
    /// unchanged then. Stopped, by [`Kernel::watch`]: `triangles` are empty then.
    ///
    /// Cost: O(n) for points that are spread evenly, or clustered evenly; about 24 bytes per point in the
    /// kernel and 68 in the triangles.
    pub fn triangulate(&mut self, points: &[Point2], triangles: &mut Triangles) -> Result<()> {
        if points.len() > MAX_POINTS {
            return Err(Error::TooManyPoints { count: points.len(), most: MAX_POINTS });
        }
        let extent = Extent::of(points);
        if !extent.finite {
            let bad = points.iter().position(|point| !is_finite(point)).unwrap_or_default();
            return Err(Error::not_finite(bad, &points[bad]));
        }
        triangles.clear();
        let arithmetic = Arithmetic::of(&extent);
        if arithmetic.run(OffLine { points }, &mut self.counts).is_none() {
            line::extract(points, triangles);
            return Ok(());
        }
        if self.grid.find(points, arithmetic, &mut self.counts, &mut triangles.duplicates) {
            let (rest, of_rest) = self.grid.rest();
            of_rest.clear();
            let watch = self.watch.as_deref();
            self.inserter.triangulate(rest, &Extent::of(rest), &mut self.counts, of_rest, watch)?;
            self.grid.finish(points.len(), triangles);
        } else {
            let watch = self.watch.as_deref();
            self.inserter.triangulate(points, &extent, &mut self.counts, triangles, watch)?;
        }
        Ok(())
    }

    /// Decisions of the predicates in all triangulations of this kernel so far.
    pub fn counts(&self) -> &PredicateCounts {
        &self.counts
    }
}

impl Inserter {
    /// Triangulates points that are not all on one line, by insertion. `triangles` are empty.
    fn triangulate(
        &mut self,
        points: &[Point2],
        extent: &Extent,
        counts: &mut PredicateCounts,
        triangles: &mut Triangles,
        watch: Option<&Watch>,
    ) -> Result<()> {
        // The order is found in the memory of the triangles, which are not there yet.
        let memory = &mut triangles.memory.allocate(points.len() + 1)[..4 * points.len()];
        self.take_sorted(bytemuck::cast_slice_mut(memory), points, extent, &mut triangles.duplicates);
        self.sequence.clear();
        self.sequence.reserve_exact(self.points.len() - 1);
        self.sequence.extend(Rounds::in_windows(self.points.len() - 1).map(|place| place + 1));
        let build = Build {
            points: &self.points,
            memory: triangles.memory.allocate(self.points.len()),
            sequence: &self.sequence,
            cavity: &mut self.cavity,
            watch,
        };
        let mesh = Arithmetic::of(extent).run(build, counts).expect("points off a line");
        if let Err(stopped) = Watch::check(watch) {
            triangles.clear();
            return Err(stopped);
        }
        let extraction = Extraction {
            mesh,
            indices: &self.indices,
            triangle_at: &mut self.sequence,
            hull: &mut triangles.hull,
            triangle_of_vertex: &mut triangles.triangle_of_vertex,
        };
        let count = extraction.run(points.len());
        triangles.memory.set_count(count);
        Ok(())
    }

    /// Fills `indices` and `points` with the distinct points in order along the curve, after the vertex at
    /// infinity.
    fn take_sorted(
        &mut self,
        memory: &mut [u64],
        points: &[Point2],
        extent: &Extent,
        duplicates: &mut Vec<[u32; 2]>,
    ) {
        const _: () = assert!(INFINITE == 0);
        self.indices.clear();
        self.indices.reserve_exact(points.len() + 1);
        self.points.clear();
        self.points.reserve_exact(points.len() + 1);
        self.indices.push(NONE);
        self.points.push([f64::NAN; 2]);
        let mut last = ([f64::NAN; 2], NONE);
        for index in sort_in(memory, NonZeroUsize::MIN, points, extent, Curve::Hilbert) {
            let point = points[index as usize];
            if point == last.0 {
                duplicates.push([index, last.1]);
                continue;
            }
            last = (point, index);
            self.indices.push(index);
            self.points.push(point);
        }
    }
}

/// Canonical Delaunay triangulation of `points`, whose vertices are indices of `points`.
///
/// Equal points are one vertex, the one of least index. Points on one line, or fewer than three different
/// points, have no triangles. A program that triangulates many sets uses a [`Kernel`], which reuses its
/// buffers.
///
/// # Errors
/// Malformed, if a coordinate is not finite; usage, if there are more than [`MAX_POINTS`] points.
///
/// Cost: O(n) for points that are spread evenly. Memory: about 108 bytes per point, 84 of them in the result.
///
/// ```
/// use spmesh_delaunay::Location;
/// use spmesh_delaunay::delaunay2::triangulate;
///
/// let square = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
/// let mesh = triangulate(&square)?;
/// assert_eq!(mesh.simplices().count(), 2);
/// assert_eq!(mesh.edges().len(), 5);
/// assert_eq!(mesh.hull().count(), 4);
/// assert_eq!(mesh.locate([4.0, 4.0]), Location::Vertex(2));
/// assert_eq!(mesh.locate([1.0, 0.0]), Location::Edge([0, 1]));
/// assert_eq!(mesh.locate([5.0, 1.0]), Location::Outside);
/// # Ok::<(), spmesh_delaunay::Error>(())
/// ```
pub fn triangulate(points: &[Point2]) -> Result<Triangulation> {
    Triangulation::by(&mut Kernel::new(), points.to_vec())
}
