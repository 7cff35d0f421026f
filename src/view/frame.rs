//! Where the map of a picture is in the world.

/// From places of a picture's map to world coordinates: `x = left + unit * px` and `y = top - unit * py`, as places of
/// pictures are counted downwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// World x of the map's left side.
    pub left: f64,
    /// World y of the map's upper side.
    pub top: f64,
    /// World units of one unit of the picture. Domain: greater than zero.
    pub unit: f64,
}
