//! The grid that both surfaces are put on: integers are what makes the overlay exact.

use super::overlap::Vertex;
use spmesh_base::error::{Error, Result};
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::{Bounds, Point};

/// Greatest magnitude of coordinates, which makes differences fit the arithmetic of `overlap`.
const COORDINATE_MAX: f64 = (1u64 << 40) as f64;

/// Steps of the longer side of rounded coordinates.
const ROUNDED_STEPS: f64 = (1u64 << 39) as f64;

/// The common step is at least this part of that of each mesh.
const FACTOR_MAX: u32 = 256;

/// Vertices of polygons are rounded to this part of a step, if coordinates are not rounded.
const PARTS: i64 = 1024;

/// Binary digits behind the point of levels, in steps.
pub(super) const LEVEL_BITS: u32 = 20;

/// How the stored coordinates of a mesh become those of the grid.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Placing {
    /// Integers times a factor, and a shift.
    Exact { factors: [i64; 3], shifts: [i64; 3] },
    /// World coordinates are rounded.
    Rounded(Coordinates),
}

/// A grid of integers for the meshes of a comparison.
#[derive(Debug, Clone)]
pub(super) struct Grid {
    placings: Vec<Placing>,
    /// World coordinates of zero, and steps of each axis.
    origin: Point,
    steps: Point,
    /// Units of polygons in a step.
    pub(super) parts: i64,
}

impl Grid {
    /// The grid of one or two meshes by their coordinates and the boxes of their stored vertices; z may also
    /// be in a range of levels. Its order does not matter.
    ///
    /// If the meshes have integers, and the steps of one are in line with those of the other, the grid has
    /// all of their vertices. Otherwise vertices are rounded to a fine one.
    pub(super) fn of(meshes: &[(Coordinates, Bounds)], levels: Option<[f64; 2]>) -> Result<Grid> {
        if let Some(grid) = Grid::aligned(meshes) {
            return Ok(grid);
        }
        let worlds = meshes.iter().map(|(coordinates, bounds)| Bounds {
            min: coordinates.to_world(bounds.min),
            max: coordinates.to_world(bounds.max),
        });
        let mut all = worlds.reduce(Bounds::union).unwrap_or(Bounds::of_point([0.0; 3]));
        if let Some([low, high]) = levels {
            (all.min[2], all.max[2]) = (all.min[2].min(low), all.max[2].max(high));
        }
        let sides: Point = std::array::from_fn(|axis| all.max[axis] - all.min[axis]);
        if sides.iter().any(|side| !side.is_finite()) {
            return Err(Error::usage("coordinates are too great to compare: shift and scale them"));
        }
        let step = |side: f64| {
            let side = if side > 0.0 { side } else { 1.0 };
            2f64.powi(side.log2().ceil().max(-900.0) as i32) / ROUNDED_STEPS
        };
        let (plane, z) = (step(sides[0].max(sides[1])), step(sides[2]));
        let steps = [plane, plane, z];
        let origin = std::array::from_fn(|axis| (all.min[axis] / steps[axis]).floor() * steps[axis]);
        let placings = meshes.iter().map(|(coordinates, _)| Placing::Rounded(*coordinates)).collect();
        Ok(Grid { placings, origin, steps, parts: 1 })
    }

    fn aligned(meshes: &[(Coordinates, Bounds)]) -> Option<Grid> {
        let grids = meshes.iter().map(|(coordinates, _)| match coordinates {
            Coordinates::F64 => None,
            Coordinates::I32 { scale, offset } => Some((*scale, *offset)),
        });
        let grids: Vec<(Point, Point)> = grids.collect::<Option<_>>()?;
        let plane = Alignment::of(&grids, &[0, 1])?;
        let height = Alignment::of(&grids, &[2])?;
        let mut placings = Vec::new();
        for (mesh, (_, bounds)) in meshes.iter().enumerate() {
            let factors = [plane.factors[mesh], plane.factors[mesh], height.factors[mesh]];
            let shifts = [plane.shifts[mesh][0], plane.shifts[mesh][1], height.shifts[mesh][0]];
            let fits = |axis: usize| {
                let most = bounds.min[axis].abs().max(bounds.max[axis].abs());
                most * factors[axis] as f64 + shifts[axis].abs() as f64 <= COORDINATE_MAX
            };
            if !(0..3).all(fits) {
                return None;
            }
            placings.push(Placing::Exact { factors, shifts });
        }
        let origin = [plane.origin[0], plane.origin[1], height.origin[0]];
        Some(Grid { placings, origin, steps: [plane.step, plane.step, height.step], parts: PARTS })
    }

    /// Whether vertices are rounded; then to steps of these sizes.
    pub(super) fn rounded(&self) -> Option<[f64; 2]> {
        let is_rounded = self.placings.iter().any(|placing| matches!(placing, Placing::Rounded(_)));
        is_rounded.then_some([self.steps[0], self.steps[2]])
    }

    /// The area and the volume of a square and a cube of steps.
    pub(super) fn sizes(&self) -> [f64; 2] {
        let [x, y, z] = self.steps;
        [x * y, x * y * z]
    }

