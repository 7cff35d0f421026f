//! Divides the box of all points into leaves.

use super::align::{Borders, borders_between};
use super::node::{Node, NodeBox, reaches};
use spmesh_base::error::{Error, Result};
use spmesh_stream::PartName;
use spmesh_stream::model::bounds::{Bounds, Region};

/// Most halvings of the box of all points.
const LEVELS_MAX: u32 = 40;

/// A file: its number, its points and where they are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Share {
    pub(super) file: u32,
    pub(super) points: u64,
    pub(super) bounds: Bounds,
}

/// How a tree is divided.
#[derive(Debug, Clone, Copy)]
pub(super) struct Division {
    /// Axes that are halved: 2 or 3.
    pub(super) dims: usize,
    /// A box is divided if more points than this are expected in it.
    pub(super) leaf_points: u64,
    /// Whether coordinates are integers; borders then are, too.
    pub(super) are_whole: bool,
}

/// A box that is divided further, or a leaf: its part of the grid of borders, and its region, which at the
/// outside is unbounded.
#[derive(Debug, Clone, Copy)]
struct Cell {
    min: [f64; 3],
    max: [f64; 3],
    region: Region<3>,
}

/// A node without its numbers.
struct Branch {
    region: Region<3>,
    points: f64,
    files: Vec<u32>,
    children: Vec<Branch>,
}

impl Division {
    /// The nodes for these files, by number: stage by stage, the root last.
    pub(super) fn nodes(&self, shares: &[Share]) -> Result<Vec<Node>> {
        let mut count = 0;
        let root = match self.root(shares) {
            Some(cell) => self.branch(cell, shares, 0, &mut count)?,
            None => None,
        };
        let empty =
            || Branch { region: Region::EVERYTHING, points: 0.0, files: Vec::new(), children: Vec::new() };
        let mut root = root.unwrap_or_else(empty);
        root.region = Region::EVERYTHING;
        Ok(self.numbered(&root))
    }

    /// The box of all points, larger where that puts its halves on the borders of tiles.
    fn root(&self, shares: &[Share]) -> Option<Cell> {
        let all = shares.iter().map(|share| share.bounds).reduce(Bounds::union)?;
        let (mut min, mut max) = (all.min, all.max);
        let along = |axis: usize| -> Vec<(f64, f64)> {
            shares.iter().map(|it| (it.bounds.min[axis], it.bounds.max[axis])).collect()
        };
        let borders: Vec<_> = (0..self.dims).map(|axis| borders_between(&along(axis))).collect();
        // All axes are halved as often.
        let columns = borders.iter().flatten().map(|borders| borders.columns).max().unwrap_or(1);
        let halvings = f64::from(columns).log2().ceil();
        for axis in 0..self.dims {
            if let Some(Borders { origin, pitch, .. }) = borders[axis] {
                (min[axis], max[axis]) = (origin, origin + pitch * halvings.exp2());
            }
        }
        Some(Cell { min, max, region: Region::EVERYTHING })
    }

    /// The node of a cell, with those below it; `None` if no file reaches into the cell. A cell with one child only
    /// is that child.
    fn branch(&self, cell: Cell, shares: &[Share], level: u32, count: &mut u32) -> Result<Option<Branch>> {
        let here: Vec<Share> =
            shares.iter().filter(|it| reaches(&it.bounds, &cell.region)).copied().collect();
        if here.is_empty() {
            return Ok(None);
        }
        let points = here.iter().map(|share| self.expected(share, &cell.region)).sum();
        let middle = self.middle(&cell).filter(|_| points > self.leaf_points as f64 && level < LEVELS_MAX);
        let Some(middle) = middle else {
            *count += 1;
            if *count > PartName::PARTS_MAX / 2 {
                return Err(Error::usage("the plan has too many leaves: give more --leaf-points"));
            }
            let files = here.iter().map(|share| share.file).collect();
            return Ok(Some(Branch { region: cell.region, points, files, children: Vec::new() }));
        };
        let mut children = Vec::new();
        for corner in 0..1 << self.dims {
            if let Some(child) = self.child(&cell, middle, corner) {
                children.extend(self.branch(child, &here, level + 1, count)?);
            }
        }
        if let [_] = children[..] {
            return Ok(children.pop().map(|only| Branch { region: cell.region, ..only }));
        }
        Ok(Some(Branch { region: cell.region, points, files: Vec::new(), children }))
    }

