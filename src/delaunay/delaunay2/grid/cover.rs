//! The triangles of cells, and those around nodes without a point.

use super::axes::{Axes, Frame};
use super::quads::{EVEN_JOINED, ODD_JOINED, Quad, count, has, long_side, side};
use crate::delaunay2::half_edge::{HalfEdge, NONE, WORDS, number_of};
use crate::predicates::{Point2, Predicates2, Sign, WithPredicates2};

/// Triangles are numbered in strips of this many columns, so that those of neighbouring cells are near each
/// other.
const STRIP: usize = 64;

/// Bits of a cell in [`Cover::quads`]; those of the quadrangle around the node are above.
const CELL_BITS: u32 = 4;
const CELL: u8 = (1 << CELL_BITS) - 1;

/// The nodes of a grid, and one more on each side, and what is covered. A node stands for the cell at its
/// upper right, too.
///
/// Corners of a cell are numbered counterclockwise from the lower left; neighbours of a node from that on the
/// right.
#[derive(Debug, Default)]
pub(super) struct Cover {
    /// Nodes in a row.
    pub(super) width: usize,
    /// The point at each node, or `NONE`.
    pub(super) points: Vec<u32>,
    /// The triangles of each cell, and those around each node without a point.
    quads: Vec<u8>,
    /// Number of the first triangle of each node.
    first: Vec<u32>,
}

impl Cover {
    /// Puts each point on its node.
    pub(super) fn place(
        &mut self,
        points: &[Point2],
        axes: &Axes,
        frame: Frame,
        duplicates: &mut Vec<[u32; 2]>,
    ) {
        let [columns, rows] = axes.counts();
        self.width = columns + 2;
        let nodes = self.width * (rows + 2);
        self.points.clear();
        self.points.resize(nodes, NONE);
        for (index, &point) in (0..).zip(points) {
            let [column, row] = axes.node(point, frame);
            let at = &mut self.points[(row + 1) * self.width + column + 1];
            if *at == NONE {
                *at = index;
            } else {
                duplicates.push([index, *at]);
            }
        }
    }

    /// Nodes whose neighbours are nodes: all but those that were added in the first and the last row.
    pub(super) fn inner(&self) -> std::ops::Range<usize> {
        self.width..self.points.len() - self.width
    }

    #[inline(always)]
    fn corners(&self, cell: usize) -> [usize; 4] {
        [cell, cell + 1, cell + self.width + 1, cell + self.width]
    }

    #[inline(always)]
    pub(super) fn neighbours(&self, node: usize) -> [usize; 4] {
        [node + 1, node + self.width, node - 1, node - self.width]
    }

    /// The cells around a node: at its upper right first, counterclockwise.
    #[inline(always)]
    fn cells(&self, node: usize) -> [usize; 4] {
        [node, node - 1, node - 1 - self.width, node - self.width]
    }

    /// Finds the triangles of all cells.
    pub(super) fn find_cells(&mut self, frame: Frame) {
        // Which corner has the greatest rank: x is greatest at the upper right, or, in a grid that is turned,
        // at the lower right.
        let full = match frame {
            Frame::Straight => ODD_JOINED,
            Frame::Diagonal => EVEN_JOINED,
        };
        let quad_of = [0, 0, 0, 0, 0, 0, 0, 1 << 1, 0, 0, 0, 1 << 0, 0, 1 << 3, 1 << 2, full];
        self.quads.clear();
        self.quads.resize(self.points.len(), 0);
        let is_point = |node: usize| usize::from(self.points[node] != NONE);
        for row in 0..self.points.len() / self.width - 1 {
            let mut right = 0;
            for cell in row * self.width..(row + 1) * self.width - 1 {
                // Corners 0 and 3 were 1 and 2 of the cell before.
                let left = right >> 1 & 1 | (right & 1 << 2) << 1;
                right = is_point(cell + 1) << 1 | is_point(cell + 1 + self.width) << 2;
                self.quads[cell] = quad_of[left | right];
            }
        }
    }

    /// Finds the triangles around nodes without a point.
    pub(super) fn quadrangles<'a>(&'a mut self, coordinates: &'a [Point2]) -> Quadrangles<'a> {
        Quadrangles { cover: self, coordinates }
    }

