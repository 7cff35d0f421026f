//! What is kept of the points of a cell, and the statistics that follow from it.

use bytemuck::{Pod, Zeroable};

use spmesh_base::error::{Error, Result};
use spmesh_stream::model::attributes::Column;
use spmesh_stream::{Coordinates, Header};

/// What a cell holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Statistic {
    /// The number of points.
    Count,
    /// The number of points for each unit of area.
    Density,
    /// The least value.
    Min,
    /// The greatest value.
    Max,
    /// The greatest value less the least one.
    Range,
    /// The mean of the values.
    Mean,
    /// The standard deviation of the values: that of the points in the cell, not of a population.
    Std,
}

impl Statistic {
    /// Whether it is in the unit of the values, and positions count: not numbers of points.
    pub(super) fn is_value(self) -> bool {
        !matches!(self, Statistic::Count | Statistic::Density)
    }

    /// The value of a cell of some area; NaN if it has none. Rounded once, from exact sums.
    pub(super) fn of(self, cell: &Cell, steps: &Steps, area: f64) -> f32 {
        let count = cell.count as f64;
        if !self.is_value() {
            return (if self == Statistic::Count { count } else { count / area }) as f32;
        }
        if cell.count == 0 {
            return f32::NAN;
        }
        let value = match self {
            Statistic::Min => steps.to_value(cell.min as f64),
            Statistic::Max => steps.to_value(cell.max as f64),
            Statistic::Range => (cell.max - cell.min) as f64 * steps.unit,
            Statistic::Mean => steps.to_value(quotient(cell.sum, cell.count)),
            _ => {
                // n times the sum of squared deviations, without a rounding.
                let count = i128::from(cell.count);
                let squares = count.checked_mul(cell.squares);
                let spread =
                    squares.zip(cell.sum.checked_mul(cell.sum)).map(|(squares, square)| squares - square);
                let spread = spread.map_or_else(|| cell.spread(), |spread| spread as f64);
                spread.max(0.0).sqrt() / cell.count as f64 * steps.unit
            }
        };
        value as f32
    }
}

/// A sum divided by a count, to one rounding more than the quotient: whole and fraction are exact.
fn quotient(sum: i128, count: u64) -> f64 {
    let count = i128::from(count);
    (sum.div_euclid(count)) as f64 + sum.rem_euclid(count) as f64 / count as f64
}

/// What is kept of the points of a cell: number, extremes, sums of values and of their squares, in steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Cell {
    sum: i128,
    squares: i128,
    count: u64,
    min: i64,
    max: i64,
    unused: u64,
}

impl Default for Cell {
    fn default() -> Cell {
        Cell { sum: 0, squares: 0, count: 0, min: i64::MAX, max: i64::MIN, unused: 0 }
    }
}

impl Cell {
    /// Counts a point with this value.
    #[inline]
    pub(super) fn add(&mut self, steps: i64) -> Result<()> {
        let wide = i128::from(steps);
        let sums = self.sum.checked_add(wide).zip(self.squares.checked_add(wide * wide));
        (self.sum, self.squares) = sums.ok_or_else(|| {
            Error::usage("values are too great to add them up: scale them, or take smaller cells")
        })?;
        self.count += 1;
        self.min = self.min.min(steps);
        self.max = self.max.max(steps);
        Ok(())
    }

    /// n times the sum of squared deviations, where the product of sums needs more than 128 bits.
    fn spread(&self) -> f64 {
        let mean = quotient(self.sum, self.count);
        let count = self.count as f64;
        (self.squares as f64 - mean * mean * count) * count
    }
}

/// Values as integers: value = steps * unit + offset.
#[derive(Debug, Clone, Copy)]
pub(super) struct Steps {
    unit: f64,
    offset: f64,
    /// Steps for each unit of what is read: 1 for stored integers.
    per_value: f64,
}

