//! A tree of boxes that finds the elements near a point, and the lines of the domain near it.
//!
//! Each inner node halves its cell at the median of the elements in it, so that clusters make the tree deeper
//! instead of its lists longer. Leaves list all elements whose hulls meet their cell. A search starts from a
//! node that a grid over the box yields; where knots are evenly spread, that node is near the leaves.

use super::domain::{Domain, is_right_or_on};
use spmesh_delaunay::predicates::{FiniteFloatPredicates, Point2, Predicates2, Sign};

/// Cells with at most this number of elements are not halved.
const FEW: usize = 6;
/// A cut is rejected if a half would keep more than this part of the elements.
const SHARE_MAX: f64 = 0.9;
/// Levels of the tree, at most.
const LEVELS_MAX: usize = 48;
/// Entries of lists per element, at most: a cut cannot separate elements that meet in one knot.
const ENTRIES_MAX: usize = 48;
/// Bound of the rounding error of an orientation, relative to the magnitude of its products.
const MARGIN: f64 = 16.0 * f64::EPSILON;

/// Cells in a row of the grid, at most.
const SIDE_MAX: usize = 1024;
/// Rounding moves points by less than this part of a grid cell.
const BORDER: f64 = 1.0 / (1 << 20) as f64;

/// The axis of a node that is a leaf.
const LEAF: u32 = 2;

/// A convex polygon, by its box and its edges.
pub(super) struct Hull {
    pub(super) lower: Point2,
    pub(super) upper: Point2,
    pub(super) edges: Vec<[Point2; 2]>,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    /// For an inner node, the bits of the coordinate of the cut; for a leaf, start and end of its list of
    /// elements.
    data: u64,
    axis: u32,
    /// The first of two children, or the number of the leaf.
    next: u32,
}

impl Node {
    /// A node that is still to be replaced: by an inner node, or by [`Tree::close`].
    const OPEN: Node = Node { data: 0, axis: LEAF, next: 0 };

    #[inline(always)]
    fn cut(&self) -> f64 {
        f64::from_bits(self.data)
    }

    #[inline(always)]
    fn elements(&self) -> std::ops::Range<usize> {
        (self.data >> 32) as usize..self.data as u32 as usize
    }
}

/// The lines of a leaf, and whether it is outside of the domain.
#[derive(Debug, Clone, Copy, Default)]
struct Leaf {
    lines: [u32; 2],
    is_outside: bool,
}

/// The tree, and the lists of all leaves.
#[derive(Debug, Clone)]
pub(super) struct Tree {
    lower: Point2,
    upper: Point2,
    /// Cells in a row of the grid, and grid cells per unit along each axis.
    side: usize,
    scale: [f64; 2],
    /// The node to start from, for each cell of the grid.
    starts: Vec<u32>,
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    elements: Vec<u32>,
    lines: Vec<u32>,
}

/// A cell that may yet be halved.
struct Cell {
    node: usize,
    lower: Point2,
    upper: Point2,
    elements: Vec<u32>,
    lines: Vec<u32>,
    /// Whether it is left of some line of the domain.
    is_outside: bool,
}

/// How a cell is halved: the axis, the place of the cut, and the elements below and above it.
struct Halves {
    axis: usize,
    cut: f64,
    elements: [Vec<u32>; 2],
}

/// The hulls and the domain that the tree is built from.
struct TreeInput<'a> {
    hulls: &'a [Hull],
    domain: &'a Domain,
}

impl Tree {
    /// A tree over the box from `lower` to `upper`.
    pub(super) fn new(hulls: &[Hull], domain: &Domain, lower: Point2, upper: Point2) -> Tree {
        let mut tree = Tree::empty(lower, upper);
        tree.nodes.push(Node::OPEN);
        let (elements, lines) = ((0..hulls.len() as u32).collect(), (0..domain.lines.len() as u32).collect());
        let mut root = Cell { node: 0, lower, upper, elements, lines, is_outside: domain.is_empty };
        root.keep_lines(domain);
        tree.grow(&TreeInput { hulls, domain }, root, ENTRIES_MAX * (hulls.len() + FEW), 0);
        tree.set_grid();
        tree
    }

    fn empty(lower: Point2, upper: Point2) -> Tree {
        let (nodes, leaves, elements) = (Vec::new(), Vec::new(), Vec::new());
        let (starts, lines) = (vec![0], Vec::new());
        Tree { lower, upper, side: 1, scale: [0.0; 2], starts, nodes, leaves, elements, lines }
    }