    /// A vertex of a mesh. Never decreases with a coordinate.
    #[inline]
    pub(super) fn vertex(&self, mesh: usize, stored: Point) -> Vertex {
        match &self.placings[mesh] {
            Placing::Exact { factors, shifts } => {
                std::array::from_fn(|axis| stored[axis] as i64 * factors[axis] + shifts[axis])
            }
            Placing::Rounded(coordinates) => {
                let world = coordinates.to_world(stored);
                std::array::from_fn(|axis| {
                    ((world[axis] - self.origin[axis]) / self.steps[axis]).round() as i64
                })
            }
        }
    }

    /// A place of a polygon, in units of polygons.
    pub(super) fn place(&self, world: [f64; 2]) -> [i64; 2] {
        [0, 1].map(|axis| {
            ((world[axis] - self.origin[axis]) / self.steps[axis] * self.parts as f64).round() as i64
        })
    }

    /// A level in units of 2^-20 steps; `None` if it is too far away.
    pub(super) fn level(&self, world: f64) -> Option<i64> {
        let steps = (world - self.origin[2]) / self.steps[2];
        let units = (steps * f64::from(1u32 << LEVEL_BITS)).round();
        (steps.abs() <= COORDINATE_MAX).then_some(units as i64)
    }
}

/// Grids of integers that have a grid in common, along axes with one step.
struct Alignment {
    step: f64,
    factors: Vec<i64>,
    /// Of each grid along each axis.
    shifts: Vec<Vec<i64>>,
    origin: Vec<f64>,
}

impl Alignment {
    /// The coarsest grid that has all places of one or two grids by their scales and offsets.
    fn of(grids: &[(Point, Point)], axes: &[usize]) -> Option<Alignment> {
        let scale = |(scale, _): &(Point, Point)| scale[axes[0]];
        let least = grids.iter().map(scale).fold(f64::INFINITY, f64::min);
        (1..=FACTOR_MAX).find_map(|parts| {
            let step = least / f64::from(parts);
            let factor = |grid: &_| integer(scale(grid) / step, f64::EPSILON);
            let factors: Vec<i64> = grids.iter().map(factor).collect::<Option<_>>()?;
            if factors.iter().any(|&factor| factor > i64::from(FACTOR_MAX)) {
                return None;
            }
            let lowest =
                |axis: &usize| grids.iter().map(|(_, offset)| offset[*axis]).fold(f64::INFINITY, f64::min);
            let origin: Vec<f64> = axes.iter().map(lowest).collect();
            // Offsets stand for decimals, from which they differ by roundings.
            let shift = |offset: f64, origin: f64| {
                integer((offset - origin) / step, f64::EPSILON * (offset.abs() + origin.abs()) / step)
            };
            let shifts = grids.iter().map(|(_, offset)| {
                axes.iter().zip(&origin).map(|(&axis, &origin)| shift(offset[axis], origin)).collect()
            });
            let shifts = shifts.collect::<Option<_>>()?;
            Some(Alignment { step, factors, shifts, origin })
        })
    }
}

/// The integer that a number stands for, which is off by at most some roundings of its size and by `error`.
fn integer(number: f64, error: f64) -> Option<i64> {
    let nearest = number.round();
    let slack = 4.0 * (error + f64::EPSILON * number.abs());
    (slack < 0.01 && (number - nearest).abs() <= slack && nearest.abs() <= COORDINATE_MAX)
        .then_some(nearest as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn integers(scale: f64, offset: f64) -> (Coordinates, Bounds) {
        let bounds = Bounds { min: [-1e6; 3], max: [1e6; 3] };
        (Coordinates::I32 { scale: [scale; 3], offset: [offset; 3] }, bounds)
    }

    #[test]
    fn decimal_grids_are_aligned() {
        for (a, b, vertices) in [
            (integers(0.01, 451_000.0), integers(0.01, 450_000.37), [99_963, 0]),
            (integers(0.01, 0.0), integers(0.001, 0.0005), [0, 1]),
            (integers(0.25, 0.0), integers(0.1, 0.0), [0, 0]),
        ] {
            let grid = Grid::of(&[a, b], None).unwrap();
            assert_eq!(grid.rounded(), None);
            let [of_a, of_b] = [0, 1].map(|mesh| grid.vertex(mesh, [0.0; 3])[0]);
            assert_eq!([of_a, of_b], vertices);
            let turned = Grid::of(&[b, a], None).unwrap();
            assert_eq!(turned.vertex(1, [7.0, 8.0, 9.0]), grid.vertex(0, [7.0, 8.0, 9.0]));
            assert_eq!((turned.origin, turned.steps), (grid.origin, grid.steps));
        }
    }

    #[test]
    fn other_grids_are_rounded() {
        let far = integers(0.01, 1e12);
        for other in [integers(0.010_000_001, 0.0), far, (Coordinates::F64, Bounds::of_point([7.5; 3]))] {
            let grid = Grid::of(&[integers(0.01, 0.0), other], Some([-3.0, 4.0])).unwrap();
            assert!(grid.rounded().is_some_and(|[step, _]| step < 1e12 * 2f64.powi(-37)));
            assert!(grid.level(4.0).is_some() && grid.level(1e200).is_none());
        }
    }
}
