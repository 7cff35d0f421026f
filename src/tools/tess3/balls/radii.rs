//! Radii as a user names them: by the name of a table, or by a file.

use std::fs::File;
use std::io::Read;
use std::sync::Arc;

use data_encoding::HEXLOWER;
use sha2::{Digest, Sha256};
use spmesh_core::error::{Error, Result};
use spmesh_core::limits::RADII_LEN_MAX;
use spmesh_io::source::structure::Radii;

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
    /// Usage, if it is neither; those of [`Radii::read_from`].
    pub fn load(name: &str) -> Result<NamedRadii> {
        if let Some(radii) = Radii::named(name) {
            return Ok(NamedRadii { radii: Arc::new(radii), text: name.to_string() });
        }
        let file = File::open(name).map_err(|e| {
            let tables = Radii::NAMES.join(", ");
            Error::usage(format!("--radii {name}: {e}; expected a file of radii, or one of {tables}"))
        })?;
        let mut content = Vec::new();
        let reading = |e| Error::io("reading", e).of_input(name);
        file.take(RADII_LEN_MAX + 1).read_to_end(&mut content).map_err(reading)?;
        if content.len() as u64 > RADII_LEN_MAX {
            let message = format!("more than {} MB: this is no file of radii", RADII_LEN_MAX >> 20);
            return Err(Error::malformed(message).of_input(name));
        }
        let sha256 = HEXLOWER.encode(&Sha256::digest(&content));
        let radii = Radii::read_from(std::io::Cursor::new(content), name)?;
        Ok(NamedRadii { radii: Arc::new(radii), text: format!("{name} ({sha256})") })
    }
}
