//! Figures of a run.

use std::time::Duration;

/// Figures of a run: the columns of table 5.1 of the thesis, and more.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Stats {
    /// Points written.
    pub points: u64,
    /// Points dropped because a coordinate is not finite.
    pub invalid: u64,
    /// Points dropped because their cell keeps another.
    pub thinned: u64,
    /// Every pass over the input with its time, in order.
    pub passes: Vec<(&'static str, Duration)>,
    /// Level of the deepest leaf.
    pub level: u8,
    /// Leaves: occupied cells that are tagged.
    pub occupied_cells: u64,
    /// Maximal empty cells, tagged at the start.
    pub empty_cells: u64,
    /// Points in the fullest leaf.
    pub cell_points_max: u64,
    /// High-water mark of points that wait for their cell, in memory and on disk.
    pub buffered_points_max: u64,
    /// High-water mark of the memory of waiting points, in bytes.
    pub buffered_bytes_max: u64,
    /// Points that waited on disk.
    pub spilled_points: u64,
    /// Those of them that did although there was memory, because their cell had got no points for long.
    pub cold_points: u64,
    /// Bytes of the temporary file for waiting points.
    pub spilled_bytes: u64,
    /// Points kept for later passes.
    pub spooled_points: u64,
    /// Bytes of the temporary file for kept points.
    pub spooled_bytes: u64,
}

impl Stats {
    /// Average number of points in a leaf.
    pub fn cell_points_avg(&self) -> f64 {
        self.points as f64 / self.occupied_cells.max(1) as f64
    }
}
