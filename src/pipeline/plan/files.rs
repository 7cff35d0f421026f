//! The files of a plan, as they were when it was made.

use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use spmesh_base::error::{Error, Result};
use spmesh_base::places::file_and_layer;
use spmesh_formats::source::Extent;
use spmesh_stream::model::bounds::Bounds;

/// A file of points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlannedFile {
    /// Its absolute path.
    pub path: String,
    /// Its length in bytes.
    pub bytes: u64,
    /// When it was last changed, in nanoseconds since 1970.
    pub modified: i64,
    /// Number of its points.
    pub points: u64,
    /// Its bounding box in stored coordinates of the plan; none without points.
    pub min: Option<[f64; 3]>,
    /// Its upper corner.
    pub max: Option<[f64; 3]>,
}

impl PlannedFile {
    /// A file and where its points are.
    pub(super) fn new(path: &Path, extent: &Extent) -> Result<PlannedFile> {
        let name = || path.display().to_string();
        let absolute = std::path::absolute(path).map_err(|e| Error::io("finding", e).of_input(name()))?;
        let Some(text) = absolute.to_str() else {
            return Err(Error::usage("its name is not UTF-8, which plans need").of_input(name()));
        };
        let (bytes, modified) = state_of(&absolute).map_err(|e| e.of_input(name()))?;
        let Extent { points, bounds } = *extent;
        let (min, max) = (bounds.map(|bounds| bounds.min), bounds.map(|bounds| bounds.max));
        Ok(PlannedFile { path: text.to_string(), bytes, modified, points, min, max })
    }

    /// Its path.
    pub fn path(&self) -> PathBuf {
        PathBuf::from(&self.path)
    }

    /// Its bounding box in stored coordinates of the plan.
    pub fn bounds(&self) -> Option<Bounds> {
        Some(Bounds { min: self.min?, max: self.max? })
    }

    /// Checks that the file is as it was when the plan was made.
    ///
    /// # Errors
    /// I/O, if it is not there; usage, if it has changed.
    pub fn check(&self) -> Result<()> {
        let (bytes, modified) = state_of(Path::new(&self.path)).map_err(|e| e.of_input(&self.path))?;
        if (bytes, modified) == (self.bytes, self.modified) {
            return Ok(());
        }
        Err(Error::usage("changed since the plan was made: plan again, into another folder")
            .of_input(&self.path))
    }
}

/// Length of a file in bytes, and when it was last changed in nanoseconds since 1970.
fn state_of(path: &Path) -> Result<(u64, i64)> {
    let (file, _) = file_and_layer(path);
    let metadata = fs::metadata(file).map_err(|e| Error::io("reading", e))?;
    if !metadata.is_file() {
        return Err(Error::usage("is no regular file, which plans need: jobs read it later"));
    }
    let modified = metadata.mtime().saturating_mul(1_000_000_000).saturating_add(metadata.mtime_nsec());
    Ok((metadata.len(), modified))
}
