//! What a computation on points or lines refuses.

use std::{fmt, io};

use crate::points::Point2;

/// Result of every fallible operation of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// Why points or lines could not be computed with. The output is as it was, or
/// empty where the work had begun.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum Error {
    /// There are more points than the kernel can number.
    TooManyPoints {
        /// How many there are.
        count: usize,
        /// How many it takes.
        most: usize,
    },
    /// More tetrahedra would arise than the kernel may make.
    TooManyTetrahedra(usize),
    /// Somebody stopped the kernel ([`Watch::stop`](crate::Watch::stop)).
    Stopped,
    /// A coordinate or a weight is infinite or not a number.
    NotFinite {
        /// Index of the point.
        point: usize,
        /// What is wrong with it, with its numbers.
        found: String,
    },
    /// A vertex of a line is farther from the origin of the grid than `most` along an axis.
    BeyondGrid {
        /// Where it is.
        place: [i64; 2],
        /// The greatest magnitude of a coordinate.
        most: i64,
    },
    /// Lines have more crossings or bends than allowed.
    TooManyOfLines {
        /// "crossings" or "bends".
        what: &'static str,
        /// How many may be.
        most: usize,
    },
    /// Crossings and bends of lines need more memory than allowed.
    LinesBeyondMemory {
        /// How many crossings were found so far.
        crossings: usize,
        /// How many bends of segments.
        bends: usize,
    },
    /// A segment has an end that is no point.
    NoSuchPoint {
        /// Index of the segment.
        segment: usize,
        /// The indices that its ends name.
        ends: [u32; 2],
    },
    /// Two segments cross between their ends; one of them is this one.
    Crossing([Point2; 2]),
}

impl Error {
    /// A coordinate of a point that is infinite or not a number.
    pub fn not_finite(point: usize, coordinates: &[f64]) -> Error {
        Error::NotFinite { point, found: format!("coordinate is not finite: {coordinates:?}") }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::TooManyPoints { count, most } => {
                write!(f, "{count} points in one piece, the kernel takes at most {most}")
            }
            Error::TooManyTetrahedra(most) => write!(f, "more than {most} tetrahedra, the kernel's maximum"),
            Error::Stopped => f.write_str("stopped"),
            Error::NotFinite { point, found } => write!(f, "point {point}: {found}"),
            Error::BeyondGrid { place, most } => {
                write!(f, "a vertex of a line at {place:?} on the grid, the most is {most}")
            }
            Error::TooManyOfLines { what, most } => {
                write!(f, "the lines have more than {most} {what}: divide them, or leave lines out")
            }
            Error::LinesBeyondMemory { crossings, bends } => {
                write!(
                    f,
                    "the lines have {crossings} crossings and {bends} bends so far, more than memory has room for"
                )
            }
            Error::NoSuchPoint { segment, ends } => {
                write!(f, "segment {segment} is between points {ends:?}, of which one is missing")
            }
            Error::Crossing([[x, y], [u, v]]) => write!(f, "segments cross between {x}, {y} and {u}, {v}"),
        }
    }
}

impl std::error::Error for Error {}

impl From<Error> for io::Error {
    /// `InvalidInput`: the request is too large for a kernel. `InvalidData`: points or lines are wrong, or
    /// lines cross too often. `OutOfMemory`: lines cross too often for the memory allowed. `Other`: the work has become too large, or was stopped.
    fn from(error: Error) -> io::Error {
        let kind = match error {
            Error::TooManyPoints { .. } => io::ErrorKind::InvalidInput,
            Error::LinesBeyondMemory { .. } => io::ErrorKind::OutOfMemory,
            Error::TooManyTetrahedra(_) | Error::Stopped => io::ErrorKind::Other,
            _ => io::ErrorKind::InvalidData,
        };
        io::Error::new(kind, error)
    }
}
