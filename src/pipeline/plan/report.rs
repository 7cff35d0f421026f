//! What a node has done, as a file that is written last.

use std::fs;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::Node;
use super::files::digest_of;
use super::planning::{hash_of, short};
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::REPORT_LEN_MAX;

const FORMAT: &str = "spmesh node";
const VERSION: u32 = 2;

/// Points of one file in the box of a leaf.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileCount {
    /// Name of the file, with its root.
    pub file: String,
    /// Points of the file in the box of the leaf, before any filter.
    pub points: u64,
}

/// A file that a node has written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileSize {
    /// Its name, in the folder of the report.
    pub file: String,
    /// Its length in bytes.
    pub bytes: u64,
    /// A hash of a residual, in hexadecimal digits; empty for a part of the mesh.
    pub hash: String,
}

/// Whether a report may have this length.
fn is_report_len(len: u64) -> bool {
    len <= REPORT_LEN_MAX
}

/// The hash of a file.
///
/// # Errors
/// I/O, if it cannot be read.
pub fn hash_of_file(path: &Path) -> Result<String> {
    Ok(short(&digest_of(path)?))
}

/// The report of a node. The node is complete if its report is there, and its files have the lengths that it
/// states.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NodeReport {
    format: String,
    version: u32,
    /// A hash of all else, in hexadecimal digits.
    checksum: String,
    /// The name of the node.
    pub name: String,
    /// Number of all nodes below it.
    pub below: u32,
    /// Its stage.
    pub stage: u32,
    /// Leaf, inner or root.
    pub kind: String,
    /// Points of each file in the box of a leaf.
    pub files: Vec<FileCount>,
    /// Vertices of water in the box of a leaf, which became points.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub added: u64,
    /// Points in the box of a leaf that filters dropped, and points that are not finite.
    pub dropped: u64,
    /// Points that a leaf triangulated.
    pub points: u64,
    /// Points that coincide with another one, in a leaf.
    pub merged: u64,
    /// Vertices of the part that no part before it has.
    pub vertices: u64,
    /// Triangles or tetrahedra of the part.
    pub simplices: u64,
    /// A box that holds the points of the node, in stored coordinates.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// The part of the mesh.
    pub mesh: FileSize,
    /// What is left for the node above, unless the node is the root.
    pub residual: Option<FileSize>,
    /// Points of the residual.
    pub residual_points: u64,
    /// Hashes of the residuals that the node has joined, in the order of its children.
    pub joined: Vec<String>,
    /// Bytes of points or residuals that the node has read, as they were passed on: of a LAZ file, those of
    /// its decoded points.
    pub read_bytes: u64,
    /// Time, processor time in seconds, and peak memory in bytes of the process.
    pub seconds: f64,
    /// Processor time of the process in seconds, with nodes that it made before.
    pub cpu_seconds: f64,
    /// Peak memory of the process in bytes.
    pub peak_memory_bytes: u64,
    /// Name of the machine.
    pub host: String,
}

/// Whether a number need not be written.
fn is_zero(number: &u64) -> bool {
    *number == 0
}

impl NodeReport {
    /// An empty report.
    pub fn new(node: &Node) -> NodeReport {
        let none = || FileSize { file: String::new(), bytes: 0, hash: String::new() };
        NodeReport {
            format: FORMAT.to_string(),
            version: VERSION,
            checksum: String::new(),
            name: node.name.clone(),
            below: node.below,
            stage: node.stage,
            kind: node.kind_name().to_string(),
            files: Vec::new(),
            added: 0,
            dropped: 0,
            points: 0,
            merged: 0,
            vertices: 0,
            simplices: 0,
            bounds: None,
            mesh: none(),
            residual: None,
            residual_points: 0,
            joined: Vec::new(),
            read_bytes: 0,
            seconds: 0.0,
            cpu_seconds: 0.0,
            peak_memory_bytes: 0,
            host: String::new(),
        }
    }

    /// Reads a report; `None` if there is none, or it is damaged.
    ///
    /// # Errors
    /// I/O, if it is there but cannot be read.
    pub fn read(path: &Path) -> Result<Option<NodeReport>> {
        match fs::metadata(path) {
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Ok(found) if !found.is_file() || !is_report_len(found.len()) => return Ok(None),
            _ => {}
        }
        let text = match fs::read(path) {
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            read => read.map_err(|e| Error::io("reading", e).of_input(path.display().to_string()))?,
        };
        let report: Option<NodeReport> = serde_json::from_slice(&text).ok();
        let Some(report) = report.filter(|report| report.format == FORMAT && report.version == VERSION)
        else {
            return Ok(None);
        };
        let is_whole = report.checked()?.checksum == report.checksum;
        Ok(Some(report).filter(|_| is_whole))
    }

    /// The report as JSON.
    ///
    /// # Errors
    /// If it cannot be written as JSON.
    pub fn to_json(&self) -> Result<String> {
        Ok(self.checked()?.text()? + "\n")
    }

    fn text(&self) -> Result<String> {
        let text = serde_json::to_string_pretty(self);
        text.map_err(|e| Error::malformed(format!("the report cannot be written: {e}")))
    }

    /// The report with its checksum.
    fn checked(&self) -> Result<NodeReport> {
        let bare = NodeReport { checksum: String::new(), ..self.clone() };
        let checksum = hash_of(bare.text()?.as_bytes());
        Ok(NodeReport { checksum, ..bare })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn length_has_a_limit() {
        assert!(is_report_len(REPORT_LEN_MAX) && !is_report_len(REPORT_LEN_MAX + 1));
    }
}
