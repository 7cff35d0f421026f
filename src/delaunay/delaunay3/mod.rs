//! The bulk kernel in 3D: the canonical Delaunay tetrahedralization of an array of points.
//!
//! The points are put in order along a Hilbert curve, copied, and inserted one by one, in a few rounds that
//! each go along the curve ([`Rounds`](crate::order::Rounds)), so that the next point is near and finds small
//! tetrahedra around it. `complex` is the data structure, `locate` the walk to the next point, `insertion`
//! the search of the cavity, `star` what takes its place, `extract` what comes out. With weights the same
//! kernel makes the regular tetrahedralization, dual to the power diagram.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod build;
mod cavity;
mod complex;
mod corners;
mod dispatch;
mod edges;
mod exact;
mod extract;
mod insertion;
mod insphere3;
mod lanes;
mod linear;
mod locate;
mod nearest;
mod parts;
mod search;
mod sorted;
mod star;
mod stars;
mod stats;
#[cfg(test)]
mod tests;
mod tetrahedralization;
mod translated;
mod weights;
mod whole;
mod words;

pub use corners::{CornerParts, Corners, turned};
pub use edges::{EDGES, Ring};
pub use linear::Linear;
pub use stars::Stars;
pub use stats::Stats;
pub use tetrahedralization::{Corner, NONE, Tetrahedralization, Tetrahedron, Vertex};

use crate::error::{Error, Result};
use crate::order::{Curve, Insertions, Places, Sequence, SpatialOrder, Suffixes};
use crate::parallel;
use crate::points::is_finite;
use crate::predicates::{Arithmetic3, Extent, Point3, PredicateCounts, Predicates3, WithPredicates3};
use crate::watch::Watch;
use build::{Build, First};
use exact::EXACT;
use insertion::Buffers;
use std::borrow::Cow;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Instant;
use weights::{Equal, PerVertex, Weights};
use whole::{Setting, TETRAHEDRA_MAX, Tally, Whole};

/// Greatest number of points: the words of tetrahedra, 8 for each of about 8 per point, are numbered in 32
/// bits.
pub const MAX_POINTS: usize = 60_000_000;

/// Least number of points that is worth a thread.
const POINTS_PER_THREAD: usize = 20_000;

/// The kernel with its buffers.
#[derive(Debug)]
pub struct Kernel {
    buffers: Buffers,
    counts: PredicateCounts,
    /// The curve along which points are stored and inserted.
    pub curve: Curve,
    /// In which sequence they are inserted.
    pub sequence: Sequence,
    /// Whether points that have more low bits in common are inserted first (thesis 3.4.1).
    pub by_bit_levels: bool,
    /// How many threads triangulate points without weights. The tetrahedra do not depend on it; their order
    /// does. [`Sequence::Pass`] and bit levels use one thread.
    pub threads: NonZeroUsize,
    /// The least number of points that is worth a thread.
    pub points_per_thread: usize,
    /// Number of tetrahedra, with those at infinity and those that insertions have deleted, from which
    /// [`Kernel::triangulate`] gives up: points on curves have a number that grows with the square of theirs.
    pub tetrahedra_max: usize,
    /// Whether the parts of insertions are timed ([`Stats`]), which takes some time itself.
    pub is_timed: bool,
    /// Who is told how far the kernel is, and may stop it.
    pub watch: Option<Arc<Watch>>,
    /// Whether portable instructions are used only: for tests.
    is_portable: bool,
}

impl Default for Kernel {
    fn default() -> Kernel {
        Kernel {
            buffers: Buffers::default(),
            counts: PredicateCounts::default(),
            curve: Curve::default(),
            sequence: Sequence::default(),
            by_bit_levels: false,
            threads: NonZeroUsize::MIN,
            points_per_thread: POINTS_PER_THREAD,
            tetrahedra_max: TETRAHEDRA_MAX,
            is_timed: false,
            watch: None,
            is_portable: false,
        }
    }
}

impl Kernel {
    /// A kernel without buffers yet.
    pub fn new() -> Kernel {
        Kernel::default()
    }

