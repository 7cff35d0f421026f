//! What can be triangulated next, and what can be written next.

use std::collections::{BTreeMap, VecDeque};

use super::boxes::Boxes;
use super::node::Solved;
use super::plan::Plan;
use super::residual::Residual;
use super::stats::Stats;
use spmesh_model::bounds::Region;
use spmesh_model::cells::CellCode;

/// A node to be triangulated.
#[derive(Debug)]
pub(super) struct Job<const D: usize> {
    pub(super) number: u64,
    pub(super) cell: CellCode,
    /// Outside of it, other points may lie.
    pub(super) region: Region<D>,
    /// Whether the run sees no point outside of it.
    pub(super) is_root: bool,
    /// Points right from the stream.
    pub(super) raw: Residual<D>,
    /// What the nodes below have left, in Morton order.
    pub(super) parts: Vec<Residual<D>>,
}

impl<const D: usize> Job<D> {
    /// Number of points.
    pub(super) fn len(&self) -> usize {
        self.raw.len() + self.parts.iter().map(Residual::len).sum::<usize>()
    }

    /// Whether the points come right from the stream, and wait for nothing below.
    pub(super) fn is_leaf(&self) -> bool {
        self.parts.is_empty()
    }
}

/// A node to be written.
#[derive(Debug)]
pub(super) struct Output<const D: usize> {
    pub(super) number: u64,
    /// Number of its points.
    pub(super) points: usize,
    /// Numbers of the nodes whose residuals it took, in their order.
    pub(super) children: Vec<u64>,
    /// Number of its simplices that are not final.
    pub(super) active: usize,
    pub(super) solved: Solved<D>,
}

/// A node whose residual was not taken yet.
#[derive(Debug)]
struct Node<const D: usize> {
    cell: CellCode,
    is_leaf: bool,
    raw: Residual<D>,
    children: Vec<u64>,
    /// How many of the children are not triangulated yet.
    missing: usize,
    parent: Option<u64>,
    /// Number of its points, when it is released.
    points: usize,
    /// What it has left, when it is triangulated.
    residual: Option<Residual<D>>,
}

/// The nodes between their tag and the output.
///
/// A node can be triangulated as soon as the nodes below are, whatever was written by then. Nodes come out by
/// number, so the order of the output does not depend on when each was done.
pub(super) struct Schedule<const D: usize> {
    plan: Plan,
    boxes: Boxes<D>,
    nodes: BTreeMap<u64, Node<D>>,
    jobs: VecDeque<Job<D>>,
    /// The node of everything, above all others that have points.
    root: Option<Job<D>>,
    outputs: BTreeMap<u64, Output<D>>,
    next_output: u64,
    stats: Stats,
}

impl<const D: usize> Schedule<D> {
    pub(super) fn new(plan: Plan, boxes: Boxes<D>) -> Self {
        Schedule {
            plan,
            boxes,
            nodes: BTreeMap::new(),
            jobs: VecDeque::new(),
            root: None,
            outputs: BTreeMap::new(),
            next_output: 0,
            stats: Stats::default(),
        }
    }

    /// Takes the points of a cell that is final. If they are not all of it, because parts of it were final
    /// before, its node is one above those of the parts.
    pub(super) fn cell(&mut self, cell: CellCode, points: Residual<D>, is_whole: bool) {
        if is_whole {
            self.stats.leaves += u64::from(!points.is_empty());
            self.stats.leaf_max = self.stats.leaf_max.max(points.len() as u64);
        }
        self.add(cell, points, is_whole);
        let mut cell = cell;
        while let Some(parent) = self.plan.complete_parent(cell) {
            self.add(parent, Residual::default(), false);
            cell = parent;
        }
    }

    /// Takes the points of the cells that were never tagged: with them, everything is final.
    pub(super) fn rest(&mut self, points: Residual<D>) {
        self.stats.untagged = points.len() as u64;
        if !points.is_empty() || !self.plan.is_complete() {
            self.add(CellCode::ROOT, points, false);
        }
    }

