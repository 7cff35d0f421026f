//! The scale of residuals near each place, so that structures are told from gross errors.
//!
//! A smooth spline rounds off the edges of terrain, where slopes break: residuals next to an edge are many
//! scales, and there are many of them. A gross error is alone. So a residual is compared with those nearby:
//! the local scale follows from the quantile of magnitudes in a square of three by three cells, if that is
//! greater than the scale of all residuals. A tenth of the observations there may be gross errors.

use super::polygon;
use crate::bases::Basis;
use spmesh_delaunay::predicates::Point2;

/// The quantile of magnitudes that a local scale follows from...
const QUANTILE: f64 = 0.9;
/// ...and that of normal errors, in standard deviations.
const NORMAL: f64 = 1.644_853_626_951_472;
/// The greatest local scale, in scales of all residuals: where nearly all observations are gross errors, they
/// are still rejected.
const FACTOR_MAX: f64 = 8.0;
/// Observations per cell, if there are as many cells as that.
const PER_CELL: u64 = 4;
/// With fewer observations in a square of cells, there is no local scale.
const OBSERVATIONS_MIN: u32 = 8;
/// Bits below those that determine the class of a factor: 2 bits of the fraction are above.
const SHIFT: u32 = 50;
/// Classes of factors: those less than one, four for each power of two, and those of at least the maximum.
const CLASSES: usize = 14;

/// A grid of cells over the domain of a basis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cells {
    lower: Point2,
    side: f64,
    counts: [usize; 2],
}

/// Counts the magnitudes of residuals in each cell, by classes of their ratio to a unit. Memory: 28 bytes per
/// cell.
pub(super) struct LocalSketch {
    unit: f64,
    counts: Vec<[u16; CLASSES]>,
}

/// The scale near each place, where it exceeds that of all residuals.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LocalScales {
    cells: Cells,
    /// For each cell; zero where the scale of all residuals counts.
    scales: Vec<f64>,
}

impl Cells {
    /// About four observations per cell, but no more cells than functions: residuals are no finer than these.
    pub(super) fn of(basis: &Basis, observations: u64) -> Cells {
        let corners = basis.domain_corners();
        let (mut lower, mut upper) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for corner in &corners {
            lower = [0, 1].map(|axis| lower[axis].min(corner[axis]));
            upper = [0, 1].map(|axis| upper[axis].max(corner[axis]));
        }
        let count = (observations / PER_CELL).clamp(1, basis.len().max(1) as u64) as f64;
        let side = (polygon::area(&corners) / count).sqrt();
        if !(side > 0.0 && side.is_finite()) {
            return Cells { lower: [0.0; 2], side: f64::INFINITY, counts: [1; 2] };
        }
        // A long and narrow domain may not have more cells in its box than twice as many as in itself.
        let counts = [0, 1].map(|axis| ((upper[axis] - lower[axis]) / side).ceil().clamp(1.0, 2.0 * count));
        Cells { lower, side, counts: counts.map(|count| count as usize) }
    }

    /// The cell of a place; the nearest one for places outside.
    pub(super) fn at(&self, point: Point2) -> u32 {
        let [column, row] = [0, 1].map(|axis| {
            // Negative quotients become zero.
            (((point[axis] - self.lower[axis]) / self.side) as usize).min(self.counts[axis] - 1)
        });
        (row * self.counts[0] + column) as u32
    }

    fn len(&self) -> usize {
        self.counts[0] * self.counts[1]
    }

    /// The cells of the square around a cell.
    fn around(&self, cell: usize) -> impl Iterator<Item = usize> {
        let [columns, rows] = self.counts;
        let (column, row) = (cell % columns, cell / columns);
        let near = |at: usize, count: usize| at.saturating_sub(1)..(at + 2).min(count);
        near(row, rows).flat_map(move |row| near(column, columns).map(move |column| row * columns + column))
    }
}

impl LocalSketch {
    /// No residuals yet; `scale` is that of all residuals, as far as it is known.
    pub(super) fn new(cells: &Cells, scale: f64) -> LocalSketch {
        LocalSketch { unit: NORMAL * scale, counts: vec![[0; CLASSES]; cells.len()] }
    }