    /// Tetrahedralizes `points` into `mesh`, whose buffers are reused. Owned points are freed as soon as they
    /// are copied.
    ///
    /// Domain: finite coordinates, up to [`MAX_POINTS`] points, in any order. Equal points are one vertex,
    /// the one of least index; the others are listed in [`Tetrahedralization::duplicates`]. Degenerate input
    /// of every kind is fine: cospherical points are triangulated canonically, and points in a plane give no
    /// tetrahedra.
    ///
    /// # Errors
    /// Malformed, if a coordinate is not finite; usage, if there are too many points: `mesh` is unchanged
    /// then. Stopped, by [`Kernel::watch`]. I/O, if there are more tetrahedra than
    /// [`Kernel::tetrahedra_max`], which even [`MAX_POINTS`] points have only in rare configurations.
    ///
    /// Cost: O(n) for points that are spread evenly in space. Memory: about 250 bytes per point.
    pub fn triangulate(&mut self, points: Cow<[Point3]>, mesh: &mut Tetrahedralization) -> Result<()> {
        let extent = checked_extent(&points, self.threads)?;
        mesh.clear();
        let started = Instant::now();
        self.take_sorted(points, &extent, mesh);
        self.build(&extent, Equal, started, mesh)
    }

    /// The regular tetrahedralization of `points` with `weights`, one for each: dual to the power diagram, in
    /// which the distance of a point x from p is |x - p|^2 less the weight of p. For balls, weights are the
    /// squares of radii.
    ///
    /// Points whose cell is empty are in no tetrahedron: [`Tetrahedralization::hidden`]. Of equal points the
    /// one of greatest weight is the vertex, of these the one of least index. Ties are broken as without
    /// weights; with equal weights the result is that of [`Kernel::triangulate`].
    ///
    /// # Errors
    /// As [`Kernel::triangulate`]; also if a weight is not finite.
    ///
    /// Cost and memory: as without weights, and 8 bytes per point.
    ///
    /// # Panics
    /// If there are more or fewer weights than points.
    pub fn triangulate_weighted(
        &mut self,
        points: Cow<[Point3]>,
        weights: &[f64],
        mesh: &mut Tetrahedralization,
    ) -> Result<()> {
        assert_eq!(points.len(), weights.len(), "a weight for each point");
        let extent = checked_extent(&points, self.threads)?;
        if let Some(bad) = weights.iter().position(|weight| !weight.is_finite()) {
            let found = format!("weight is not finite: {}", weights[bad]);
            return Err(Error::NotFinite { point: bad, found });
        }
        mesh.clear();
        let started = Instant::now();
        self.take_sorted(points, &extent, mesh);
        self.take_heaviest(weights, mesh);
        let of_vertices = mesh.vertices.iter().map(|vertex| weights[vertex.index as usize]).collect();
        self.build(&extent, PerVertex::new(of_vertices), started, mesh)
    }

    /// Tetrahedralizes the vertices, which are in order.
    fn build<W: Weights>(
        &mut self,
        extent: &Extent<3>,
        weights: W,
        started: Instant,
        mesh: &mut Tetrahedralization,
    ) -> Result<()> {
        let insertions = self.insertions(&mesh.vertices);
        mesh.stats.order = started.elapsed();
        let started = Instant::now();
        let arithmetic = Arithmetic3::of(extent);
        let search = First { vertices: &mesh.vertices, insertions: insertions.clone() };
        if let Some(first) = arithmetic.run(search, &mut self.counts) {
            // The vertex at infinity.
            mesh.vertices.push(Vertex::default());
            let setting = Setting {
                infinite_lift: infinite_lift(extent, mesh.vertices.len()),
                weights,
                arithmetic,
                first,
                is_timed: self.is_timed,
                is_portable: self.is_portable,
                watch: self.watch.clone(),
            };
            let (vertices, tetrahedra) = (&mut mesh.vertices, &mut mesh.tetrahedra);
            let (vertices, tetrahedra) = (std::mem::take(vertices), std::mem::take(tetrahedra));
            let mut whole = Whole::new(vertices, tetrahedra, first, self.tetrahedra_max);
            let mut tally = Tally::default();
            let inserted = self.insert_all(&mut whole, &setting, insertions, &mut tally);
            self.counts.merge(&tally.counts);
            if let Err(error) = inserted {
                mesh.clear();
                return Err(error);
            }
            mesh.stats.merge(&tally.stats);
            mesh.stats.created += 5;
            (mesh.vertices, mesh.tetrahedra) = (whole.vertices, whole.tetrahedra);
            mesh.vertices.pop();
            mesh.hull_facets =
                extract::extract(&mut mesh.tetrahedra, mesh.vertices.len() as u32, self.threads)?;
            if !W::ARE_EQUAL {
                list_hidden(mesh);
            }
        }
        mesh.stats.insertion = started.elapsed();
        Ok(())
    }

