//! Configurations to streams.

use std::io::Write;

use crate::config::{Configurations, Knots};
use crate::error::{Error, Result};
use crate::stream::{Coordinates, Crs, Header, Kind};

/// Writes the stream of configurations of knots in world coordinates.
///
/// # Errors
/// As [`write_configurations_as`].
pub fn write_configurations(knots: &Knots, degrees: &[Configurations], out: impl Write) -> Result<()> {
    write_configurations_as(header(knots, Coordinates::F64, Crs::Unknown), knots, None, degrees, out)
}

/// The header of a stream of knots in stored coordinates, without heights.
#[must_use]
pub fn header(knots: &Knots, coordinates: Coordinates, crs: Crs) -> Header {
    let points = Some(knots.len() as u64);
    Header { points, crs, ..Header::new(Kind::Points, coordinates, 2, false) }
}

/// Writes knots and configurations with a header of [`header`], or one like it.
///
/// # Errors
/// Always: there is no such stream kind.
pub fn write_configurations_as(
    _header: Header,
    _knots: &Knots,
    _heights: Option<&[f64]>,
    _degrees: &[Configurations],
    _out: impl Write,
) -> Result<()> {
    Err(Error::usage(
        "the stream of configurations is not there yet: use --centroids, with --stats for counts",
    ))
}