    /// Points of a file that are expected in a region, if they are spread evenly over its box.
    fn expected(&self, share: &Share, region: &Region<3>) -> f64 {
        let fraction: f64 = (0..self.dims)
            .map(|axis| {
                let (min, max) = (share.bounds.min[axis], share.bounds.max[axis]);
                let inside = max.min(region.max[axis]) - min.max(region.min[axis]);
                if max > min { (inside / (max - min)).clamp(0.0, 1.0) } else { 1.0 }
            })
            .product();
        share.points as f64 * fraction
    }

    /// The border of boxes at a place: between integers no point lies, so borders are integers, too.
    fn border(&self, at: f64) -> f64 {
        if self.are_whole { at.ceil() } else { at }
    }

    /// The places at which a cell is divided; none along axes along which it is too small. `None` if it is too small
    /// along all of them.
    fn middle(&self, cell: &Cell) -> Option<[Option<f64>; 3]> {
        let mut middle = [None; 3];
        for (axis, middle) in middle.iter_mut().enumerate().take(self.dims) {
            let at = cell.min[axis] / 2.0 + cell.max[axis] / 2.0;
            let border = self.border(at);
            // The region, too: each half must have room for a point.
            let divides = self.border(cell.min[axis]) < border && border < self.border(cell.max[axis]);
            let fits = cell.region.min[axis] < border && border < cell.region.max[axis];
            *middle = (divides && fits).then_some(at);
        }
        middle.iter().any(Option::is_some).then_some(middle)
    }

    /// The child at a corner: bit k of `corner` says which half along axis k. `None` if there is no such half.
    fn child(&self, cell: &Cell, middle: [Option<f64>; 3], corner: usize) -> Option<Cell> {
        let mut child = *cell;
        for (axis, middle) in middle.into_iter().enumerate().take(self.dims) {
            match (middle, corner >> axis & 1 == 0) {
                (Some(at), true) => (child.max[axis], child.region.max[axis]) = (at, self.border(at)),
                (Some(at), false) => (child.min[axis], child.region.min[axis]) = (at, self.border(at)),
                (None, true) => {}
                (None, false) => return None,
            }
        }
        Some(child)
    }

    /// The nodes with their numbers.
    fn numbered(&self, root: &Branch) -> Vec<Node> {
        let mut listed = Vec::new();
        self.list(root, &mut listed);
        // Within a stage nodes keep their order in the tree, in which neighbours are near.
        let mut order: Vec<usize> = (0..listed.len()).collect();
        order.sort_by_key(|&place| listed[place].stage);
        let mut numbers = vec![0; listed.len()];
        (0..).zip(&order).for_each(|(number, &place)| numbers[place] = number);
        let mut nodes: Vec<Node> = order.iter().map(|&place| listed[place].clone()).collect();
        for (node, number) in nodes.iter_mut().zip(0..) {
            node.number = number;
            node.children.iter_mut().for_each(|child| *child = numbers[*child as usize]);
        }
        for number in 0..nodes.len() {
            for child in nodes[number].children.clone() {
                nodes[child as usize].parent = Some(number as u32);
            }
        }
        nodes
    }

