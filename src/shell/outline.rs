//! Flags about the outline of a surface.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;

use super::open_held;
use spmesh_base::error::{Error, Result};
use spmesh_formats::source::{Mask, read_mask};

/// Flags about the outline of a surface.
#[derive(Debug, Clone, Args)]
pub struct OutlineFlags {
    /// Leave out triangles with an edge longer than this, also inside
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    kill: Option<f64>,

    /// Leave out what is outside of the concave outline: triangles that are reached from the convex hull across
    /// edges longer than this. Holes inside, such as lakes, stay covered
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    concave: Option<f64>,

    /// Leave out what is outside of these polygons: GeoJSON, or WKT such as POLYGON((0 0,9 0,9 9,0 0)), in
    /// coordinates of the mesh
    #[arg(long, value_name = "FILE")]
    mask: Option<PathBuf>,
}

impl OutlineFlags {
    /// The greatest length of edges.
    ///
    /// # Errors
    /// Usage, if it is not above zero.
    pub fn kill(&self) -> Result<Option<f64>> {
        length("--kill", self.kill)
    }

    /// The greatest length of edges that a concave outline does not cross.
    ///
    /// # Errors
    /// Usage, if it is not above zero.
    pub fn concave(&self) -> Result<Option<f64>> {
        length("--concave", self.concave)
    }

    /// The file of the mask.
    pub fn mask_path(&self) -> Option<&Path> {
        self.mask.as_deref()
    }

    /// The polygons of the mask.
    ///
    /// # Errors
    /// If the file cannot be read, or is malformed.
    pub fn mask(&self) -> Result<Option<Arc<Mask>>> {
        let Some(path) = &self.mask else { return Ok(None) };
        let (input, name) = open_held(path)?;
        read_mask(input).map(|mask| Some(Arc::new(mask))).map_err(|error| error.of_input(name))
    }
}

/// Checks a length.
///
/// # Errors
/// Usage, if it is not above zero.
pub fn length(flag: &str, length: Option<f64>) -> Result<Option<f64>> {
    match length {
        Some(length) if length.is_nan() || length <= 0.0 => {
            Err(Error::usage(format!("{flag} takes a length above zero")))
        }
        length => Ok(length),
    }
}