    /// Fills the vertices with the distinct points in order along the curve.
    fn take_sorted(&self, points: Cow<[Point3]>, extent: &Extent<3>, mesh: &mut Tetrahedralization) {
        let threads = self.threads.min(worthwhile(points.len() / self.points_per_thread.max(1)));
        let mut order = SpatialOrder::default();
        let places = order.sort_on(threads, &points, extent, self.curve);
        // And that at infinity.
        mesh.vertices.reserve_exact(points.len() + 1);
        gather(threads, places, &points, &mut mesh.vertices);
        leave_out_duplicates(mesh);
    }

    /// Makes of equal points the heaviest the vertex.
    fn take_heaviest(&self, weights: &[f64], mesh: &mut Tetrahedralization) {
        // Duplicates are in the order of the vertices that stand for them.
        let mut vertices = mesh.vertices.iter_mut();
        for group in mesh.duplicates.chunk_by_mut(|[_, of], [_, next_of]| of == next_of) {
            let first = group[0][1];
            let vertex = vertices.find(|vertex| vertex.index == first).expect("a vertex for each group");
            let heaviest = group.iter().fold(first, |heaviest, &[index, _]| {
                if weights[index as usize] > weights[heaviest as usize] { index } else { heaviest }
            });
            vertex.index = heaviest;
            for duplicate in group.iter_mut() {
                let index = if duplicate[0] == heaviest { first } else { duplicate[0] };
                *duplicate = [index, heaviest];
            }
        }
    }

    fn insertions(&self, vertices: &[Vertex]) -> Insertions {
        if !self.by_bit_levels {
            return self.sequence.of(vertices.len());
        }
        let points: Vec<Point3> = vertices.iter().map(|vertex| vertex.at).collect();
        self.sequence.by_levels(&points, Suffixes::MostCommon)
    }

    /// Decisions of the predicates in all runs of this kernel so far.
    pub fn counts(&self) -> &PredicateCounts {
        &self.counts
    }
}

/// Canonical Delaunay tetrahedralization of `points`.
///
/// Equal points are one vertex, the one of least index. Points in one plane, or fewer than four different
/// points, have no tetrahedra. A program that tetrahedralizes many sets uses a [`Kernel`], which reuses its
/// buffers.
///
/// # Errors
/// As [`Kernel::triangulate`].
///
/// Cost: O(n) for points that are spread evenly in space. Memory: about 250 bytes per point.
///
/// ```
/// use spmesh_delaunay::Location;
/// use spmesh_delaunay::delaunay3::triangulate;
///
/// let points = [[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0], [0.0, 0.0, 4.0]];
/// let mesh = triangulate(&points)?;
/// assert_eq!(mesh.simplices().count(), 1);
/// assert_eq!(mesh.edges().len(), 6);
/// assert_eq!(mesh.hull().count(), 4);
/// assert_eq!(mesh.representatives()[4], 3);
/// assert_eq!(mesh.locate([1.0, 1.0, 0.0]), Location::Facet([0, 1, 2]));
/// assert_eq!(mesh.locate([0.5, 0.5, 0.5]), Location::Simplex(0));
/// # Ok::<(), spmesh_delaunay::Error>(())
/// ```
pub fn triangulate(points: &[Point3]) -> Result<Tetrahedralization> {
    let mut mesh = Tetrahedralization::default();
    Kernel::new().triangulate(Cow::Borrowed(points), &mut mesh)?;
    Ok(mesh)
}