    /// Whether a node has a point, or is in a quadrangle.
    #[inline(always)]
    fn is_solid(&self, node: usize) -> bool {
        self.points[node] != NONE || self.quads[node] > CELL
    }

    /// Whether a node has a point with something around it that is not covered.
    pub(super) fn is_open(&self, node: usize) -> bool {
        self.points[node] != NONE && !self.neighbours(node).into_iter().all(|n| self.is_solid(n))
    }

    #[inline(always)]
    fn cell(&self, cell: usize) -> Quad {
        self.quads[cell] & CELL
    }

    /// The triangles around a node without a point, and their first word.
    #[inline(always)]
    fn quadrangle(&self, node: usize) -> (Quad, HalfEdge) {
        (self.quads[node] >> CELL_BITS, (self.first[node] + count(self.cell(node))) * WORDS as u32)
    }

    /// The half-edge of a side of a cell, or `NONE`.
    #[inline(always)]
    fn side(&self, cell: usize, i: usize) -> HalfEdge {
        match side(self.cell(cell), i) {
            NONE => NONE,
            at => self.first[cell] * WORDS as u32 + at,
        }
    }

    /// The half-edge of a diagonal of a cell, on the side of corner k, or `NONE`.
    #[inline(always)]
    fn diagonal(&self, cell: usize, k: usize) -> HalfEdge {
        let quad = self.cell(cell);
        if has(quad, k) {
            return self.first[cell] * WORDS as u32 + long_side(quad, k);
        }
        let (quad, first) = self.quadrangle(self.corners(cell)[k]);
        match side(quad, k) {
            NONE => NONE,
            at => first + at,
        }
    }

    /// The half-edge from node `u` to node `v` in a covered triangle, or `NONE`.
    pub(super) fn half_edge(&self, u: usize, v: usize) -> HalfEdge {
        let width = self.width as isize;
        match v as isize - u as isize {
            1 => self.side(u, 0),
            step if step == width => self.side(u - 1, 1),
            -1 => self.side(v - self.width, 2),
            step if step == -width => self.side(v, 3),
            step if step == width + 1 => self.diagonal(u, 3),
            step if step == width - 1 => self.diagonal(u - 1, 0),
            step if step == -width - 1 => self.diagonal(v, 1),
            step if step == 1 - width => self.diagonal(v - 1, 2),
            _ => NONE,
        }
    }

    /// Numbers and writes all covered triangles, notes triangles of vertices, and returns how many there are.
    pub(super) fn write(&mut self, words: &mut [u32], triangle_of_vertex: &mut [u32]) -> u32 {
        let rows = self.points.len() / self.width;
        let strips = (0..self.width).step_by(STRIP).flat_map(|start| (0..rows).map(move |row| (row, start)));
        let width = self.width;
        let runs =
            strips.map(move |(row, start)| row * width + start..row * width + width.min(start + STRIP));
        let mut next = 0;
        self.first.clear();
        self.first.resize(self.points.len(), 0);
        for run in runs.clone() {
            for (first, quads) in self.first[run.clone()].iter_mut().zip(&self.quads[run]) {
                *first = next;
                next += quads.count_ones();
            }
        }
        let mut writer = Writer { words, triangle_of_vertex };
        for run in runs {
            for node in run {
                match self.quads[node] {
                    0 => (),
                    ODD_JOINED => self.write_cell(&mut writer, node, ODD_JOINED),
                    EVEN_JOINED => self.write_cell(&mut writer, node, EVEN_JOINED),
                    _ => self.write_any(&mut writer, node),
                }
            }
        }
        next
    }

    /// The half-edges beyond the sides of a cell, or `NONE`.
    #[inline(always)]
    fn beyond_sides(&self, cell: usize) -> [HalfEdge; 4] {
        [
            self.side(cell - self.width, 2),
            self.side(cell + 1, 3),
            self.side(cell + self.width, 0),
            self.side(cell - 1, 1),
        ]
    }

