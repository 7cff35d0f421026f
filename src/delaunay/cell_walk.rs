//! The cells of a grid that a segment meets.

use crate::points::Point2;

/// Places are off by far less than this after they are put on a grid. Unit: cells.
pub const TOLERANCE: f64 = 1e-6;

/// Calls `found` with the column and row of each cell that has a place within `reach` of a segment on both
/// axes, and perhaps of others beside it; row by row. Places and `reach` are in units of cells; what is
/// beyond the columns and rows of `size` counts for those at the border.
#[inline]
pub fn for_each_cell_within(
    ends: [Point2; 2],
    size: [usize; 2],
    reach: f64,
    mut found: impl FnMut([usize; 2]),
) {
    let [lower, upper] = if ends[0][1] <= ends[1][1] { ends } else { [ends[1], ends[0]] };
    // Conversions saturate: what is below zero becomes zero.
    let cell = |value: f64, axis: usize| (value as usize).min(size[axis] - 1);
    let [left, right] = [lower[0].min(upper[0]), lower[0].max(upper[0])];
    let [first_row, last_row] = [cell(lower[1] - reach, 1), cell(upper[1] + reach, 1)];
    let height = upper[1] - lower[1];
    let x_at = |y: f64| {
        let part = ((y - lower[1]) / height).clamp(0.0, 1.0);
        lower[0] + part * (upper[0] - lower[0])
    };
    for row in first_row..=last_row {
        let [mut low, mut high] = [left, right];
        if height > 0.0 {
            let xs = [row as f64 - reach, (row + 1) as f64 + reach].map(x_at);
            [low, high] = [xs[0].min(xs[1]), xs[0].max(xs[1])];
        }
        for column in cell(low - reach, 0)..=cell(high + reach, 0) {
            found([column, row]);
        }
    }
}