    /// Sets the grid, with about half as many cells as there are leaves.
    fn set_grid(&mut self) {
        self.side = ((self.leaves.len() as f64 / 2.0).sqrt() as usize).clamp(1, SIDE_MAX);
        self.scale = [0, 1].map(|axis| self.side as f64 / (self.upper[axis] - self.lower[axis]));
        self.starts =
            (0..self.side * self.side).map(|at| self.start([at % self.side, at / self.side])).collect();
    }

    /// The deepest node whose cell contains a cell of the grid, with a margin for rounding.
    fn start(&self, place: [usize; 2]) -> u32 {
        let range = |axis: usize| {
            let (lower, step) = (self.lower[axis], 1.0 / self.scale[axis]);
            let border = BORDER * step + 8.0 * f64::EPSILON * lower.abs().max(self.upper[axis].abs());
            let from = lower + place[axis] as f64 * step;
            [from - border, from + step + border]
        };
        let ranges = [range(0), range(1)];
        let mut at = 0;
        loop {
            let node = self.nodes[at];
            match ranges.get(node.axis as usize) {
                Some(&[_, end]) if end < node.cut() => at = node.next as usize,
                Some(&[from, _]) if from >= node.cut() => at = node.next as usize + 1,
                _ => return at as u32,
            }
        }
    }

    /// The elements that may contain a point; none if it is outside of the box.
    #[inline]
    pub(super) fn elements(&self, x: Point2) -> &[u32] {
        self.leaf(x).map_or(&[], |leaf| &self.elements[leaf.elements()])
    }

    /// The lines of the domain that a point may be left of; `None` if it is certainly outside of the domain.
    #[inline]
    pub(super) fn lines(&self, x: Point2) -> Option<&[u32]> {
        let leaf = self.leaves[self.leaf(x)?.next as usize];
        let [start, end] = leaf.lines.map(|at| at as usize);
        (!leaf.is_outside).then(|| &self.lines[start..end])
    }

    #[inline(always)]
    fn leaf(&self, x: Point2) -> Option<Node> {
        if !(0..2).all(|axis| self.lower[axis] <= x[axis] && x[axis] <= self.upper[axis]) {
            return None;
        }
        let place = |axis: usize| {
            let cells = (x[axis] - self.lower[axis]) * self.scale[axis];
            (cells as usize).min(self.side - 1)
        };
        let start = self.starts[place(1) * self.side + place(0)];
        let mut node = self.nodes[start as usize];
        while node.axis != LEAF {
            let is_upper = x[node.axis as usize] >= node.cut();
            node = self.nodes[node.next as usize + usize::from(is_upper)];
        }
        Some(node)
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        let lists = 4 * (self.elements.len() + self.lines.len() + self.starts.len());
        lists + std::mem::size_of_val(&self.nodes[..]) + std::mem::size_of_val(&self.leaves[..])
    }

    /// Builds the nodes of a cell; the lists of its leaves have at most `entries_max` entries in total.
    fn grow(&mut self, input: &TreeInput, cell: Cell, entries_max: usize, level: usize) {
        let halves = if level < LEVELS_MAX { cell.halves(input.hulls) } else { None };
        let Some(Halves { axis, cut, elements }) = halves else { return self.close(cell) };
        let counts = [elements[0].len(), elements[1].len()];
        if counts[0] + counts[1] > entries_max {
            return self.close(cell);
        }
        let next = self.nodes.len();
        self.nodes[cell.node] = Node { data: cut.to_bits(), axis: axis as u32, next: next as u32 };
        self.nodes.extend([Node::OPEN; 2]);
        let parts = elements.into_iter().enumerate().map(|(half, elements)| {
            let (mut lower, mut upper) = (cell.lower, cell.upper);
            if half == 0 {
                upper[axis] = cut
            } else {
                lower[axis] = cut
            }
            let (lines, is_outside) = (cell.lines.clone(), cell.is_outside);
            Cell { node: next + half, lower, upper, elements, lines, is_outside }
        });
        let parts: Vec<Cell> = parts.collect();
        drop(cell);
        for mut part in parts {
            part.keep_lines(input.domain);
            let share = entries_max as f64 * part.elements.len() as f64 / (counts[0] + counts[1]) as f64;
            self.grow(input, part, share as usize, level + 1);
        }
    }

    fn close(&mut self, cell: Cell) {
        let [elements, lines] = [self.elements.len(), self.lines.len()];
        self.elements.extend_from_slice(&cell.elements);
        self.lines.extend_from_slice(&cell.lines);
        let data = (elements as u64) << 32 | self.elements.len() as u64;
        self.nodes[cell.node] = Node { data, axis: LEAF, next: self.leaves.len() as u32 };
        let lines = [lines as u32, self.lines.len() as u32];
        self.leaves.push(Leaf { lines, is_outside: cell.is_outside });
    }
}

