//! The next node to triangulate, and the next node to write.

use std::collections::{BTreeMap, VecDeque};

use super::boxes::Boxes;
use super::budget::{Held, Load};
use super::cell_buffer::Tagged;
use super::division::{CROWDED, Division};
use super::node::Solved;
use super::plan::Plan;
use super::residual::Residual;
use super::stats::Stats;
use spmesh_stream::model::bounds::Region;
use spmesh_stream::model::cells::CellCode;

/// A node that can be triangulated.
#[derive(Debug)]
pub(super) struct Job<const D: usize> {
    pub(super) number: u64,
    pub(super) cell: CellCode,
    /// Other points may lie outside of it.
    pub(super) region: Region<D>,
    /// Whether the run sees no point outside of it.
    pub(super) is_root: bool,
    /// Points from the stream.
    pub(super) raw: Residual<D>,
    /// Residuals of the nodes below, in Morton order.
    pub(super) parts: Vec<Residual<D>>,
    /// Bytes that it may take beyond those of each point.
    pub(super) spare: u64,
}

impl<const D: usize> Job<D> {
    /// Number of points.
    pub(super) fn len(&self) -> usize {
        self.raw.len() + self.parts.iter().map(Residual::len).sum::<usize>()
    }

    /// Number of points that no node has triangulated yet.
    fn raw_len(&self) -> usize {
        self.raw.len() + self.parts.iter().map(|part| part.raw).sum::<usize>()
    }

    /// Whether all points come from the stream, without a node below.
    pub(super) fn is_leaf(&self) -> bool {
        self.parts.is_empty()
    }
}

/// A node that can be written when its turn comes.
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

impl<const D: usize> Output<D> {
    /// Bytes of its patches beyond what its points usually have.
    pub(super) fn bytes_beyond(&self) -> usize {
        self.solved.bytes_beyond(self.points)
    }
}

/// A node whose residual no parent has taken yet.
#[derive(Debug)]
struct Node<const D: usize> {
    /// Its cell, or the cell that it is a part of.
    cell: CellCode,
    region: Region<D>,
    is_leaf: bool,
    is_solved: bool,
    /// Its own points from the stream, until it is released; its residual, once it is triangulated.
    held: Residual<D>,
    children: Vec<u64>,
    /// How many of the children are not triangulated yet.
    missing: usize,
    parent: Option<u64>,
    /// Number of its points, of those that no node has triangulated, and of its walls, once it is released.
    points: usize,
    raw_points: usize,
    walls: usize,
}

impl<const D: usize> Node<D> {
    /// A node that is not planned yet.
    fn new(cell: CellCode, region: Region<D>, is_leaf: bool, held: Residual<D>, children: Vec<u64>) -> Self {
        Node {
            cell,
            region,
            is_leaf,
            is_solved: false,
            held,
            children,
            missing: 0,
            parent: None,
            points: 0,
            raw_points: 0,
            walls: 0,
        }
    }
}

