//! Writes configurations, and splines over them, as a stream.

use std::io::Write;

use crate::model::bounds::{Bounds, Point};
use crate::model::configurations::Configurations;
use crate::model::functions::Function;
use crate::model::points::Point2;
use crate::{ConfigurationBlock, Coordinates, Crs, Header, Kind, StreamWriter};
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::CONFIGURATION_DEGREE_MAX;

/// Boundaries that are passed to the writer at a time.
const BATCH: usize = 1 << 12;

/// The contents of a stream of configurations or of a spline, without its header.
#[derive(Debug, Clone, Copy)]
pub struct Content<'a> {
    /// The knots, in stored coordinates; integers if the header says so.
    pub knots: &'a [Point2],
    /// The z of all knots, if the header says that they have an elevation.
    pub heights: Option<&'a [f64]>,
    /// Configurations of increasing degrees; of one degree for splines.
    pub degrees: &'a [Configurations],
    /// Functions of quadratic splines; empty if they are the B-splines of links.
    pub functions: &'a [Function],
    /// For splines, a coefficient for each function.
    pub coefficients: &'a [f64],
}

impl<'a> Content<'a> {
    /// The contents of a stream of configurations only.
    pub fn of(knots: &'a [Point2], degrees: &'a [Configurations]) -> Content<'a> {
        Content { knots, heights: None, degrees, functions: &[], coefficients: &[] }
    }
}

/// Writes knots and their configurations of increasing degrees, in world coordinates of an unknown system.
///
/// # Errors
/// As [`write_content`].
pub fn write_configurations(knots: &[Point2], degrees: &[Configurations], out: impl Write) -> Result<()> {
    write_content(
        configurations_header(knots, Coordinates::F64, Crs::Unknown),
        Content::of(knots, degrees),
        out,
    )
}

/// The header of a stream of configurations of knots in stored coordinates, without heights.
pub fn configurations_header(knots: &[Point2], coordinates: Coordinates, crs: Crs) -> Header {
    let mut header = Header::new(Kind::Configurations, coordinates, 2, false);
    header.points = Some(knots.len() as u64);
    header.bounds = Bounds::of_points(&stored(knots, None));
    header.crs = crs;
    header
}

/// Writes a stream of configurations, or of a spline. The header is from [`configurations_header`], or
/// similar.
///
/// # Errors
/// Usage, if degrees do not increase, a degree is too high, or heights do not match header and knots;
/// malformed, if a coordinate does not fit the header, configurations or functions name unknown knots, or a
/// spline does not have one coefficient for each function; I/O.
pub fn write_content(header: Header, content: Content, out: impl Write) -> Result<()> {
    let Content { knots, heights, degrees, functions, coefficients } = content;
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
    if !functions.is_empty() {
        writer.functions(functions)?;
    }
    if !coefficients.is_empty() {
        writer.coefficients(coefficients)?;
    }
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
    let empty = ConfigurationBlock::new(degree, configurations.claim());
    let mut block = empty.clone();
    // Write at least one block, so that the stream also has a degree without configurations.
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

fn stored(knots: &[Point2], heights: Option<&[f64]>) -> Vec<Point> {
    let height = |id: usize| heights.map_or(0.0, |heights| heights[id]);
    knots.iter().enumerate().map(|(id, &[x, y])| [x, y, height(id)]).collect()
}
