//! Flags about the outline of a surface.

use std::path::{Path, PathBuf};
use std::slice;
use std::sync::Arc;

use clap::Args;

use super::refuse_terminal;
use spmesh_base::error::{Error, Result};
use spmesh_formats::source::{Mask, read_polygons};
use spmesh_stream::{Coordinates, Crs};

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

    /// Leave out what is outside of these polygons, in the system of the mesh: GeoJSON, Shapefile, GeoPackage
    /// (FILE.gpkg:LAYER for one layer), or WKT such as POLYGON((0 0,9 0,9 9,0 0))
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

    /// The polygons of the mask, for a surface in the system `crs`. They may take so many bytes of memory.
    /// `notice` gets messages for the user.
    ///
    /// # Errors
    /// As [`read_polygons`]; usage, if the file is a terminal.
    pub fn mask(
        &self,
        crs: &Crs,
        memory: Option<u64>,
        mut notice: impl FnMut(&str),
    ) -> Result<Option<Arc<Mask>>> {
        let Some(path) = &self.mask else { return Ok(None) };
        if path.as_os_str() == "-" {
            refuse_terminal()?;
        }
        let (path, memory) = (slice::from_ref(path), memory.unwrap_or(u64::MAX));
        let (polygons, notices) = read_polygons(path, &Coordinates::F64, crs, memory)?;
        notices.iter().for_each(|text| notice(text));
        Ok(Some(Arc::new(Mask { polygons })))
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
