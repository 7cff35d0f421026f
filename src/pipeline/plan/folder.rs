//! The files of a node, and whether they are complete.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use super::{FileSize, Node, NodeReport, Plan, hash_of_file};
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_formats::source::Plain;
use spmesh_stream::StreamReader;

/// The folder of all parts.
#[derive(Debug, Clone, Copy)]
pub(super) struct Folder<'a> {
    pub(super) path: &'a Path,
    pub(super) plan: &'a Plan,
}

/// Endings of the files of a node behind its name: of its part, its residual, and its report.
pub(super) const PART: &str = ".spm";
pub(super) const RESIDUAL: &str = ".rest.spm";
pub(super) const REPORT: &str = ".json";

/// Name of a file of a node.
pub(super) fn file_name(node: &Node, ending: &str) -> String {
    format!("{}{ending}", node.name)
}

/// Opens a stream that a node has written. It is no input that must stay: the node may be made again.
pub(super) fn open_stream(path: &Path) -> Result<StreamReader<Plain<File>>> {
    let name = path.display().to_string();
    let file = File::open(path).map_err(|e| Error::io("opening", e).of_input(&name))?;
    let plain = Plain::new(file).map_err(|e| Error::io("reading", e).of_input(&name))?;
    StreamReader::new(plain, name)
}

impl<'a> Folder<'a> {
    /// The folder for the files of a node: parts are spread over 256 of them.
    pub(super) fn home(&self, node: &Node) -> PathBuf {
        self.path.join(&node.name[..2])
    }

    pub(super) fn mesh(&self, node: &Node) -> PathBuf {
        self.home(node).join(file_name(node, PART))
    }

    pub(super) fn residual(&self, node: &Node) -> PathBuf {
        self.home(node).join(file_name(node, RESIDUAL))
    }

    pub(super) fn report_path(&self, node: &Node) -> PathBuf {
        self.home(node).join(file_name(node, REPORT))
    }

    /// The report of a node, if there is one.
    pub(super) fn report(&self, node: &Node) -> Result<Option<NodeReport>> {
        Ok(NodeReport::read(&self.report_path(node))?.filter(|report| report.name == node.name))
    }

    fn has(&self, path: &Path, file: &FileSize) -> bool {
        fs::metadata(path).is_ok_and(|found| found.is_file() && found.len() == file.bytes)
    }

    /// The report of a node whose part is there.
    pub(super) fn with_mesh(&self, node: &Node) -> Result<Option<NodeReport>> {
        Ok(self.report(node)?.filter(|report| self.has(&self.mesh(node), &report.mesh)))
    }

    /// The report of a node that need not be made: its part is there, made of the residuals that its children
    /// have left; and its residual is, or the part of its parent, which has used it.
    ///
    /// Nothing else decides whether a node is complete.
    pub(super) fn complete(&self, node: &Node) -> Result<Option<NodeReport>> {
        let Some(report) = self.with_mesh(node)? else { return Ok(None) };
        if report.joined != self.residual_hashes(node)? {
            return Ok(None);
        }
        let parent = node.parent.map(|parent| self.plan.node(parent)).transpose()?;
        let is_used = match (&report.residual, parent) {
            (Some(residual), _) if self.has(&self.residual(node), residual) => true,
            (_, Some(parent)) => self.with_mesh(parent)?.is_some(),
            (_, None) => true,
        };
        Ok(Some(report).filter(|_| is_used))
    }

    /// The nodes that are not complete.
    pub(super) fn incomplete(&self) -> Result<Vec<&'a Node>> {
        let mut found = Vec::new();
        for node in &self.plan.nodes {
            if self.complete(node)?.is_none() {
                found.push(node);
            }
        }
        Ok(found)
    }

    /// Whether the residual of a node is there, as it was written.
    pub(super) fn has_whole_residual(&self, node: &Node) -> Result<bool> {
        let written = self.report(node)?.and_then(|report| report.residual).map(|residual| residual.hash);
        Ok(written.is_some() && hash_of_file(&self.residual(node)).ok() == written)
    }

    /// The hashes of the residuals that a node joins, as the reports of its children state them.
    pub(super) fn residual_hashes(&self, node: &Node) -> Result<Vec<String>> {
        let hash = |&child: &u32| -> Result<String> {
            let residual = self.report(self.plan.node(child)?)?.and_then(|report| report.residual);
            Ok(residual.map(|residual| residual.hash).unwrap_or_default())
        };
        node.children.iter().map(hash).collect()
    }

    /// What is wrong with the part of a node, if anything: it is read to its end.
    pub(super) fn damage_of(&self, node: &Node) -> Result<Option<Error>> {
        let read = || -> Result<()> {
            let path = self.mesh(node);
            let mut reader = open_stream(&path)?;
            if reader.header().part != Some(self.plan.part(node)) {
                let message = format!("this is not the part of node {}", node.number);
                return Err(Error::malformed(message).of_input(path.display().to_string()));
            }
            while reader.next_event()?.is_some() {}
            Ok(())
        };
        match read() {
            Ok(()) => Ok(None),
            Err(error) if error.kind() == ErrorKind::Memory => Err(error),
            Err(error) => Ok(Some(error)),
        }
    }
}
