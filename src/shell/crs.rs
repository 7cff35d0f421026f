//! The flag for a coordinate reference system.

use clap::Args;

use spmesh_base::error::Result;
use spmesh_stream::Crs;

/// The coordinate reference system that a user states.
#[derive(Debug, Clone, Args)]
pub struct CrsFlag {
    /// The coordinate reference system, whatever the input states: EPSG:CODE, EPSG:CODE+CODE with one for
    /// heights, well-known text, or a file of it (.prj). Coordinates stay as they are
    #[arg(long, value_name = "CRS")]
    crs: Option<String>,
}

impl CrsFlag {
    /// What was given.
    pub fn text(&self) -> Option<&str> {
        self.crs.as_deref()
    }

    /// The system, if the flag is given.
    ///
    /// # Errors
    /// As [`spmesh_formats::crs::requested`].
    pub fn system(&self) -> Result<Option<Crs>> {
        self.crs.as_deref().map(spmesh_formats::crs::requested).transpose()
    }
}
