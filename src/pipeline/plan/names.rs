//! Names of nodes: hashes of all that their parts depend on.
//!
//! So a part is found again by every plan that has its node, wherever that stands in the plan, and one that
//! depends on what has changed has another name.

use serde::Serialize;

use super::Plan;
use super::files::PlannedFile;
use super::node::{Node, NodeBox};
use super::planning::{Grid, PlannedCrs, hash_of};
use crate::reduce::Duplicates;
use spmesh_base::error::{Error, Result};

/// What the parts of all nodes depend on.
#[derive(Serialize)]
struct Common<'a> {
    program: &'a str,
    dims: u8,
    grid: &'a Option<Grid>,
    elevation: bool,
    crs: &'a PlannedCrs,
    attributes: &'a [String],
    arguments: &'a [String],
    duplicates: Duplicates,
    beside: Vec<Identity<'a>>,
}

/// What makes a file the one that it is: its name, and its content or when that was last changed.
#[derive(Serialize)]
struct Identity<'a> {
    root: &'a Option<String>,
    path: &'a str,
    bytes: u64,
    content: &'a Option<String>,
    modified: Option<i64>,
}

impl<'a> Identity<'a> {
    fn of(file: &'a PlannedFile) -> Identity<'a> {
        let PlannedFile { root, path, bytes, content, modified, .. } = file;
        let modified = content.is_none().then_some(*modified);
        Identity { root, path, bytes: *bytes, content, modified }
    }
}

/// What a part depends on beside this.
#[derive(Serialize)]
struct Own<'a> {
    common: &'a str,
    region: &'a NodeBox,
    /// Names of the nodes that it joins.
    children: Vec<&'a str>,
    files: Vec<Identity<'a>>,
}

/// Gives all nodes of a plan their names.
pub(super) fn name_nodes(plan: &mut Plan) -> Result<()> {
    let common = hash_of(&json(&Common {
        program: env!("CARGO_PKG_VERSION"),
        dims: plan.dims,
        grid: &plan.grid,
        elevation: plan.elevation,
        crs: &plan.crs,
        attributes: &plan.attributes,
        arguments: &plan.arguments,
        duplicates: plan.duplicates,
        beside: plan.beside.iter().map(Identity::of).collect(),
    })?);
    for number in 0..plan.nodes.len() {
        plan.nodes[number].name = name_of(&plan.nodes[number], plan, &common)?;
    }
    Ok(())
}

fn name_of(node: &Node, plan: &Plan, common: &str) -> Result<String> {
    let children = node.children.iter().map(|&child| plan.nodes[child as usize].name.as_str()).collect();
    let files = plan.files_of(node).into_iter().map(Identity::of).collect();
    Ok(hash_of(&json(&Own { common, region: &node.region, children, files })?))
}

/// A part of a plan as JSON.
pub(super) fn json(value: &impl Serialize) -> Result<Vec<u8>> {
    serde_json::to_vec(value).map_err(|e| Error::malformed(format!("the plan cannot be written: {e}")))
}
