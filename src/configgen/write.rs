//! Configurations to streams.

use std::io::Write;

use crate::config::{Configurations, Knots};
use crate::error::{Error, Result};

/// Writes the stream of configurations.
///
/// # Errors
/// Always: there is no such stream kind.
pub fn write_configurations(_knots: &Knots, _degrees: &[Configurations], _out: impl Write) -> Result<()> {
    Err(Error::usage("the stream of configurations is not there yet: use --centroids or --stats with it"))
}