    /// Adds a branch behind those below it; returns its place. Children are places in the list.
    fn list(&self, branch: &Branch, listed: &mut Vec<Node>) -> u32 {
        let children: Vec<u32> = branch.children.iter().map(|child| self.list(child, listed)).collect();
        let stage = children.iter().map(|&child| listed[child as usize].stage + 1).max().unwrap_or(0);
        listed.push(Node {
            number: 0,
            stage,
            parent: None,
            children,
            region: NodeBox::of(&branch.region, self.dims as u8),
            points: branch.points.ceil() as u64,
            files: branch.files.clone(),
        });
        listed.len() as u32 - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Files of random boxes, some of which overlap.
    fn shares(count: u32) -> Vec<Share> {
        let number = |i: u32, k: u32| f64::from((i * 7919 + k * 104_729) % 1009);
        let share = |i: u32| {
            let min: [f64; 3] = std::array::from_fn(|axis| number(i, axis as u32) * 10.0);
            let max = std::array::from_fn(|axis| min[axis] + number(i, 3 + axis as u32));
            Share { file: i, points: 1 + u64::from(i % 13) * 50, bounds: Bounds { min, max } }
        };
        (0..count).map(share).collect()
    }

    #[test]
    fn nodes_are_numbered_from_the_leaves_up_and_boxes_do_not_overlap() {
        for (count, dims, leaf_points) in [(0, 2, 5), (1, 2, 5), (40, 2, 90), (200, 3, 500), (50, 2, 30)] {
            let shares = shares(count);
            let nodes = Division { dims, leaf_points, are_whole: true }.nodes(&shares).unwrap();
            let root = nodes.last().unwrap();
            assert_eq!((root.parent, root.region.region()), (None, Region::EVERYTHING));
            for (number, node) in (0..).zip(&nodes) {
                assert_eq!(node.number, number);
                assert!(node.children.iter().all(|&child| nodes[child as usize].parent == Some(number)));
                let below = node.children.iter().map(|&child| nodes[child as usize].stage + 1);
                assert_eq!(node.stage, below.max().unwrap_or(0));
                assert!(number == 0 || nodes[number as usize - 1].stage <= node.stage);
            }
            let leaves: Vec<&Node> = nodes.iter().filter(|node| node.children.is_empty()).collect();
            for (i, leaf) in leaves.iter().enumerate() {
                let region = leaf.region.region();
                assert!((0..3).all(|axis| region.min[axis] < region.max[axis]), "{region:?}");
                assert!(leaves[..i].iter().all(|other| !other.region.region().overlaps(&region)));
                let reaching = shares.iter().filter(|share| reaches(&share.bounds, &region));
                assert_eq!(leaf.files, reaching.map(|share| share.file).collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn thin_boxes_are_divided_along_their_length() {
        for (width, are_whole) in [(0.0, true), (1.0, true), (1.0, false), (5e-324, false)] {
            let bounds = Bounds { min: [0.0; 3], max: [1000.0, width, width] };
            let share = Share { file: 0, points: 1000, bounds };
            for dims in [2, 3] {
                let nodes = Division { dims, leaf_points: 9, are_whole }.nodes(&[share]).unwrap();
                let is_open = |node: &Node| {
                    let region = node.region.region();
                    (0..3).all(|axis| region.min[axis] < region.max[axis])
                };
                assert!(nodes.len() > 100 && nodes.iter().all(is_open));
            }
        }
    }

    #[test]
    fn every_corner_of_a_file_is_in_one_leaf_that_reads_it() {
        let shares = shares(150);
        for are_whole in [true, false] {
            let nodes = Division { dims: 2, leaf_points: 60, are_whole }.nodes(&shares).unwrap();
            for share in &shares {
                for point in [share.bounds.min, share.bounds.max] {
                    let holds =
                        |node: &&Node| node.children.is_empty() && node.region.region().contains(point);
                    let leaves: Vec<&Node> = nodes.iter().filter(holds).collect();
                    assert!(leaves.len() == 1 && leaves[0].files.contains(&share.file));
                }
            }
        }
    }
}