/// The regular tetrahedralization of `points` with `weights`.
///
/// # Errors
/// As [`Kernel::triangulate_weighted`].
///
/// # Panics
/// If there are more or fewer weights than points.
///
/// ```
/// use spmesh_delaunay::delaunay3::triangulate_weighted;
///
/// let points = [[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0], [1.0, 1.0, 1.0]];
/// assert_eq!(triangulate_weighted(&points, &[0.0; 5])?.simplices().count(), 4);
/// let mesh = triangulate_weighted(&points, &[10.0, 10.0, 10.0, 10.0, 0.0])?;
/// assert_eq!((mesh.simplices().count(), &mesh.hidden[..]), (1, &[4][..]));
/// # Ok::<(), spmesh_delaunay::Error>(())
/// ```
pub fn triangulate_weighted(points: &[Point3], weights: &[f64]) -> Result<Tetrahedralization> {
    let mut mesh = Tetrahedralization::default();
    Kernel::new().triangulate_weighted(Cow::Borrowed(points), weights, &mut mesh)?;
    Ok(mesh)
}

fn checked_extent(points: &[Point3], threads: NonZeroUsize) -> Result<Extent<3>> {
    if points.len() > MAX_POINTS {
        return Err(Error::TooManyPoints { count: points.len(), most: MAX_POINTS });
    }
    let extent = Extent::on(threads, points);
    if !extent.finite {
        let bad = points.iter().position(|point| !is_finite(point)).unwrap_or_default();
        return Err(Error::not_finite(bad, &points[bad]));
    }
    Ok(extent)
}

/// Lists the input points of the vertices that are in no tetrahedron.
fn list_hidden(mesh: &mut Tetrahedralization) {
    let mut is_visible = vec![false; mesh.vertices.len()];
    let corners = mesh.tetrahedra.iter().flat_map(|tetrahedron| tetrahedron.vertices);
    corners.for_each(|v| is_visible[v as usize] = true);
    let all = mesh.vertices.iter().zip(is_visible);
    mesh.hidden.extend(all.filter(|(_, is_visible)| !is_visible).map(|(vertex, _)| vertex.index));
}

impl<W: Weights> WithPredicates3 for Build<'_, '_, W> {
    type Output = ();

    fn with(self, predicates: &mut impl Predicates3) {
        dispatch::run(self, predicates);
    }
}

/// So many threads, one at least.
fn worthwhile(threads: usize) -> NonZeroUsize {
    NonZeroUsize::new(threads).unwrap_or(NonZeroUsize::MIN)
}

/// Adds the points in this order; there is room for them.
fn gather(threads: NonZeroUsize, places: Places<'_>, points: &[Point3], vertices: &mut Vec<Vertex>) {
    let share = points.len().div_ceil(threads.get()).max(1);
    let room = &mut vertices.spare_capacity_mut()[..points.len()];
    let shares = room.chunks_mut(share).zip(places.chunks(share));
    parallel::for_each(threads, shares, |(room, places)| {
        for (vertex, index) in room.iter_mut().zip(places) {
            vertex.write(Vertex::new(points[index as usize], index));
        }
    });
    // SAFETY: each place has been written: there are as many as points.
    unsafe { vertices.set_len(vertices.len() + points.len()) };
}

/// Leaves the first of equal vertices, which follow each other, and lists the others.
fn leave_out_duplicates(mesh: &mut Tetrahedralization) {
    let Tetrahedralization { vertices, duplicates, .. } = mesh;
    vertices.dedup_by(|vertex, first| {
        let is_equal = vertex.at == first.at;
        if is_equal {
            duplicates.push([vertex.index, first.index]);
        }
        is_equal
    });
}

/// The lift of the vertex at infinity: of about the size of those of neighbours, so that it does not spoil
/// the bound of the filter.
fn infinite_lift(extent: &Extent<3>, vertices: usize) -> f64 {
    let side = (extent.max_difference() / (vertices as f64).powf(0.4)).clamp(1e-75, 1e75);
    let lift = side * side;
    if extent.integral { lift.round().clamp(1.0, EXACT / 2.0) } else { lift }
}
