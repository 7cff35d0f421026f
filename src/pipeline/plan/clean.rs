//! Removes what no node of a plan needs: the files of earlier plans in the same folder.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use super::Plan;
use super::folder::{Folder, PART, REPORT, RESIDUAL};
use spmesh_base::error::{Error, Result, counted};
use spmesh_stream::PartName;

/// A file of a node that is not in the plan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Spent {
    /// Its path.
    pub path: PathBuf,
    /// Its length in bytes.
    pub bytes: u64,
}

/// The files in the folder of the parts that belong to no node of the plan, in the order of their names.
/// Files that no node has written are not among them.
///
/// # Errors
/// Usage, if a node of the plan is not complete: an earlier mesh may be all there is; I/O, if the folder
/// cannot be read.
pub fn spent(plan: &Plan, folder: &Path) -> Result<Vec<Spent>> {
    let reading = |e| Error::io("reading", e).of_input(folder.display().to_string());
    let missing = Folder { path: folder, plan }.incomplete()?.len() as u64;
    if missing > 0 {
        let nodes = counted(missing, "node is", "nodes are");
        return Err(Error::usage(format!(
            "{nodes} not complete: nothing is removed before the new mesh is there"
        )));
    }
    let names: HashSet<&str> = plan.nodes.iter().map(|node| node.name.as_str()).collect();
    let mut found = Vec::new();
    for home in fs::read_dir(folder).map_err(reading)? {
        let home = home.map_err(reading)?.path();
        // Neither links nor other files are what nodes have made.
        let name = home.file_name().and_then(|name| name.to_str()).filter(|name| name.len() == 2);
        let Some(digits) = name.filter(|_| fs::symlink_metadata(&home).is_ok_and(|found| found.is_dir()))
        else {
            continue;
        };
        for entry in fs::read_dir(&home).map_err(reading)? {
            let entry = entry.map_err(reading)?;
            let name = entry.file_name();
            let is_file = entry.file_type().map_err(reading)?.is_file();
            let node = name.to_str().and_then(node_of).filter(|node| is_file && node.starts_with(digits));
            if node.is_some_and(|node| !names.contains(node)) {
                let bytes = entry.metadata().map_err(reading)?.len();
                found.push(Spent { path: entry.path(), bytes });
            }
        }
    }
    found.sort_unstable_by(|a, b| a.path.cmp(&b.path));
    Ok(found)
}

/// Removes files. Those that are gone already do not matter.
///
/// # Errors
/// I/O, if one cannot be removed.
pub fn remove(files: &[Spent]) -> Result<()> {
    for file in files {
        match fs::remove_file(&file.path) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
                return Err(Error::io("removing", e).of_input(file.path.display().to_string()));
            }
            _ => {}
        }
    }
    Ok(())
}

/// The name of the node that a file with this name is of.
fn node_of(file: &str) -> Option<&str> {
    // The ending of a residual is also that of a part.
    let name = [RESIDUAL, PART, REPORT].iter().find_map(|ending| file.strip_suffix(ending));
    name.filter(|name| PartName::parse_node(name).is_some())
}