    /// Takes what triangulating node `number` gave.
    pub(super) fn solved(&mut self, number: u64, mut solved: Solved<D>) {
        let node = self.nodes.get_mut(&number).expect("a node waits until its parent takes its residual");
        let active = solved.residual.active;
        node.residual = Some(std::mem::take(&mut solved.residual));
        let (points, parent) = (node.points, node.parent);
        let children = std::mem::take(&mut node.children);
        self.outputs.insert(number, Output { number, points, children, active, solved });
        if let Some(parent) = parent {
            let above = self.nodes.get_mut(&parent).expect("a parent is planned");
            above.missing -= 1;
            if above.missing == 0 {
                self.release(parent);
            }
        }
    }

    /// The next node that can be triangulated, but for the root.
    pub(super) fn next_job(&mut self) -> Option<Job<D>> {
        self.jobs.pop_front()
    }

    /// The node of everything, with the numbers of the nodes below it: to be triangulated when all others are written.
    /// That waits for nothing and nothing waits for it, so its patches need not wait for each other.
    pub(super) fn take_root(&mut self) -> Option<(Job<D>, Vec<u64>)> {
        let root = self.root.take()?;
        let children = self.nodes.get(&root.number).map(|node| node.children.clone());
        Some((root, children.unwrap_or_default()))
    }

    /// The next node that can be written.
    pub(super) fn next_output(&mut self) -> Option<Output<D>> {
        loop {
            let output = self.outputs.remove(&self.next_output)?;
            self.next_output += 1;
            if output.points > 0 {
                return Some(output);
            }
        }
    }

    /// What is left when everything is written, with the numbers of the nodes that left it, in their order; and
    /// what was counted.
    pub(super) fn into_residual(self) -> (Vec<u64>, Vec<Residual<D>>, Stats) {
        debug_assert!(self.jobs.is_empty() && self.outputs.is_empty());
        let left = self.nodes.into_iter().filter_map(|(number, node)| Some((number, node.residual?)));
        let (numbers, residuals) = left.unzip();
        (numbers, residuals, self.stats)
    }

    /// Adds the node of `cell`, over those inside it, with `raw` points of its own.
    fn add(&mut self, cell: CellCode, raw: Residual<D>, is_leaf: bool) {
        let (number, children) = self.plan.node(cell);
        let mut missing = 0;
        for child in &children {
            let node = self.nodes.get_mut(child).expect("a node waits until its parent takes its residual");
            node.parent = Some(number);
            missing += usize::from(node.residual.is_none());
        }
        let node = Node { cell, is_leaf, raw, children, missing, parent: None, points: 0, residual: None };
        self.nodes.insert(number, node);
        if missing == 0 {
            self.release(number);
        }
    }

    /// Makes a node whose children are triangulated a job; without points, it is done.
    fn release(&mut self, number: u64) {
        let node = self.nodes.get_mut(&number).expect("the node is planned");
        let (cell, raw, children) = (node.cell, std::mem::take(&mut node.raw), node.children.clone());
        let is_leaf = node.is_leaf;
        let parts = children.iter().filter_map(|child| self.nodes.remove(child)?.residual).collect();
        let region = self.boxes.region(cell);
        let is_root = self.boxes.is_everything(&region);
        let job = Job { number, cell, region, is_root, raw, parts };
        let points = job.len();
        if let Some(node) = self.nodes.get_mut(&number) {
            node.points = points;
        }
        if !is_leaf {
            self.stats.inner_nodes += u64::from(points > 0);
            self.stats.inner_node_max = self.stats.inner_node_max.max(points as u64);
        }
        if points == 0 {
            self.solved(number, Solved::default());
        } else if is_root {
            self.stats.root_points = points as u64;
            self.root = Some(job);
        } else {
            self.jobs.push_back(job);
        }
    }
}
