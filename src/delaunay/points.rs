//! Points by their coordinates.

/// A point of the plane: x, y; both finite. Integer coordinates are stored as integer-valued `f64`.
pub type Point2 = [f64; 2];

/// A point of space: x, y, z; all finite. Integer coordinates are stored as integer-valued `f64`.
pub type Point3 = [f64; 3];
