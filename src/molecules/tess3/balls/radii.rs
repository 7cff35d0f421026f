//! Radii as a user names them: by the name of a table, or by a file.

use std::sync::Arc;

use data_encoding::HEXLOWER;
use sha2::{Digest, Sha256};
use spmesh_base::error::Result;
use spmesh_formats::molecules::Radii;

/// Radii, and what they were called.
#[derive(Debug, Clone)]
pub struct NamedRadii {
    /// The radii.
    pub radii: Arc<Radii>,
    /// The name of the table; for a file also its SHA-256, so that a changed file has another text.
    pub text: String,
}

impl NamedRadii {
    /// The table of this name, or the radii in the file of this name, which is read once.
    ///
    /// # Errors
    /// Those of [`Radii::load`].
    pub fn load(name: &str) -> Result<NamedRadii> {
        let loaded = Radii::load(name)?;
        let text = match loaded.file {
            Some(content) => format!("{name} ({})", HEXLOWER.encode(&Sha256::digest(&content))),
            None => name.to_string(),
        };
        Ok(NamedRadii { radii: Arc::new(loaded.radii), text })
    }
}