/// Steps in a unit of an attribute: its integers are exact, and fractions are good to a millionth.
const ATTRIBUTE_STEPS: f64 = (1u64 << 20) as f64;

/// Elevations in floating point are rounded to a step of this part of the greatest one.
const ELEVATION_BITS: i32 = 44;

/// Greatest number of steps: squares of 2^60 of them fit 128 bits for a few points, those of 2^44 for any number.
const STEPS_MAX: f64 = (1u64 << 60) as f64;

impl Steps {
    /// The steps of the elevations of a stream, or of an attribute.
    pub(super) fn of(header: &Header, column: Option<&Column>) -> Steps {
        if column.is_some() {
            return Steps { unit: 1.0 / ATTRIBUTE_STEPS, offset: 0.0, per_value: ATTRIBUTE_STEPS };
        }
        if let Coordinates::I32 { scale, offset } = header.coordinates {
            return Steps { unit: scale[2], offset: offset[2], per_value: 1.0 };
        }
        let greatest = header.bounds.map_or(1.0, |bounds| bounds.min[2].abs().max(bounds.max[2].abs()));
        // A power of two, so that nothing is rounded but the steps.
        let exponent = greatest.max(f64::MIN_POSITIVE).log2().ceil().max(-900.0) as i32 - ELEVATION_BITS;
        let unit = 2f64.powi(exponent);
        Steps { unit, offset: 0.0, per_value: 1.0 / unit }
    }

    /// The nearest number of steps.
    #[inline]
    pub(super) fn to_steps(self, value: f64) -> Result<i64> {
        let steps = (value * self.per_value).round();
        if steps.abs() <= STEPS_MAX {
            return Ok(steps as i64);
        }
        Err(Error::usage(format!("value {value} is too great to add values up: scale them")))
    }

    fn to_value(self, steps: f64) -> f64 {
        steps * self.unit + self.offset
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHOLE: Steps = Steps { unit: 0.5, offset: 10.0, per_value: 1.0 };

    fn cell(values: &[i64]) -> Cell {
        let mut cell = Cell::default();
        values.iter().for_each(|&value| cell.add(value).unwrap());
        cell
    }

    #[test]
    fn statistics_are_those_of_the_points() {
        let cell = cell(&[1, 4, -2, 4]);
        let value = |statistic: Statistic| statistic.of(&cell, &WHOLE, 0.25);
        assert_eq!((value(Statistic::Count), value(Statistic::Density)), (4.0, 16.0));
        assert_eq!((value(Statistic::Min), value(Statistic::Max), value(Statistic::Range)), (9.0, 12.0, 3.0));
        assert_eq!(value(Statistic::Mean), 10.0 + 0.5 * 1.75);
        let variance = (1.0 + 16.0 + 4.0 + 16.0) / 4.0 - 1.75 * 1.75;
        assert_eq!(value(Statistic::Std), (0.5 * f64::sqrt(variance)) as f32);
    }

    #[test]
    fn cells_without_points_have_no_value_but_a_number() {
        let value = |statistic: Statistic| statistic.of(&Cell::default(), &WHOLE, 1.0);
        assert_eq!((value(Statistic::Count), value(Statistic::Density)), (0.0, 0.0));
        for statistic in [Statistic::Min, Statistic::Max, Statistic::Range, Statistic::Mean, Statistic::Std] {
            assert!(value(statistic).is_nan(), "{statistic:?}");
        }
    }

    #[test]
    fn deviations_do_not_drown_in_large_values() {
        let large = 1i64 << 40;
        let cell = cell(&[large, large + 2, large - 2]);
        let unit = Steps { unit: 1.0, offset: 0.0, per_value: 1.0 };
        assert_eq!(Statistic::Std.of(&cell, &unit, 1.0), (8.0f64 / 3.0).sqrt() as f32);
        assert!(unit.to_steps(2e18).is_err() && unit.to_steps(f64::INFINITY).is_err());
    }
}