    /// Writes the triangles of a cell that has all corners.
    #[inline(always)]
    fn write_cell(&self, writer: &mut Writer, cell: usize, quad: Quad) {
        let corners = self.corners(cell);
        let first = self.first[cell] * WORDS as u32;
        let sides = self.beyond_sides(cell);
        writer.quad(quad, first, corners.map(|node| self.points[node]), sides, |_| NONE);
        // The first triangle has corner 0. That is enough: a point whose own cell lacks a corner is noted
        // with that cell, with a quadrangle, or with the rest.
        writer.triangle_of_vertex[self.points[cell] as usize] = self.first[cell];
    }

    /// Writes the triangles of a cell and those around its node.
    #[cold]
    #[inline(never)]
    fn write_any(&self, writer: &mut Writer, node: usize) {
        let quad = self.cell(node);
        if quad != 0 {
            let corners = self.corners(node);
            let first = self.first[node] * WORDS as u32;
            let sides = self.beyond_sides(node);
            let beyond = |k| self.diagonal(node, (k + 2) % 4);
            let corners = corners.map(|node| self.points[node]);
            writer.quad(quad, first, corners, sides, beyond);
            writer.note(quad, first, corners);
        }
        let (quad, first) = self.quadrangle(node);
        if quad != 0 {
            let corners = self.neighbours(node);
            let cells = self.cells(node);
            let sides = [0, 1, 2, 3].map(|i| self.diagonal(cells[i], (i + 2) % 4));
            let corners = corners.map(|node| self.points[node]);
            writer.quad(quad, first, corners, sides, |_| NONE);
            writer.note(quad, first, corners);
        }
    }
}

/// Where covered triangles are written.
struct Writer<'a> {
    words: &'a mut [u32],
    triangle_of_vertex: &'a mut [u32],
}

impl Writer<'_> {
    /// Writes the triangles of a quadrangle, from word `first` on, with the half-edges beyond its sides, and
    /// those beyond the long side of a single triangle.
    #[inline(always)]
    fn quad(
        &mut self,
        quad: Quad,
        first: HalfEdge,
        corners: [u32; 4],
        sides: [HalfEdge; 4],
        beyond: impl Fn(usize) -> HalfEdge,
    ) {
        for k in (0..4).filter(|&k| has(quad, k)) {
            let t = first + long_side(quad, k);
            let opposite = (k + 2) % 4;
            let across = if has(quad, opposite) { first + long_side(quad, opposite) } else { beyond(k) };
            let [a, b, c] = [corners[k], corners[(k + 1) % 4], corners[(k + 3) % 4]];
            self.words[t as usize..][..WORDS].copy_from_slice(&[
                a,
                b,
                c,
                0,
                across,
                sides[(k + 3) % 4],
                sides[k],
                0,
            ]);
        }
    }

    /// Notes a triangle for all corners of the triangles of a quadrangle.
    fn note(&mut self, quad: Quad, first: HalfEdge, corners: [u32; 4]) {
        for k in (0..4).filter(|&k| has(quad, k)) {
            for vertex in [corners[k], corners[(k + 1) % 4], corners[(k + 3) % 4]] {
                self.triangle_of_vertex[vertex as usize] = number_of(first + long_side(quad, k));
            }
        }
    }
}

/// The nodes without points whose four neighbours have points.
pub(super) struct Quadrangles<'a> {
    cover: &'a mut Cover,
    coordinates: &'a [Point2],
}

impl WithPredicates2 for Quadrangles<'_> {
    type Output = ();

    fn with(self, predicates: &mut impl Predicates2) {
        let Quadrangles { cover, coordinates } = self;
        for node in cover.inner().filter(|&node| cover.points[node] == NONE) {
            let corners = cover.neighbours(node).map(|neighbour| cover.points[neighbour]);
            if corners.contains(&NONE) {
                continue;
            }
            let [a, b, c, d] = corners.map(|point| coordinates[point as usize]);
            let quad = match predicates.incircle_perturbed(a, b, c, d) {
                Sign::Positive => ODD_JOINED,
                _ => EVEN_JOINED,
            };
            cover.quads[node] |= quad << CELL_BITS;
        }
    }
}
