//! The output of the kernel: flat arrays, and questions to them, answered in indices of input points.

use super::stats::Stats;
use crate::location::Location;
use crate::predicates::{FiniteFloatPredicates3, Point3, Predicates3, Sign};
use crate::simplex::TETRAHEDRON_FACETS;
use crate::starts::Starts;
use crate::walk::{self, Arrival, Walkable};
use bytemuck::{Pod, Zeroable};
use std::num::NonZeroUsize;
use std::sync::OnceLock;

/// No tetrahedron: beyond a facet of the hull.
pub const NONE: u32 = u32::MAX;

/// A corner of a tetrahedron; it stands for the facet opposite to it, too.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Corner {
    /// Index of the tetrahedron.
    pub tetrahedron: u32,
    /// 0, 1, 2 or 3.
    pub corner: u32,
}

/// A vertex: half a cache line.
#[derive(Debug, Clone, Copy, Default)]
#[repr(C, align(32))]
pub struct Vertex {
    /// Where it is.
    pub at: Point3,
    /// Index of the input point.
    pub index: u32,
    unused: u32,
}

// SAFETY: zero is a value of every field.
unsafe impl Zeroable for Vertex {}
// SAFETY: all fields are numbers, and they fill it: nothing is padding.
unsafe impl Pod for Vertex {}

impl Vertex {
    /// The input point of this index.
    #[inline(always)]
    pub fn new(at: Point3, index: u32) -> Vertex {
        Vertex { at, index, unused: 0 }
    }
}

/// A tetrahedron with its neighbours: half a cache line.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub struct Tetrahedron {
    /// Indices of its vertices a, b, c, d, such that det(b - a, c - a, d - a) > 0.
    pub vertices: [u32; 4],
    /// The neighbouring facets opposite to the vertices, as words of the array of tetrahedra.
    pub(super) neighbours: [u32; 4],
}

// SAFETY: zero is a value of every field.
unsafe impl Zeroable for Tetrahedron {}
// SAFETY: all fields are numbers, and they fill it: nothing is padding.
unsafe impl Pod for Tetrahedron {}

pub(super) const WORDS: usize = size_of::<Tetrahedron>() / size_of::<u32>();

impl Tetrahedron {
    /// A tetrahedron made elsewhere, with what is across from each corner.
    pub fn new(vertices: [u32; 4], neighbours: [Option<Corner>; 4]) -> Tetrahedron {
        let word = |corner: Corner| corner.tetrahedron * WORDS as u32 + corner.corner;
        Tetrahedron { vertices, neighbours: neighbours.map(|corner| corner.map_or(NONE, word)) }
    }

    /// The neighbour across the facet opposite to corner `side`, as its corner opposite to that facet; `None`
    /// at the hull.
    ///
    /// # Panics
    /// If `side` is above 3.
    #[inline]
    pub fn neighbour(&self, side: usize) -> Option<Corner> {
        let word = self.neighbours[side];
        (word != NONE).then_some(Corner { tetrahedron: word / WORDS as u32, corner: word & 3 })
    }
}

/// A Delaunay tetrahedralization.
///
/// [`Tetrahedralization::tetrahedra`] and [`Tetrahedralization::vertices`] are the arrays of the kernel, in
/// which a tetrahedron names its vertices by their places in the array of vertices. All other methods speak
/// of indices of input points, like those of [`Triangulation`](crate::delaunay2::Triangulation).
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Tetrahedralization {
    pub(super) vertices: Vec<Vertex>,
    pub(super) tetrahedra: Vec<Tetrahedron>,
    /// Of walks, found when they are needed first.
    pub(super) starts: OnceLock<Starts<3>>,
    /// Input points left out because an equal one of lesser index is there: `[duplicate, the other]`.
    pub duplicates: Vec<[u32; 2]>,
    /// Input points whose cell in the power diagram is empty, so that they are in no tetrahedron: with
    /// weights only, and unknown if there are no tetrahedra. They are vertices still.
    pub hidden: Vec<u32>,
    /// Number of facets of the hull.
    pub hull_facets: usize,
    /// Work and time that it took.
    pub stats: Stats,
}

impl Tetrahedralization {
    /// A tetrahedralization made elsewhere, without stats.
    pub fn from_parts(
        vertices: Vec<Vertex>,
        duplicates: Vec<[u32; 2]>,
        tetrahedra: Vec<Tetrahedron>,
    ) -> Tetrahedralization {
        let sides = tetrahedra.iter().flat_map(|tetrahedron| tetrahedron.neighbours);
        let hull_facets = sides.filter(|&neighbour| neighbour == NONE).count();
        Tetrahedralization {
            vertices,
            tetrahedra,
            duplicates,
            starts: OnceLock::new(),
            hidden: Vec::new(),
            hull_facets,
            stats: Stats::default(),
        }
    }

    /// The vertices, which are the distinct points, in order along a curve.
    #[inline]
    pub fn vertices(&self) -> &[Vertex] {
        &self.vertices
    }

    /// All tetrahedra, about in the order of the curve. None if all points lie in a plane.
    #[inline]
    pub fn tetrahedra(&self) -> &[Tetrahedron] {
        &self.tetrahedra
    }

