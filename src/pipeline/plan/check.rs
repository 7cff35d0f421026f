//! Rules of plans: a plan that breaks one was not made by this program, though its hash may be right.

use super::node::NodeBox;
use super::planning::Plan;
use spmesh_base::error::{Error, Result};
use spmesh_stream::PartName;

const DISAGREEMENT: &str = "parent and children disagree";

/// Checks that the nodes form a tree of boxes, and that they name files that are there.
pub(super) fn check(plan: &Plan) -> Result<()> {
    let fault = |what: &str| Err(Error::malformed(what));
    if !matches!(plan.dims(), 2 | 3) {
        return fault("dimensions other than 2 and 3");
    }
    let Some(root) = plan.nodes.last() else { return fault("a plan without nodes") };
    if root.parent.is_some() {
        return fault("the last node is not the root");
    }
    let of_node = |number: u32, what: &str| Err(Error::malformed(what).at(format!("node {number}")));
    let mut is_listed = vec![false; plan.nodes.len()];
    for (number, node) in (0..).zip(&plan.nodes) {
        let mut is_child = |&child: &u32| {
            child < number
                && plan.nodes[child as usize].parent == Some(number)
                && !std::mem::replace(&mut is_listed[child as usize], true)
        };
        if node.number != number || (node.parent.is_none() && number != root.number) {
            return of_node(number, "it is not where the tree has it");
        }
        if !node.children.iter().all(&mut is_child) {
            return of_node(number, DISAGREEMENT);
        }
        let below = |&child: &u32| u64::from(plan.nodes[child as usize].below) + 1;
        if u64::from(node.below) != node.children.iter().map(below).sum::<u64>() {
            return of_node(number, "it has another number of nodes below");
        }
        if PartName::parse_node(&node.name).is_none() {
            return of_node(number, "its name is none");
        }
        if !is_whole(&node.region, usize::from(plan.dims())) {
            return of_node(number, "its box has other axes than the plan, or is empty");
        }
        if node.files.iter().any(|&file| file as usize >= plan.files.len()) {
            return of_node(number, "it names a file that is not in the plan");
        }
    }
    // Each node but the root is among the children of its parent once, so that every walk meets it once.
    let missing = (0..root.number).find(|&number| !is_listed[number as usize]);
    missing.map_or(Ok(()), |number| of_node(number, DISAGREEMENT))
}

fn is_whole(region: &NodeBox, dims: usize) -> bool {
    let sides = || region.min.iter().zip(&region.max);
    let is_some = |[low, high]: [&Option<f64>; 2]| match (low, high) {
        (Some(low), Some(high)) => low < high,
        _ => true,
    };
    region.min.len() == dims && region.max.len() == dims && sides().all(|(low, high)| is_some([low, high]))
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAN: &str = r#"{"format":"spmesh plan","version":2,"id":"","arguments":[],"duplicates":"first",
    "dims":2,"grid":null,"elevation":true,"crs":"unknown","attributes":[],"leaf_points":4,"points":7,
    "stages":[[0,1],[2,2]],"beside":[],"roots":{},"skipped":[],
    "nodes":[
    {"number":0,"name":"0123456789abcdef","stage":0,
    "below":0,"parent":2,"children":[],"box":{"min":[null,1.5],"max":[5.0,3.5]},"points":4,"files":[0]},
    {"number":1,"name":"1123456789abcdef","stage":0,
    "below":0,"parent":2,"children":[],"box":{"min":[5.0,null],"max":[null,null]},"points":3,"files":[]},
    {"number":2,"name":"2123456789abcdef","stage":1,
    "below":2,"parent":null,"children":[0,1],"box":{"min":[null,null],"max":[null,null]},"points":7,
    "files":[]}],
    "files":[{"root":null,"path":"/a","bytes":46,"modified":1,"content":null,"points":7,
    "min":[0.0,0.0,1.0],"max":[9.0,9.0,9.0]}]}"#;

    #[test]
    fn each_broken_rule_is_found() {
        let verdict = |from: &str, to: &str| {
            let text = PLAN.replacen(from, to, 1);
            assert!(from == to || text != PLAN, "{from}");
            let plan: Plan = serde_json::from_str(&text).expect("JSON of a plan");
            check(&plan).map_err(|error| error.to_string())
        };
        assert_eq!(verdict("", ""), Ok(()));
        // A leaf of a later stage may come before others in the tree.
        assert_eq!(verdict("[0,1],\"box", "[1,0],\"box"), Ok(()));
        for (from, to, what) in [
            (r#""dims":2"#, r#""dims":4"#, "dimensions"),
            (r#""parent":null"#, r#""parent":0"#, "not the root"),
            (r#""number":1"#, r#""number":0"#, "node 1: it is not where"),
            (r#""parent":2"#, r#""parent":null"#, "node 0: it is not where"),
            ("[0,1],\"box", "[0,2],\"box", "node 2: parent and children"),
            ("[0,1],\"box", "[0,0,1],\"box", "node 2: parent and children"),
            (
                "2,\"parent\":null,\"children\":[0,1]",
                "1,\"parent\":null,\"children\":[1]",
                "node 0: parent and children",
            ),
            (r#""children":[]"#, r#""children":[0]"#, "node 0: parent and children"),
            (r#""below":2"#, r#""below":1"#, "node 2: it has another number"),
            ("1123456789abcdef", "1123456789abcdeF", "node 1: its name"),
            ("[null,1.5]", "[1.5]", "node 0: its box"),
            ("[null,1.5]", "[null,3.5]", "node 0: its box"),
            (r#""files":[0]"#, r#""files":[1]"#, "node 0: it names a file"),
        ] {
            let message = verdict(from, to).unwrap_err();
            assert!(message.contains(what), "{to}: {message}");
        }
    }
}
