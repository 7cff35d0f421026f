//! Which nodes of a plan are complete, and how much work the others are.

use std::path::Path;

use super::folder::Folder;
use super::{Node, NodeKind, Plan};
use spmesh_base::error::Result;

/// Points of the residual of a node in the plane for each square root of the points below it, and in space
/// for each two-thirds power.
const LEFT_IN_PLANE: f64 = 20.0;
const LEFT_IN_SPACE: f64 = 12.0;

/// Nodes of a batch, so that command lines stay short.
const BATCH_NODES: usize = 500;

/// The nodes that are not complete in a folder of parts, after a check that all files are as they were when
/// the plan was made.
///
/// # Errors
/// Usage, if a file has changed; I/O, if one is gone, or a report cannot be read.
pub fn incomplete<'a>(plan: &'a Plan, folder: &'a Path) -> Result<Vec<&'a Node>> {
    plan.check_files()?;
    Folder { path: folder, plan }.incomplete()
}

/// Points that a node is expected to triangulate: those of the files in a leaf, and above what its children
/// leave.
pub fn expected(plan: &Plan, node: &Node) -> u64 {
    let left = |&child: &u32| {
        let points = plan.nodes[child as usize].points as f64;
        match plan.dims() {
            2 => LEFT_IN_PLANE * points.sqrt(),
            _ => LEFT_IN_SPACE * points.powf(2.0 / 3.0),
        }
        .min(points)
    };
    match node.kind() {
        NodeKind::Leaf => node.points,
        NodeKind::Inner => node.children.iter().map(left).sum::<f64>() as u64,
    }
}

/// Divides nodes into batches of one stage each, in their order: of so many expected points, and of at least
/// one node.
pub fn batches<'a>(plan: &Plan, nodes: &[&'a Node], points: u64) -> Vec<Vec<&'a Node>> {
    let mut batches: Vec<Vec<&Node>> = Vec::new();
    let mut held = 0;
    for &node in nodes {
        let more = expected(plan, node);
        let fits = batches.last().is_some_and(|batch: &Vec<&Node>| {
            batch[0].stage == node.stage && batch.len() < BATCH_NODES && held + more <= points
        });
        if fits {
            held += more;
            batches.last_mut().into_iter().for_each(|batch| batch.push(node));
        } else {
            held = more;
            batches.push(vec![node]);
        }
    }
    batches
}
