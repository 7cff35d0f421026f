//! Noding of polylines by snap rounding: from polylines that cross and overlap to segments that meet at
//! common vertices only, all on a grid of integers.
//!
//! A *hot pixel* is the half-open unit square around a vertex, or around the grid place nearest to a
//! crossing. Every segment that passes through a hot pixel is bent to its centre. Hobby, and Guibas and
//! Marimont, prove that no new crossing arises; `docs/theory/noding.md` states the proof for half-open
//! pixels.
//!
//! Steps: vertices at one place become one (`nodes`); overlapping parts of a line become one segment
//! (`collinear`); a recursive division of the plane finds crossings, and the segments in each hot pixel
//! (`search`, with `chords`); segments are bent, and elevations found (`bend`).
//!
//! Sources: J. D. Hobby, "Practical segment intersection with finite precision output", Computational
//! Geometry 13 (1999); L. J. Guibas and D. H. Marimont, "Rounding arrangements dynamically", International
//! Journal of Computational Geometry and Applications 8 (1998). Both sweep the plane. The division here needs
//! no order of crossings along a sweep line, so each decision is one exact sign.

mod bend;
mod chords;
mod collinear;
mod exact;
mod nodes;
mod search;

use std::borrow::Cow;

use crate::error::{Error, Result};
use crate::network::NetworkSegment;

pub use chords::Chains;
pub use exact::COORDINATE_MAX;
use nodes::{Parts, Places};

/// A vertex of a polyline.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LineVertex {
    /// Coordinates on the grid, of at most [`COORDINATE_MAX`] in magnitude.
    pub place: [i64; 2],
    /// Elevation, if the line states one here.
    pub z: Option<f64>,
}

/// What noding changes about lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum NodingChange {
    /// A new vertex where lines cross.
    Crossing,
    /// A vertex to which a segment was bent that did not end there.
    Touch,
    /// A segment that several parts of lines have in common.
    Overlap,
    /// A part of a line that goes back along the part before it.
    Spike,
    /// A part of a line between vertices at one place.
    ZeroLength,
    /// A line of one place.
    SingleVertex,
    /// A vertex for which lines state or imply several elevations.
    ConflictingElevation,
}

/// Lines after noding.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Noded {
    /// In lexicographic order of their places, which are all different.
    pub vertices: Vec<LineVertex>,
    /// In increasing order of their ends. They have nothing in common but ends.
    pub segments: Vec<NetworkSegment>,
}

/// How lines are noded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NodingOptions {
    /// Whether elevations between vertices are rounded to integers.
    pub round_elevations: bool,
    /// Most crossings.
    pub crossings_max: usize,
    /// Bytes for crossings and bends: [`CROSSING_BYTES`] and [`BEND_BYTES`] for each.
    pub bytes_max: u64,
}

/// Memory of a crossing: its place, elevation and vertex.
pub const CROSSING_BYTES: u64 = 64;

/// Memory of each place where a segment bends: its pieces, before and after they are sorted.
pub const BEND_BYTES: u64 = 40;

/// Nodes polylines: `starts` are the numbers of the first vertices of each, in increasing order. `note` is
/// told each change with the number of a line and a place.
///
/// The same lines give the same result in any order and direction, up to the numbers of lines.
///
/// A vertex takes the lowest elevation that lines state at its place. If none does, elevations are
/// interpolated between the next vertices before and behind that have one, along each segment with an
/// elevation at both of its ends that passes; the lowest counts.
///
/// Memory: about 75 bytes per vertex, in which the result has room, and that of crossings and bends. Vertices
/// that are owned are freed early.
///
/// # Errors
/// If a coordinate exceeds [`COORDINATE_MAX`], or there are more crossings than `options` allow, or have memory for.
///
/// Cost: O(n log n) steps for n vertices, plus O(log) of the extent for each crossing and each bend; more
/// where many segments that are not parallel run close beside each other.
pub fn node_lines(
    vertices: Cow<[LineVertex]>,
    starts: &[u32],
    options: &NodingOptions,
    note: &mut dyn FnMut(NodingChange, u32, [i64; 2]),
) -> Result<Noded> {
    check(&vertices)?;
    let places = Places::of(&vertices);
    let parts = Parts::of(&places, &vertices, starts, note);
    drop(vertices);
    let segments = collinear::merge(&places.places, parts);
    let found = search::search(&places.places, &segments, options)?;
    Ok(bend::bend(places, starts, segments, found, options, note))
}

fn check(vertices: &[LineVertex]) -> Result<()> {
    let range = -COORDINATE_MAX..=COORDINATE_MAX;
    match vertices.iter().find(|vertex| vertex.place.iter().any(|value| !range.contains(value))) {
        Some(vertex) => Err(Error::BeyondGrid { place: vertex.place, most: COORDINATE_MAX }),
        None => Ok(()),
    }
}