    pub(super) fn add(&mut self, cell: u32, residual: f64) {
        let count = &mut self.counts[cell as usize][class(residual.abs() / self.unit)];
        *count = count.saturating_add(1);
    }

    pub(super) fn scales(&self, cells: &Cells) -> LocalScales {
        let scale = |cell: usize| {
            let mut sums = [0u32; CLASSES];
            for near in cells.around(cell) {
                sums.iter_mut().zip(self.counts[near]).for_each(|(sum, count)| *sum += u32::from(count));
            }
            let all: u32 = sums.iter().sum();
            let enough = (QUANTILE * f64::from(all)).ceil() as u32;
            let mut below = 0;
            let is_reached = |count: &u32| {
                below += count;
                below >= enough
            };
            let class = sums.iter().position(is_reached).filter(|_| all >= OBSERVATIONS_MIN);
            class.map_or(0.0, factor) * self.unit / NORMAL
        };
        LocalScales { scales: (0..cells.len()).map(scale).collect(), cells: cells.clone() }
    }
}

impl LocalScales {
    /// No local scales, for the cells that they will be measured in.
    pub(super) fn none(cells: Cells) -> LocalScales {
        LocalScales { scales: vec![0.0; cells.len()], cells }
    }

    pub(super) fn cells(&self) -> &Cells {
        &self.cells
    }

    /// The scale at a place: at least `scale`, that of all residuals.
    pub(super) fn at(&self, point: Point2, scale: f64) -> f64 {
        self.scales[self.cells.at(point) as usize].clamp(scale, FACTOR_MAX * scale)
    }
}

fn class(factor: f64) -> usize {
    let one = 1f64.to_bits() >> SHIFT;
    let class = (factor.to_bits() >> SHIFT).saturating_sub(one - 1);
    (class as usize).min(CLASSES - 1)
}

/// The middle of a class; zero for factors less than one.
fn factor(class: usize) -> f64 {
    if class == 0 {
        return 0.0;
    }
    let lowest = (1f64.to_bits() >> SHIFT) + class as u64 - 1;
    f64::from_bits((lowest << SHIFT) + (1 << (SHIFT - 1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CELLS: Cells = Cells { lower: [0.0; 2], side: 1.0, counts: [20, 10] };

    #[test]
    fn classes_are_a_quarter_wide() {
        assert_eq!((class(0.99), class(1.0), class(1.24), class(1.25)), (0, 1, 1, 2));
        assert_eq!((class(1.99), class(2.0), class(7.9), class(8.0), class(1e300)), (4, 5, 12, 13, 13));
        assert_eq!((class(f64::NAN), class(f64::INFINITY), factor(0)), (13, 13, 0.0));
        for at in [1.0, 1.3, 2.2, 5.5, 7.9] {
            assert!((factor(class(at)) / at - 1.0).abs() <= 0.125, "{at}");
        }
    }

    #[test]
    fn many_great_residuals_are_a_structure_and_one_is_not() {
        let mut sketch = LocalSketch::new(&CELLS, 2.0);
        for (cell, i) in (0..200).flat_map(|cell| (0..4).map(move |i| (cell, i))) {
            let is_structure = CELLS.at([15.5, 5.5]).abs_diff(cell) <= 2 && i > 0;
            let is_gross = cell % 7 == 3 && i == 0;
            sketch.add(cell, if is_structure || is_gross { -24.0 } else { 1.0 });
        }
        let scales = sketch.scales(&CELLS);
        assert_eq!(scales.at([4.5, 5.5], 2.0), 2.0);
        let structure = scales.at([15.5, 5.5], 2.0);
        assert!(structure > 2.0 && structure <= FACTOR_MAX * 2.0, "{structure}");
        // Places outside belong to the nearest cell.
        assert_eq!((CELLS.at([-9.0, -9.0]), CELLS.at([1e9, 1e9])), (0, 199));
    }
}
