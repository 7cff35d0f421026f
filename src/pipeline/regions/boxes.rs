//! Half-open boxes that divide space such that each has as many Voronoi vertices of a sample, and few Voronoi
//! cells lie in several.

use super::diagram::Diagram;
use spmesh_delaunay::predicates::Point3;
use spmesh_stream::model::bounds::Region;

/// Part of the vertices by which a cut may be off the middle, and cuts that are tried along each axis.
const OFF_MIDDLE: f64 = 0.04;
const CUTS: [f64; 3] = [-OFF_MIDDLE, 0.0, OFF_MIDDLE];

/// A cut that more than this part of the cells lie on both sides of would not make the points of a box fewer.
/// All balls through points on one sphere have one centre.
const CROSSING_MAX: f64 = 0.75;

/// A part of the tree.
#[derive(Debug, Clone, Copy)]
enum Node {
    /// A cut: what is below it is the next node, what is on it or above is another.
    Cut { axis: usize, at: f64, above: u32 },
    /// The number of a box.
    Box(u32),
}

/// Boxes whose last points come in different parts of the input, of so many, are numbered in this order.
const PARTS: f64 = 64.0;

/// A binary tree of boxes, numbered in about the order in which the points of their regions have come, and
/// else from one end to the other: boxes of near numbers are near.
#[derive(Debug)]
pub(crate) struct Boxes {
    nodes: Vec<Node>,
    boxes: Vec<Region<3>>,
    /// The part of the input in which the last of the sample for each comes.
    parts: Vec<u32>,
    /// The Voronoi cells of the sample that reach into boxes, over all of these.
    reaching: usize,
}

/// A closed box.
pub(crate) type Extent = [Point3; 2];

/// What the tree is made of.
struct Making<'d> {
    /// The box of the Voronoi vertices of each cell.
    extents: &'d [Extent],
    /// The part of the input that each cell's point is in.
    parts: &'d [u32],
    tree: Boxes,
}

impl Boxes {
    /// `count` boxes; fewer if centres coincide. Before each point that was given for the diagram came `before`
    /// of all points, as a part of one.
    pub(crate) fn lay(diagram: &Diagram, before: &[f64], count: usize) -> Boxes {
        let extents = extents_of_cells(diagram);
        let parts: Vec<u32> = diagram.given.iter().map(|&at| (PARTS * before[at as usize]) as u32).collect();
        let known = diagram.balls.iter().filter(|ball| ball.error.is_finite());
        let mut centres: Vec<Point3> = known.map(|ball| ball.centre).collect();
        let tree = Boxes { nodes: Vec::new(), boxes: Vec::new(), parts: Vec::new(), reaching: 0 };
        let mut making = Making { extents: &extents, parts: &parts, tree };
        making.divide(&mut centres, (0..extents.len() as u32).collect(), Region::EVERYTHING, count);
        let mut tree = making.tree;
        tree.renumber();
        tree
    }

    /// Notes in the diagram which box has each centre.
    pub(crate) fn place_centres(&self, diagram: &mut Diagram) {
        for ball in &mut diagram.balls {
            let [low, high] = [-ball.error, ball.error].map(|e| ball.centre.map(|x| x + e));
            let (mut met, mut more) = (None, false);
            self.visit([low, high], &mut |number| more |= met.replace(number).is_some());
            ball.place = met.filter(|_| !more);
        }
    }

    /// Numbers the boxes in the order of the parts of the input.
    fn renumber(&mut self) {
        let mut order: Vec<u32> = (0..self.boxes.len() as u32).collect();
        order.sort_by_key(|&number| self.parts[number as usize]);
        self.boxes = order.iter().map(|&number| self.boxes[number as usize]).collect();
        let mut numbers = vec![0; order.len()];
        (0..).zip(&order).for_each(|(new, &old)| numbers[old as usize] = new);
        for node in &mut self.nodes {
            if let Node::Box(number) = node {
                *number = numbers[*number as usize];
            }
        }
    }

    /// Number of boxes.
    pub(crate) fn len(&self) -> usize {
        self.boxes.len()
    }

    /// About how many boxes a point is in, on average.
    pub(crate) fn copies(&self, diagram: &Diagram) -> f64 {
        self.reaching as f64 / diagram.points.len() as f64
    }

    /// The box of this number.
    pub(crate) fn get(&self, number: usize) -> Region<3> {
        self.boxes[number]
    }

    /// Calls `found` with the number of each box that, with its sides, meets a closed box.
    pub(super) fn visit(&self, extent: Extent, found: &mut impl FnMut(u32)) {
        self.visit_from(0, extent, found);
    }

