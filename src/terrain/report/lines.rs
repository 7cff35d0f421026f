//! Flight lines against each other, in cells that several of them see.
//!
//! In a cell, a plane of one slope and an elevation for each of two lines are fitted to the single returns of
//! both, by least squares. The difference is that of their elevations. So a slope makes no difference between
//! lines whose points lie at different places of the cell, as it does between means of z.

use std::collections::BTreeMap;

use super::Options;
use super::fields::Carried;
use super::sample::{Differences, Pair, Sample};
use super::tally::Tally;
use crate::accumulators::Accumulators;
use crate::files::{TilePlace, tiles_of};
use spmesh_base::error::Result;
use spmesh_formats::raster::{Grid, TILE};
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::Point;

/// Steepest plane that counts, in degrees. Source: USGS, Lidar Base Specification 2024 rev. A, "Interswath
/// consistency".
pub const SLOPE_MAX: f64 = 10.0;
/// Fewest points of each line in a cell.
pub const POINTS_MIN: f64 = 3.0;
/// Classes that do not count: vegetation, noise, water.
pub const LEFT_OUT: [u8; 6] = [3, 4, 5, 7, 9, 18];
/// If the sine of the angle between axes of a cloud is less, squared, its points are on a line.
const FLAT: f64 = 1e-6;

/// Differences of flight lines.
#[derive(Debug)]
pub struct Overlap {
    /// Side of cells.
    pub cell: f64,
    /// All differences; `None` if there are none.
    pub all: Option<Differences>,
    /// Those of each pair of lines: the elevation of the first minus that of the second.
    pub pairs: Vec<(Pair, Differences)>,
    /// Pairs of lines in cells that are too steep, or whose points are on a line.
    pub steep: u64,
    /// Percentiles are those of the differences of one cell in so many.
    pub one_in: u64,
}

/// Number, and sums of x, y, z, xx, xy, yy, xz and yz of the points of a line in a cell, from its centre.
type Sums = [f64; 9];

/// Sums of lines, each in tiles of its own.
pub(super) struct Lines {
    sums: Accumulators<Sums>,
    /// The lines of each tile that has any.
    lines_of: BTreeMap<TilePlace, Vec<usize>>,
    grid: Grid,
    tiles: TilePlace,
    /// Flight lines in their order.
    sources: Vec<u16>,
    coordinates: Coordinates,
    /// Elevations count from here, so that sums have few digits.
    datum: f64,
    unit_of_z: f64,
    sample: Sample,
}

impl Lines {
    /// No sums; `None` if there are not two lines.
    pub(super) fn new(
        grid: &Grid,
        tally: &Tally,
        coordinates: Coordinates,
        options: &Options,
    ) -> Result<Option<Lines>> {
        let sources: Vec<u16> = tally.sources.iter().flat_map(|sources| sources.keys().copied()).collect();
        let (Some(bounds), 2..) = (tally.bounds, sources.len()) else { return Ok(None) };
        let sums = Accumulators::new([0.0; 9], grid, options.memory / 2, options.temp_dir.as_deref())?;
        let (tiles, sample) = (tiles_of(grid)?, Sample::new(options.memory / 8));
        let (datum, unit_of_z) = (bounds.min[2], options.unit_of_z);
        Ok(Some(Lines {
            sums,
            lines_of: BTreeMap::new(),
            grid: *grid,
            tiles,
            sources,
            coordinates,
            datum,
            unit_of_z,
            sample,
        }))
    }

    /// The tile of a line that has the cells of a tile of the grid. Those of other lines follow along the
    /// shorter axis, so that no number is large.
    fn layer(&self, at: TilePlace, line: usize) -> TilePlace {
        let axis = usize::from(self.tiles[1] < self.tiles[0]);
        let mut layer = at;
        layer[axis] += line * self.tiles[axis];
        layer
    }

    /// Adds a point in a cell of the grid.
    pub(super) fn add(&mut self, carried: &Carried, [column, row]: [usize; 2], stored: &Point) -> Result<()> {
        let is_left_out = carried.class.is_some_and(|class| LEFT_OUT.contains(&class));
        let line = carried.source.and_then(|source| self.sources.binary_search(&source).ok());
        let Some(line) = line.filter(|_| carried.is_single && !is_left_out) else { return Ok(()) };
        let world = self.coordinates.to_world(*stored);
        let [centre_x, centre_y] = self.grid.center(column as u32, row as u32);
        let (x, y, z) = (world[0] - centre_x, world[1] - centre_y, world[2] - self.datum);
        let at = [column / TILE, row / TILE];
        let tile = self.layer(at, line);
        if !self.sums.has(tile) {
            self.lines_of.entry(at).or_default().push(line);
        }
        let sums = self.sums.cell(tile, row % TILE * TILE + column % TILE)?;
        let added = [1.0, x, y, z, x * x, x * y, y * y, x * z, y * z];
        sums.iter_mut().zip(added).for_each(|(sum, value)| *sum += value);
        Ok(())
    }