    /// Empties everything, keeping the memory.
    pub(super) fn clear(&mut self) {
        self.vertices.clear();
        self.tetrahedra.clear();
        self.starts = OnceLock::new();
        self.duplicates.clear();
        self.hidden.clear();
        self.hull_facets = 0;
        self.stats = Stats::default();
    }
}

impl Tetrahedralization {
    fn input_indices<const N: usize>(&self, vertices: [u32; N]) -> [u32; N] {
        vertices.map(|v| self.vertices[v as usize].index)
    }

    /// The tetrahedra by the indices of their points, positively oriented. Their numbers are those of
    /// [`Tetrahedralization::neighbours`].
    pub fn simplices(&self) -> impl ExactSizeIterator<Item = [u32; 4]> + '_ {
        self.tetrahedra.iter().map(|tetrahedron| self.input_indices(tetrahedron.vertices))
    }

    /// The tetrahedra across the facets opposite to the four vertices of tetrahedron `number`; `None` at the
    /// hull.
    ///
    /// # Panics
    /// If there is no such tetrahedron.
    pub fn neighbours(&self, number: u32) -> [Option<u32>; 4] {
        let tetrahedron = &self.tetrahedra[number as usize];
        [0, 1, 2, 3].map(|side| tetrahedron.neighbour(side).map(|corner| corner.tetrahedron))
    }

    /// The edges of all tetrahedra, each once with its lesser point first, in increasing order.
    ///
    /// Cost: a sort of six edges per tetrahedron.
    pub fn edges(&self) -> Vec<[u32; 2]> {
        let sides = |[a, b, c, d]: [u32; 4]| [[a, b], [a, c], [a, d], [b, c], [b, d], [c, d]];
        let mut edges: Vec<[u32; 2]> =
            self.simplices().flat_map(sides).map(|[a, b]| [a.min(b), a.max(b)]).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// The facets of the hull, counterclockwise as seen from outside; none if there are no tetrahedra.
    pub fn hull(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        let open = |tetrahedron: &Tetrahedron, side: usize| tetrahedron.neighbour(side).is_none();
        self.tetrahedra.iter().flat_map(move |tetrahedron| {
            let sides = (0..4).filter(move |&side| open(tetrahedron, side));
            sides.map(|side| self.input_indices(TETRAHEDRON_FACETS[side].map(|i| tetrahedron.vertices[i])))
        })
    }

    /// For each input point the one that stands for it: the equal point of least index.
    pub fn representatives(&self) -> Vec<u32> {
        let count = self.vertices.len() + self.duplicates.len();
        let mut representatives: Vec<u32> = (0..count as u32).collect();
        self.duplicates.iter().for_each(|&[point, vertex]| representatives[point as usize] = vertex);
        representatives
    }

    /// Where `target` lies: exactly. A target with a coordinate that is not finite is outside.
    ///
    /// If there are no tetrahedra, every target that is no vertex is outside.
    ///
    /// Cost: a walk of O(cbrt n) tetrahedra for points that are spread evenly; without tetrahedra, O(n).
    pub fn locate(&self, target: Point3) -> Location {
        self.locate_from(target, 0)
    }

    /// [`Tetrahedralization::locate`] by a walk that begins at tetrahedron `start`: short, if that is near,
    /// such as the one that [`Starts`] find. Any number will do.
    pub fn locate_from(&self, target: Point3, start: u32) -> Location {
        match walk::walk(self, start, target, &mut FiniteFloatPredicates3::default()) {
            Some(Arrival::Inside(number, sides)) => {
                let vertices = self.input_indices(self.tetrahedra[number as usize].vertices);
                Location::in_simplex(number, vertices, sides)
            }
            Some(Arrival::Outside(..)) => Location::Outside,
            None => {
                let is_there = |vertex: &&Vertex| self.tetrahedra.is_empty() && vertex.at == target;
                let found = self.vertices.iter().find(is_there);
                found.map_or(Location::Outside, |vertex| Location::Vertex(vertex.index))
            }
        }
    }

    /// For each target the number of the tetrahedron that contains it, its border included: the least, if
    /// there are several. [`NONE`] for targets that are outside, or not finite.
    ///
    /// The targets are asked for in order along a curve, in blocks, on so many threads; the answers do not
    /// depend on them.
    ///
    /// Cost: O(log m) for each of m targets that are spread as the points are, to put it in order.
    pub fn locate_all(&self, targets: &[Point3], threads: NonZeroUsize) -> Vec<u32> {
        walk::find_all(self, targets, threads, NONE)
    }
}

impl Walkable<3, 4> for Tetrahedralization {
    type Predicates = FiniteFloatPredicates3;

    fn simplices_len(&self) -> usize {
        self.tetrahedra.len()
    }

    fn start_near(&self, target: Point3) -> u32 {
        self.starts().near(target)
    }

    #[inline]
    fn side(
        &self,
        number: u32,
        corner: usize,
        target: Point3,
        predicates: &mut FiniteFloatPredicates3,
    ) -> Sign {
        let tetrahedron = &self.tetrahedra[number as usize];
        let [a, b, c] =
            TETRAHEDRON_FACETS[corner].map(|i| self.vertices[tetrahedron.vertices[i] as usize].at);
        predicates.orient3d(target, a, b, c)
    }

    #[inline]
    fn across(&self, number: u32, corner: usize) -> Option<u32> {
        self.tetrahedra[number as usize].neighbour(corner).map(|corner| corner.tetrahedron)
    }
}
