//! Divides the cells of a lattice into leaves.

use super::lattice::{Cell, Lattice};
use super::node::{Node, NodeBox, reaches};
use spmesh_base::error::{Error, Result};
use spmesh_stream::PartName;
use spmesh_stream::model::bounds::{Bounds, Region};

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
        let boxes: Vec<Bounds> = shares.iter().map(|share| share.bounds).collect();
        let lattice = Lattice::of(&boxes, self.dims, self.are_whole);
        let mut count = 0;
        let root = match boxes.into_iter().reduce(Bounds::union) {
            Some(all) => self.branch(&lattice, lattice.cell_around(&all), shares, &mut count)?,
            None => None,
        };
        let empty =
            || Branch { region: Region::EVERYTHING, points: 0.0, files: Vec::new(), children: Vec::new() };
        let mut root = root.unwrap_or_else(empty);
        // At the root all is final.
        root.region = Region::EVERYTHING;
        Ok(self.numbered(&root))
    }

    /// The node of a cell, with those below it; `None` if no file reaches into the cell. A cell with one
    /// child only is that child.
    fn branch(
        &self,
        lattice: &Lattice,
        cell: Cell,
        shares: &[Share],
        count: &mut u32,
    ) -> Result<Option<Branch>> {
        let region = lattice.region(&cell);
        let here: Vec<Share> = shares.iter().filter(|it| reaches(&it.bounds, &region)).copied().collect();
        if here.is_empty() {
            return Ok(None);
        }
        let points: f64 = here.iter().map(|share| self.expected(share, &region)).sum();
        let halves = if points > self.leaf_points as f64 { lattice.children(&cell) } else { Vec::new() };
        if halves.is_empty() {
            *count += 1;
            if *count > PartName::PARTS_MAX / 2 {
                return Err(Error::usage("the plan has too many leaves: give more --leaf-points"));
            }
            let files = here.iter().map(|share| share.file).collect();
            return Ok(Some(Branch { region, points, files, children: Vec::new() }));
        }
        let mut children = Vec::new();
        for half in halves {
            children.extend(self.branch(lattice, half, &here, count)?);
        }
        if let [_] = children[..] {
            return Ok(children.pop().map(|only| Branch { region, ..only }));
        }
        Ok(Some(Branch { region, points, files: Vec::new(), children }))
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
                nodes[number].below += nodes[child as usize].below + 1;
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
            name: String::new(),
            stage,
            below: 0,
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

    /// A file more, near or far, moves no box but those that it reaches into, and that of the root before.
    #[test]
    fn boxes_stay_when_files_come_and_go() {
        for (pitch, dims, are_whole) in [(1000.0, 2, true), (250.5, 2, false), (64.0, 3, true)] {
            let tile = |file: u32, column: i32, row: i32| {
                let min = [f64::from(column) * pitch, f64::from(row) * pitch, 3.0];
                let max = [min[0] + pitch - 1.0, min[1] + pitch - 1.0, 40.0];
                Share { file, points: 100, bounds: Bounds { min, max } }
            };
            let shares: Vec<Share> =
                (0..70).map(|i| tile(i, (i % 10) as i32 - 4, (i / 10) as i32 - 3)).collect();
            let regions = |shares: &[Share]| -> Vec<NodeBox> {
                let nodes = Division { dims, leaf_points: 150, are_whole }.nodes(shares).unwrap();
                nodes.into_iter().map(|node| node.region).collect()
            };
            let before = regions(&shares);
            for (column, row) in [(6, 0), (-5, -4), (0, 9), (300, -80), (-9, 4000), (3, 3)] {
                let after = regions(&[&shares[..], &[tile(70, column, row)]].concat());
                let moved = before.iter().filter(|region| !after.contains(region)).count();
                assert!(moved <= 1, "{column}, {row}: {moved} of {}", before.len());
                let new = after.iter().filter(|region| !before.contains(region)).count();
                assert!(new <= 1 + (1 << dims), "{column}, {row}: {new} new ones");
            }
        }
    }
}
