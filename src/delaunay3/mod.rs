//! The bulk kernel in 3D: the canonical Delaunay tetrahedralization of an array of points.
//!
//! The points are put in order along a Hilbert curve, copied, and inserted one by one, in a few rounds that each go
//! along the curve (`rounds`), so that the next point is near and finds small tetrahedra around it. `complex` is the
//! data structure, `locate` the walk to the next point, `insertion` the search of the cavity, `star` what takes its
//! place, `extract` what comes out.

mod build;
mod complex;
mod dispatch;
mod extract;
mod insertion;
mod lanes;
mod locate;
mod rounds;
mod sight;
mod star;
mod stats;
mod tetrahedralization;
mod tie;

pub use stats::Stats;
pub use tetrahedralization::{Corner, NONE, Tetrahedralization, Tetrahedron, Vertex};

use crate::error::{Error, Result};
use crate::predicates::{
    Arithmetic3, Extent, Point3, PredicateCounts, Predicates3, WithPredicates3, lexicographic,
};
use build::Build;
use complex::Complex;
use insertion::Cavity;
use std::borrow::Cow;
use std::time::Instant;
use tie::EXACT;

/// Greatest number of points: the words of tetrahedra, 8 for each of about 8 per point, are numbered in 32 bits.
pub const MAX_POINTS: usize = 60_000_000;

/// The kernel with its buffers.
#[derive(Debug, Default)]
pub struct Kernel {
    cavity: Cavity,
    counts: PredicateCounts,
    /// Whether the parts of insertions are timed ([`Stats`]), which takes some time itself.
    pub is_timed: bool,
}

impl Kernel {
    /// A kernel without buffers yet.
    #[must_use]
    pub fn new() -> Kernel {
        Kernel::default()
    }

    /// Tetrahedralizes `points` into `mesh`, whose buffers are used again. Points that are given away are freed as soon as
    /// they are copied.
    ///
    /// Domain: finite coordinates, up to [`MAX_POINTS`] points, in any order. Equal points are one vertex, the one of
    /// least index; the others are listed in [`Tetrahedralization::duplicates`]. Degenerate input of every kind is
    /// fine: cospherical points are triangulated canonically, and points in a plane give no tetrahedra.
    ///
    /// Errors: a coordinate that is not finite, too many points; the mesh is as it was then.
    ///
    /// Cost: O(n) for points that are spread evenly in space, about 250 bytes per point.
    pub fn triangulate(&mut self, points: Cow<[Point3]>, mesh: &mut Tetrahedralization) -> Result<()> {
        if points.len() > MAX_POINTS {
            let message =
                format!("{} points in one piece, the kernel takes at most {MAX_POINTS}", points.len());
            return Err(Error::usage(message));
        }
        let extent = Extent::of(&points);
        if !extent.finite {
            let bad = points.iter().position(|p| !p.iter().all(|c| c.is_finite())).unwrap_or_default();
            return Err(Error::malformed(format!("coordinate is not finite: {:?}", points[bad]))
                .at(format!("point {bad}")));
        }
        mesh.clear();
        let started = Instant::now();
        take_sorted(points, &extent, mesh);
        mesh.stats.order = started.elapsed();
        let started = Instant::now();
        // The vertex at infinity.
        mesh.vertices.push(Vertex::default());
        let build = Build {
            infinite_lift: infinite_lift(&extent, mesh.vertices.len()),
            vertices: std::mem::take(&mut mesh.vertices),
            tetrahedra: std::mem::take(&mut mesh.tetrahedra),
            cavity: &mut self.cavity,
            stats: &mut mesh.stats,
            is_timed: self.is_timed,
        };
        let (vertices, tetrahedra) = match Arithmetic3::of(&extent).run(build, &mut self.counts) {
            Ok(mut complex) => {
                mesh.hull_facets = extract::extract(&mut complex);
                (complex.vertices, complex.tetrahedra)
            }
            Err(mut build) => {
                build.vertices.pop();
                (build.vertices, build.tetrahedra)
            }
        };
        (mesh.vertices, mesh.tetrahedra) = (vertices, tetrahedra);
        mesh.stats.insertion = started.elapsed();
        Ok(())
    }

    /// Decisions of the predicates in all runs of this kernel so far.
    #[must_use]
    pub fn counts(&self) -> &PredicateCounts {
        &self.counts
    }
}

impl<'a> WithPredicates3 for Build<'a> {
    type Output = std::result::Result<Complex, Build<'a>>;

    fn with(self, predicates: &mut impl Predicates3) -> Self::Output {
        dispatch::run(self, predicates)
    }
}

/// The lift of the vertex at infinity: of about the size of those of neighbours, so that it does not spoil the bound
/// of the filter.
fn infinite_lift(extent: &Extent<3>, vertices: usize) -> f64 {
    let side = (extent.max_difference() / (vertices as f64).powf(0.4)).clamp(1e-75, 1e75);
    let lift = side * side;
    if extent.integral { lift.round().clamp(1.0, EXACT / 2.0) } else { lift }
}

/// Fills the vertices with the distinct points in order along the curve.
fn take_sorted(points: Cow<[Point3]>, extent: &Extent<3>, mesh: &mut Tetrahedralization) {
    let side = extent.max_difference();
    let scale = 1023.999 / side.max(1e-300);
    let mut keys: Vec<(u64, u32)> = points
        .iter()
        .enumerate()
        .map(|(i, p)| (hilbert([0, 1, 2].map(|k| ((p[k] - extent.lower[k]) * scale) as u32), 10), i as u32))
        .collect();
    keys.sort_unstable_by(|a, b| {
        a.0.cmp(&b.0)
            .then_with(|| lexicographic(points[a.1 as usize], points[b.1 as usize]))
            .then(a.1.cmp(&b.1))
    });
    mesh.vertices.reserve_exact(points.len() + 1);
    for &(_, index) in &keys {
        let at = points[index as usize];
        match mesh.vertices.last() {
            Some(last) if last.at == at => mesh.duplicates.push([index, last.index]),
            _ => mesh.vertices.push(Vertex { at, index, local: 0 }),
        }
    }
}

fn hilbert(mut x: [u32; 3], bits: u32) -> u64 {
    let m = 1u32 << (bits - 1);
    let mut q = m;
    while q > 1 {
        let p = q - 1;
        for i in 0..3 {
            if x[i] & q != 0 {
                x[0] ^= p
            } else {
                let t = (x[0] ^ x[i]) & p;
                x[0] ^= t;
                x[i] ^= t;
            }
        }
        q >>= 1;
    }
    for i in 1..3 {
        x[i] ^= x[i - 1];
    }
    let mut t = 0;
    q = m;
    while q > 1 {
        if x[2] & q != 0 {
            t ^= q - 1;
        }
        q >>= 1;
    }
    let x = x.map(|v| v ^ t);
    let spread = |x: u32| (0..10).fold(0u64, |r, i| r | u64::from(x >> i & 1) << (3 * i));
    spread(x[0]) << 2 | spread(x[1]) << 1 | spread(x[2])
}