    fn visit_from(&self, node: usize, extent: Extent, found: &mut impl FnMut(u32)) {
        match self.nodes[node] {
            Node::Box(number) => found(number),
            Node::Cut { axis, at, above } => {
                if extent[0][axis] <= at {
                    self.visit_from(node + 1, extent, found);
                }
                if extent[1][axis] >= at {
                    self.visit_from(above as usize, extent, found);
                }
            }
        }
    }
}

impl Making<'_> {
    /// Divides a box with these centres, and these cells that reach into it.
    fn divide(&mut self, centres: &mut [Point3], cells: Vec<u32>, region: Region<3>, count: usize) {
        let below = count / 2;
        let cut = if count > 1 { self.best_cut(centres, &cells, below, count) } else { None };
        let Some((axis, at)) = cut else {
            self.tree.nodes.push(Node::Box(self.tree.boxes.len() as u32));
            self.tree.boxes.push(region);
            let last = cells.iter().map(|&cell| self.parts[cell as usize]).max();
            self.tree.parts.push(last.unwrap_or(0));
            self.tree.reaching += cells.len();
            return;
        };
        let node = self.tree.nodes.len();
        self.tree.nodes.push(Node::Cut { axis, at, above: 0 });
        let middle = partition(centres, |centre| centre[axis] < at);
        let (lower, upper) = centres.split_at_mut(middle);
        let (mut left, mut right) = (region, region);
        (left.max[axis], right.min[axis]) = (at, at);
        let extent = |cell: u32| &self.extents[cell as usize];
        let cells_below = cells.iter().copied().filter(|&cell| extent(cell)[0][axis] < at).collect();
        let cells_above = cells.into_iter().filter(|&cell| extent(cell)[1][axis] >= at).collect();
        self.divide(lower, cells_below, left, below);
        let above = self.tree.nodes.len() as u32;
        self.tree.nodes[node] = Node::Cut { axis, at, above };
        self.divide(upper, cells_above, right, count - below);
    }

    /// The cut near the middle that the fewest cells lie on both sides of; `None` if no cut leaves centres on
    /// both.
    fn best_cut(
        &self,
        centres: &mut [Point3],
        cells: &[u32],
        below: usize,
        count: usize,
    ) -> Option<(usize, f64)> {
        let mut best: Option<(usize, usize, f64)> = None;
        for axis in 0..3 {
            for off in CUTS {
                let share = below as f64 / count as f64 + off;
                let Some(at) = between(centres, axis, share) else { continue };
                let is_cut = |extent: &Extent| extent[0][axis] < at && extent[1][axis] >= at;
                let crossing = cells.iter().filter(|&&cell| is_cut(&self.extents[cell as usize])).count();
                if best.is_none_or(|(fewest, ..)| crossing < fewest) {
                    best = Some((crossing, axis, at));
                }
            }
        }
        let (crossing, axis, at) = best?;
        (crossing as f64 <= CROSSING_MAX * cells.len() as f64).then_some((axis, at))
    }
}

/// A place on an axis between two centres, with about this share of them below it. It is on none of them if
/// that is possible: whether a centre is beyond it must not be hard to tell.
fn between(centres: &mut [Point3], axis: usize, share: f64) -> Option<f64> {
    let at = (centres.len() as f64 * share) as usize;
    if at == 0 || at >= centres.len() {
        return None;
    }
    let by_axis = |p: &Point3, q: &Point3| p[axis].total_cmp(&q[axis]);
    let (lower, middle, _) = centres.select_nth_unstable_by(at, by_axis);
    let (above, below) = (middle[axis], lower.iter().map(|p| p[axis]).fold(f64::NEG_INFINITY, f64::max));
    let half = below + 0.5 * (above - below);
    (below < above && half.is_finite()).then_some(if below < half { half } else { above })
}

/// Moves the items for which `is_first` holds to the front; returns their number.
fn partition<T>(items: &mut [T], is_first: impl Fn(&T) -> bool) -> usize {
    let mut count = 0;
    for at in 0..items.len() {
        if is_first(&items[at]) {
            items.swap(count, at);
            count += 1;
        }
    }
    count
}

/// The boxes of the finite Voronoi vertices of all cells.
fn extents_of_cells(diagram: &Diagram) -> Vec<Extent> {
    let mut extents = vec![[[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]]; diagram.points.len()];
    for (cell, ball) in diagram.cells.iter().zip(&diagram.balls).filter(|(_, ball)| ball.error.is_finite()) {
        for vertex in cell.vertices {
            let [low, high] = &mut extents[vertex as usize];
            for axis in 0..3 {
                // With their errors: else a cut could be found in the noise of centres that are all in one
                // place.
                low[axis] = low[axis].min(ball.centre[axis] - ball.error);
                high[axis] = high[axis].max(ball.centre[axis] + ball.error);
            }
        }
    }
    extents
}
