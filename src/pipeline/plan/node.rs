//! A node of a plan.

use serde::{Deserialize, Serialize};

use spmesh_stream::model::bounds::{Bounds, Region};

/// A half-open box in stored coordinates, with two or three axes. Sides without a number are infinitely far
/// away.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NodeBox {
    /// Included lower sides.
    pub min: Vec<Option<f64>>,
    /// Excluded upper sides.
    pub max: Vec<Option<f64>>,
}

impl NodeBox {
    /// The box of a region along its first `dims` axes.
    pub fn of(region: &Region<3>, dims: u8) -> NodeBox {
        let sides = |sides: &[f64; 3]| {
            sides[..usize::from(dims)].iter().map(|&side| side.is_finite().then_some(side)).collect()
        };
        NodeBox { min: sides(&region.min), max: sides(&region.max) }
    }

    /// The box as a region, unbounded along axes that it does not have.
    pub fn region(&self) -> Region<3> {
        let sides = |sides: &[Option<f64>], infinite: f64| -> Vec<f64> {
            sides.iter().map(|side| side.unwrap_or(infinite)).collect()
        };
        Region::of_sides(&sides(&self.min, f64::NEG_INFINITY), &sides(&self.max, f64::INFINITY))
    }
}

/// Whether a closed box has a point in a half-open one.
pub(super) fn reaches(bounds: &Bounds, region: &Region<3>) -> bool {
    (0..3).all(|axis| region.min[axis] <= bounds.max[axis] && bounds.min[axis] < region.max[axis])
}

/// What a node does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NodeKind {
    /// Triangulates points.
    Leaf,
    /// Joins the residuals of its children.
    Inner,
}

/// A node of a plan: a job.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Node {
    /// Its number. Nodes are listed by it; it is greater than those of its children.
    pub number: u32,
    /// Its name: a hash of all that its part depends on, in hexadecimal digits.
    pub name: String,
    /// Its stage: 0 for leaves, and one more than the greatest stage of its children for others.
    pub stage: u32,
    /// Number of all nodes below it.
    pub below: u32,
    /// The node that takes what it leaves; none for the root.
    pub parent: Option<u32>,
    /// The nodes that it joins; none for leaves.
    pub children: Vec<u32>,
    /// Its box. Those of its children do not overlap; where none of them is, files state no points.
    #[serde(rename = "box")]
    pub region: NodeBox,
    /// Points that are expected in it, from the headers of files.
    pub points: u64,
    /// Numbers of the files that reach into a leaf.
    pub files: Vec<u32>,
}

impl Node {
    /// What it does.
    pub fn kind(&self) -> NodeKind {
        if self.children.is_empty() { NodeKind::Leaf } else { NodeKind::Inner }
    }

    /// Whether it is the root, where all is final.
    pub fn is_root(&self) -> bool {
        self.parent.is_none()
    }

    /// Its kind in lists.
    pub fn kind_name(&self) -> &'static str {
        match (self.is_root(), self.kind()) {
            (true, _) => "root",
            (false, NodeKind::Leaf) => "leaf",
            (false, NodeKind::Inner) => "inner",
        }
    }
}
