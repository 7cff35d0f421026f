//! The files of a plan, as they were when it was made.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::os::unix::fs::MetadataExt;
use std::path::{Component, Path, PathBuf};

use data_encoding::HEXLOWER;
use serde::{Deserialize, Serialize};

use spmesh_base::error::{Error, Result};
use spmesh_base::places::file_and_layer;
use spmesh_formats::ledger;
use spmesh_formats::source::Extent;
use spmesh_stream::model::bounds::Bounds;

/// Folders by the names under which plans know them.
pub type Roots = BTreeMap<String, PathBuf>;

/// A file of points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlannedFile {
    /// The root that it is in; none if its path is absolute.
    pub root: Option<String>,
    /// Its path in the root, or its absolute path.
    pub path: String,
    /// Its length in bytes.
    pub bytes: u64,
    /// When it was last changed, in nanoseconds since 1970.
    pub modified: i64,
    /// The SHA-256 of its content in hexadecimal digits, if files are known by their contents.
    pub content: Option<String>,
    /// Number of its points.
    pub points: u64,
    /// Its bounding box in stored coordinates of the plan; none without points.
    pub min: Option<[f64; 3]>,
    /// Its upper corner.
    pub max: Option<[f64; 3]>,
}

/// How files are named in a plan, and what makes them the same.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Naming {
    /// Files in these folders are named relative to them.
    pub roots: Roots,
    /// Whether files are known by their contents, and not by when they were last changed.
    pub by_content: bool,
}

impl PlannedFile {
    /// A file and where its points are. The roots of `naming` are absolute.
    pub(super) fn new(path: &Path, extent: &Extent, naming: &Naming) -> Result<PlannedFile> {
        let name = || path.display().to_string();
        let absolute = settled(path).map_err(|e| Error::io("finding", e).of_input(name()))?;
        let inside = |(root, folder): (&String, &PathBuf)| {
            Some((Some(root.clone()), absolute.strip_prefix(folder).ok()?.to_path_buf()))
        };
        let (root, place) = naming.roots.iter().find_map(inside).unwrap_or_else(|| (None, absolute.clone()));
        let Some(text) = place.to_str() else {
            return Err(Error::usage("its name is not UTF-8, which plans need").of_input(name()));
        };
        let (bytes, modified) = state_of(&absolute).map_err(|e| e.of_input(name()))?;
        let content = naming.by_content.then(|| content_of(&absolute)).transpose()?;
        let Extent { points, bounds } = *extent;
        let (min, max) = (bounds.map(|bounds| bounds.min), bounds.map(|bounds| bounds.max));
        Ok(PlannedFile { root, path: text.to_string(), bytes, modified, content, points, min, max })
    }

    /// Its path, where `roots` says where its root is.
    pub fn path(&self, roots: &Roots) -> PathBuf {
        let folder = self.root.as_ref().and_then(|root| roots.get(root));
        folder.map_or_else(|| PathBuf::from(&self.path), |folder| folder.join(&self.path))
    }

    /// Its name in reports: that of its root, if it is in one, and its path.
    pub fn name(&self) -> String {
        self.root.as_ref().map_or_else(|| self.path.clone(), |root| format!("{root}:{}", self.path))
    }

    /// Its bounding box in stored coordinates of the plan.
    pub fn bounds(&self) -> Option<Bounds> {
        Some(Bounds { min: self.min?, max: self.max? })
    }

    /// Checks that the file is as it was when the plan was made.
    ///
    /// # Errors
    /// I/O, if it is not there; usage, if it has changed.
    pub fn check(&self, roots: &Roots) -> Result<()> {
        let path = self.path(roots);
        let named = |e: Error| e.of_input(path.display().to_string());
        let (bytes, modified) = state_of(&path).map_err(named)?;
        let is_same = bytes == self.bytes
            && match &self.content {
                _ if modified == self.modified => true,
                Some(content) => content_of(&path)? == *content,
                None => false,
            };
        if is_same {
            return Ok(());
        }
        Err(named(Error::usage(
            "changed since the plan was made: plan again, and run the same commands; what does not depend on \
             it stays",
        )))
    }
}

/// An absolute path without `..`, so that a file has one name wherever it is planned from.
pub(super) fn settled(path: &Path) -> io::Result<PathBuf> {
    let absolute = std::path::absolute(path)?;
    let parts: Vec<Component> = absolute.components().collect();
    let Some(last) = parts.iter().rposition(|part| *part == Component::ParentDir) else {
        return Ok(absolute);
    };
    // Where `..` leads to, symbolic links decide. Others stay, so that a folder may be moved behind one.
    let (before, behind) = parts.split_at(last + 1);
    let folder = fs::canonicalize(before.iter().collect::<PathBuf>())?;
    Ok(behind.iter().fold(folder, |folder, part| folder.join(part)))
}

/// Length of a file in bytes, and when it was last changed in nanoseconds since 1970.
pub(super) fn state_of(path: &Path) -> Result<(u64, i64)> {
    let (file, _) = file_and_layer(path);
    let metadata = fs::metadata(file).map_err(|e| Error::io("reading", e))?;
    if !metadata.is_file() {
        return Err(Error::usage("is no regular file, which plans need: jobs read it later"));
    }
    let modified = metadata.mtime().saturating_mul(1_000_000_000).saturating_add(metadata.mtime_nsec());
    Ok((metadata.len(), modified))
}

/// The hash of the bytes of a file.
fn content_of(path: &Path) -> Result<String> {
    Ok(HEXLOWER.encode(&digest_of(file_and_layer(path).0)?))
}

/// The SHA-256 of a file.
pub(super) fn digest_of(path: &Path) -> Result<[u8; 32]> {
    let reading = |e| Error::io("reading", e).of_input(path.display().to_string());
    Ok(ledger::digest_of(path).map_err(reading)?.0)
}