/// The nodes between their tag and the output.
///
/// A node can be triangulated as soon as the nodes below are, whether or not they are written. Nodes are
/// written by number, so the order of the output does not depend on the order in which they were
/// triangulated.
pub(super) struct Schedule<const D: usize> {
    plan: Plan,
    boxes: Boxes<D>,
    nodes: BTreeMap<u64, Box<Node<D>>>,
    jobs: VecDeque<Job<D>>,
    /// The job of the root, the highest node with points, once it can be triangulated.
    root: Option<Job<D>>,
    outputs: BTreeMap<u64, Output<D>>,
    next_output: u64,
    /// Points that wait for their cell, those of nodes that wait, and those under way.
    load: Load,
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
            load: Load::default(),
            stats: Stats::default(),
        }
    }

    /// Notes what waits for its cell.
    pub(super) fn hold(&mut self, held: Held) {
        self.load.held = held;
    }

    /// Notes the bytes of patches that wait to be written, beyond what points usually have.
    pub(super) fn hold_patches(&mut self, bytes: usize) {
        self.load.patches = bytes;
    }

    /// What is in memory.
    pub(super) fn load(&self) -> Load {
        Load { nodes: self.nodes.len(), ..self.load }
    }

    /// Takes the points of a final cell. If parts of it were final before, its node is above the nodes of the
    /// parts.
    pub(super) fn cell(&mut self, tagged: Tagged<D>) {
        let Tagged { cell, points, is_whole, completes } = tagged;
        if is_whole {
            self.stats.leaves += u64::from(!points.is_empty());
            self.stats.leaf_max = self.stats.leaf_max.max(points.len() as u64);
        }
        self.add(cell, points, is_whole);
        let above = std::iter::successors(Some(cell), |&cell| self.plan.parent(cell)).skip(1);
        for cell in above.take(completes.into()).collect::<Vec<_>>() {
            self.add(cell, Residual::default(), false);
        }
    }

    /// Takes the points of the cells that were never tagged; with them, all points are final.
    pub(super) fn rest(&mut self, points: Residual<D>) {
        self.stats.untagged = points.len() as u64;
        if !points.is_empty() || !self.plan.is_complete() {
            self.add(CellCode::ROOT, points, false);
        }
    }

    /// Takes the result of node `number`.
    pub(super) fn solved(&mut self, number: u64, mut solved: Solved<D>) {
        let node = self.nodes.get_mut(&number).expect("a node waits until its parent takes its residual");
        let active = solved.residual.active;
        self.load.raw = self.load.raw + solved.residual.raw - node.raw_points;
        self.load.left = self.load.left + solved.residual.keys.len() - (node.points - node.raw_points);
        self.load.walls = self.load.walls + solved.residual.walls.len() - node.walls;
        node.held = std::mem::take(&mut solved.residual);
        node.is_solved = true;
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

    /// The next node that can be triangulated, except the root.
    pub(super) fn next_job(&mut self) -> Option<Job<D>> {
        self.jobs.pop_front()
    }

    /// The root, with the numbers of the nodes below it, to be triangulated when all others are written. Its
    /// patches can then be written as they come.
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

    /// The residuals when everything is written, with the numbers of the nodes that left them, in order; and
    /// the figures.
    pub(super) fn into_residual(self) -> (Vec<u64>, Vec<Residual<D>>, Stats) {
        debug_assert!(self.jobs.is_empty() && self.outputs.is_empty());
        debug_assert!(self.nodes.values().all(|node| node.is_solved));
        let (numbers, residuals) = self.nodes.into_iter().map(|(number, node)| (number, node.held)).unzip();
        (numbers, residuals, self.stats)
    }

    /// Adds the node of `cell`, over those inside it, with `raw` points of its own, if there are any of
    /// either.
    fn add(&mut self, cell: CellCode, mut raw: Residual<D>, is_leaf: bool) {
        let region = self.boxes.region(cell);
        let mut parts = Vec::new();
        if raw.len() > CROWDED
            && let Division::Halves { halves, .. } = Division::of(&mut raw, region)
        {
            let [low, high] = *halves;
            // From the end on, so that the memory of each piece is given back at once.
            parts = [high, low].map(|half| self.add_piece(cell, half, &mut raw)).to_vec();
            raw = Residual::default();
        }
        let mut children = self.plan.take(cell);
        children.extend(parts);
        if children.is_empty() && raw.is_empty() {
            return;
        }
        let number = self.plan.node(cell);
        let is_leaf = is_leaf && children.is_empty();
        self.add_node(number, Node::new(cell, region, is_leaf, raw, children));
    }

    /// Adds the nodes of a piece of a crowded cell, whose points are the last of `raw`; returns the number of
    /// the highest.
    fn add_piece(&mut self, cell: CellCode, piece: Division<D>, raw: &mut Residual<D>) -> u64 {
        let (region, own, children) = match piece {
            Division::Piece { region, points } => (region, raw.split_off(points), Vec::new()),
            Division::Halves { region, halves } => {
                let [low, high] = *halves;
                let children = [high, low].map(|half| self.add_piece(cell, half, raw));
                (region, Residual::default(), children.to_vec())
            }
        };
        let (number, is_leaf) = (self.plan.number(), children.is_empty());
        self.add_node(number, Node::new(cell, region, is_leaf, own, children));
        number
    }

    /// Adds a node, whose children have been added.
    fn add_node(&mut self, number: u64, mut node: Node<D>) {
        self.load.raw += node.held.len();
        for child in &node.children {
            let child = self.nodes.get_mut(child).expect("a node waits until its parent takes its residual");
            child.parent = Some(number);
            node.missing += usize::from(!child.is_solved);
        }
        let is_complete = node.missing == 0;
        self.nodes.insert(number, Box::new(node));
        if is_complete {
            self.release(number);
        }
    }

    /// Turns a node whose children are triangulated into a job; a node without points is finished at once.
    fn release(&mut self, number: u64) {
        let node = self.nodes.get_mut(&number).expect("the node is planned");
        let (cell, region) = (node.cell, node.region);
        let (raw, children) = (std::mem::take(&mut node.held), node.children.clone());
        let is_leaf = node.is_leaf;
        let parts = children.iter().filter_map(|child| Some(self.nodes.remove(child)?.held)).collect();
        let is_root = self.boxes.is_everything(&region);
        let job = Job { number, cell, region, is_root, raw, parts, spare: u64::MAX };
        let points = job.len();
        if let Some(node) = self.nodes.get_mut(&number) {
            node.points = points;
            node.raw_points = job.raw_len();
            node.walls = job.parts.iter().map(|part| part.walls.len()).sum();
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
        } else if job.is_leaf() {
            self.jobs.push_back(job);
        } else {
            // Nodes that are done wait in memory for those above them, which are written before the next
            // leaf.
            self.jobs.push_front(job);
        }
    }
}
