//! Writes configurations as a stream.

use std::io::Write;

use crate::bounds::{Bounds, Point};
use crate::config::{Configurations, Knots};
use crate::error::{Error, Result};
use crate::limits::CONFIGURATION_DEGREE_MAX;
use crate::stream::{ConfigurationBlock, Coordinates, Crs, Header, Kind, StreamWriter};

/// Boundaries that are handed to the writer at a time.
const BATCH: usize = 1 << 12;

/// Writes knots, and configurations of them of increasing degrees, in world coordinates of an unknown system.
///
/// # Errors
/// As [`write_configurations_as`].
pub fn write_configurations(knots: &Knots, degrees: &[Configurations], out: impl Write) -> Result<()> {
    write_configurations_as(header(knots, Coordinates::F64, Crs::Unknown), knots, None, degrees, out)
}

/// The header of a stream of knots in stored coordinates, without heights.
#[must_use]
pub fn header(knots: &Knots, coordinates: Coordinates, crs: Crs) -> Header {
    let mut header = Header::new(Kind::Configurations, coordinates, 2, false);
    header.points = Some(knots.len() as u64);
    header.bounds = Bounds::of_points(&stored(knots, None));
    header.crs = crs;
    header
}

/// Writes knots and configurations with a header of [`header`], or one like it; `heights` are the z of all knots, if it
/// says that they have an elevation. Knots are in stored coordinates: whole numbers if the header says so.
///
/// # Errors
/// Usage, if degrees do not increase, one is too high, or heights do not fit header and knots; malformed, if a coordinate
/// does not fit the header or configurations name knots that there are not; I/O.
pub fn write_configurations_as(
    header: Header,
    knots: &Knots,
    heights: Option<&[f64]>,
    degrees: &[Configurations],
    out: impl Write,
) -> Result<()> {
    if heights.map(<[f64]>::len) != header.has_elevation.then_some(knots.len()) {
        return Err(Error::usage(
            "there must be a height for each knot if the header says so, and none otherwise",
        ));
    }
    if let Some(pair) = degrees.windows(2).find(|pair| pair[0].degree() >= pair[1].degree()) {
        let (before, after) = (pair[0].degree(), pair[1].degree());
        return Err(Error::usage(format!(
            "cannot write degree {after} after degree {before}: degrees must increase"
        )));
    }
    let mut writer = StreamWriter::new(out, header)?;
    writer.points(&stored(knots, heights))?;
    degrees.iter().try_for_each(|configurations| write_degree(&mut writer, configurations))?;
    writer.end(0, 0).map(drop)
}

fn write_degree<W: Write>(writer: &mut StreamWriter<W>, configurations: &Configurations) -> Result<()> {
    let degree = u32::try_from(configurations.degree()).ok().filter(|&k| k <= CONFIGURATION_DEGREE_MAX);
    let Some(degree) = degree else {
        return Err(Error::usage(format!(
            "cannot write degree {}: streams have at most {CONFIGURATION_DEGREE_MAX}",
            configurations.degree()
        )));
    };
    let empty = ConfigurationBlock::new(degree, configurations.standing());
    let mut block = empty.clone();
    // At least one block, so that a degree without configurations is there.
    for group in configurations.groups() {
        for boundaries in group.triangles.chunks(BATCH).chain(group.infinite.chunks(BATCH)) {
            block.push(group.interior, boundaries);
            if block.boundaries.len() >= BATCH {
                writer.configurations(&block)?;
                block = empty.clone();
            }
        }
    }
    writer.configurations(&block)
}

fn stored(knots: &Knots, heights: Option<&[f64]>) -> Vec<Point> {
    let height = |id: usize| heights.map_or(0.0, |heights| heights[id]);
    knots.points().iter().enumerate().map(|(id, &[x, y])| [x, y, height(id)]).collect()
}