    /// Compares lines.
    pub(super) fn finish(mut self) -> Result<Overlap> {
        let (mut steep, mut first) = (0, Vec::new());
        for (at, mut lines) in std::mem::take(&mut self.lines_of) {
            lines.sort_unstable();
            for (number, &one) in lines.iter().enumerate() {
                first.clear();
                let layer = self.layer(at, one);
                first.extend_from_slice(self.sums.read(layer)?.unwrap_or_default());
                for &other in &lines[number + 1..] {
                    steep += self.compare(at, one, &first, other)?;
                }
            }
        }
        let (all, pairs, one_in) = self.sample.finish();
        Ok(Overlap { cell: self.grid.step, all, pairs, steep, one_in })
    }

    /// Compares a line, which has the sums `first`, with another in a tile. Returns the number of cells
    /// without a difference.
    fn compare(&mut self, at: TilePlace, one: usize, first: &[Sums], other: usize) -> Result<u64> {
        let (layer, mut steep) = (self.layer(at, other), 0);
        let second = self.sums.read(layer)?.unwrap_or_default();
        let pair = [one, other].map(|line| self.sources[line]);
        let cells = first.iter().zip(second).enumerate();
        for (cell, (one, other)) in cells.filter(|(_, (one, other))| one[0].min(other[0]) >= POINTS_MIN) {
            let place = [at[0] * TILE + cell % TILE, at[1] * TILE + cell / TILE];
            match difference(one, other, self.unit_of_z) {
                Some(found) => self.sample.add(pair, place, found),
                None => steep += 1,
            }
        }
        Ok(steep)
    }
}

/// The elevation of the first line above the second; `None` where the plane is too steep, or points are on a
/// line.
fn difference(one: &Sums, other: &Sums, unit_of_z: f64) -> Option<f64> {
    let means = [one, other].map(|sums| [1, 2, 3].map(|axis| sums[axis] / sums[0]));
    // Sums of products around the means of each line, for both.
    let mut around = [0.0; 5];
    for (sums, [x, y, z]) in [one, other].into_iter().zip(means) {
        let products = [x * x, x * y, y * y, x * z, y * z];
        for (around, (sum, product)) in around.iter_mut().zip(sums[4..].iter().zip(products)) {
            *around += sum - sums[0] * product;
        }
    }
    let [xx, xy, yy, xz, yz] = around;
    let size = xx * yy - xy * xy;
    if size <= FLAT * xx * yy {
        return None;
    }
    let slope = [(xz * yy - yz * xy) / size, (yz * xx - xz * xy) / size];
    if slope[0].hypot(slope[1]) * unit_of_z >= SLOPE_MAX.to_radians().tan() {
        return None;
    }
    let [dx, dy, dz] = [0, 1, 2].map(|axis| means[0][axis] - means[1][axis]);
    // Coordinates may be so great that sums are not finite.
    Some(dz - slope[0] * dx - slope[1] * dy).filter(|found| found.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sums(points: &[[f64; 2]], z: impl Fn(f64, f64) -> f64) -> Sums {
        points.iter().fold([0.0; 9], |sums, &[x, y]| {
            let z = z(x, y);
            let added = [1.0, x, y, z, x * x, x * y, y * y, x * z, y * z];
            std::array::from_fn(|at| sums[at] + added[at])
        })
    }

    #[test]
    fn slopes_make_no_difference() {
        let (left, right) =
            ([[-1.0, 0.0], [-0.5, 1.0], [-0.9, -1.0]], [[1.0, 0.0], [0.5, 0.7], [0.9, -1.0], [0.4, 0.1]]);
        let plane = |rise: f64| move |x: f64, y: f64| 100.0 + rise + 0.1 * x - 0.05 * y;
        let found = difference(&sums(&left, plane(0.25)), &sums(&right, plane(0.0)), 1.0).unwrap();
        assert!((found - 0.25).abs() < 1e-12, "{found}");
        let steep = |x: f64, _: f64| 0.2 * x;
        assert_eq!(difference(&sums(&left, steep), &sums(&right, steep), 1.0), None);
        assert!(difference(&sums(&left, steep), &sums(&right, steep), 0.5).is_some());
        let straight = [[0.0, 0.0], [0.1, 0.1], [0.2, 0.2]];
        assert_eq!(difference(&sums(&straight, plane(0.0)), &sums(&straight, plane(0.0)), 1.0), None);
    }
}