impl Cell {
    /// Drops the lines that the cell is entirely to the right of. If the cell is entirely left of a line, it
    /// drops all lines.
    fn keep_lines(&mut self, domain: &Domain) {
        if self.is_outside {
            self.lines.clear();
            return;
        }
        let corners = self.corners();
        let is_beyond = |&[p, q]: &[Point2; 2]| {
            let mut predicates = FiniteFloatPredicates::default();
            corners.iter().all(|&corner| predicates.orient2d(p, q, corner) == Sign::Positive)
        };
        self.lines.retain(|&line| {
            let line = domain.lines[line as usize];
            !corners.iter().all(|&corner| is_right_or_on(line, corner))
        });
        self.is_outside = self.lines.iter().any(|&line| is_beyond(&domain.lines[line as usize]));
        if self.is_outside {
            self.lines.clear();
        }
    }

    fn corners(&self) -> [Point2; 4] {
        let ([x, y], [right, top]) = (self.lower, self.upper);
        [[x, y], [right, y], [right, top], [x, top]]
    }

    /// How to halve the cell; `None` if halving it does not pay.
    fn halves(&self, hulls: &[Hull]) -> Option<Halves> {
        if self.elements.len() <= FEW {
            return None;
        }
        let mut cuts = [0, 1].map(|axis| {
            let cut = self.cut(hulls, axis);
            let crosses = |&&at: &&u32| hulls[at as usize].side(axis, cut).is_none();
            (self.elements.iter().filter(crosses).count(), axis, cut)
        });
        cuts.sort_unstable_by_key(|&(crossed, axis, _)| (crossed, axis));
        let greatest = (SHARE_MAX * self.elements.len() as f64) as usize;
        cuts.into_iter().find_map(|(_, axis, cut)| {
            let is_inside = self.lower[axis] < cut && cut < self.upper[axis];
            let halves = is_inside.then(|| self.divided(hulls, axis, cut))?;
            halves.elements.iter().all(|half| half.len() <= greatest).then_some(halves)
        })
    }

    /// The median of the middles of the parts of elements in the cell.
    fn cut(&self, hulls: &[Hull], axis: usize) -> f64 {
        let middle = |&at: &u32| {
            let hull = &hulls[at as usize];
            hull.lower[axis].max(self.lower[axis]).midpoint(hull.upper[axis].min(self.upper[axis]))
        };
        let mut middles: Vec<f64> = self.elements.iter().map(middle).collect();
        let half = middles.len() / 2;
        *middles.select_nth_unstable_by(half, f64::total_cmp).1
    }

    fn divided(&self, hulls: &[Hull], axis: usize, cut: f64) -> Halves {
        let (mut below, mut above) = (self.upper, self.lower);
        (below[axis], above[axis]) = (cut, cut);
        let mut elements = [Vec::new(), Vec::new()];
        for &at in &self.elements {
            let hull = &hulls[at as usize];
            // An element entirely on one side of the cut belongs to that half only.
            match hull.side(axis, cut) {
                Some(half) => elements[half].push(at),
                None => {
                    elements[0].extend(hull.meets(self.lower, below).then_some(at));
                    elements[1].extend(hull.meets(above, self.upper).then_some(at));
                }
            }
        }
        Halves { axis, cut, elements }
    }
}

impl Hull {
    /// The side of a cut that the hull is on: 0 below, 1 above; `None` if it meets the cut.
    #[inline]
    fn side(&self, axis: usize, cut: f64) -> Option<usize> {
        match (self.upper[axis] < cut, self.lower[axis] > cut) {
            (true, _) => Some(0),
            (_, true) => Some(1),
            _ => None,
        }
    }

    /// Whether the hull may meet a box: true if it does, and sometimes if it does not.
    fn meets(&self, lower: Point2, upper: Point2) -> bool {
        let is_apart = |axis: usize| self.upper[axis] < lower[axis] || upper[axis] < self.lower[axis];
        if is_apart(0) || is_apart(1) {
            return false;
        }
        !self.edges.iter().any(|edge| {
            let [[ax, ay], [bx, by]] = *edge;
            // The corner that is furthest to the left of the edge.
            let x = if by > ay { lower[0] } else { upper[0] };
            let y = if bx > ax { upper[1] } else { lower[1] };
            let (left, right) = ((bx - ax) * (y - ay), (by - ay) * (x - ax));
            left - right < -MARGIN * (left.abs() + right.abs())
        })
    }
}
