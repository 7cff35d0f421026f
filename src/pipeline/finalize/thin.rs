//! Thinning: one point of each square of the plane, or of each cube of space.
//!
//! The points of a cell may stand anywhere in the input. So a pass of its own finds the point that each cell
//! keeps, and notes the numbers of these points. Later passes keep only them. Memory: a table of the occupied
//! cells in the first pass, then 8 bytes per occupied cell.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::str::FromStr;

use super::batch::{PointBatch, read_ahead};
use super::budget::Budget;
use super::passes::{Keep, KeptPoints, Passes, input_changed};
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_formats::source::{Description, PointReader};
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::Point;

/// Cells beyond this distance from the origin, in cells, cannot be told apart in f64.
const INDEX_MAX: f64 = (1u64 << 50) as f64;

/// Greatest relative error of a quotient of two decimals in f64. What is so close to a border lies on it.
const BORDER_TOLERANCE: f64 = 4.0 * f64::EPSILON;

/// Steps of a cell's side in which distances from its centre are compared. They are coarser than rounding, so
/// that equal distances count as equal.
const CENTRE_STEPS: f64 = 1e7;

/// Which point of a cell is kept. Of equal ones, it is the first in the order of the input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ThinBy {
    /// The lowest.
    Lowest,
    /// The highest.
    Highest,
    /// The first in the order of the input.
    First,
    /// The one closest to the centre of the cell.
    NearestCentre,
}

/// Keeps one point per cell. Cells are half-open, and their corners are at multiples of their side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thin {
    /// Side of a cell in world units, positive.
    cell: f64,
    by: ThinBy,
}

impl FromStr for Thin {
    type Err = String;

    /// `CELL` or `CELL:RULE`.
    fn from_str(text: &str) -> std::result::Result<Thin, String> {
        let (cell, rule) = text.split_once(':').unwrap_or((text, "lowest"));
        let cell = cell.trim().parse().ok().filter(|cell: &f64| *cell > 0.0 && cell.is_finite());
        let cell = cell.ok_or_else(|| format!("{text:?} has no side of cells: expected as in 0.5:lowest"))?;
        let by = match rule {
            "lowest" => ThinBy::Lowest,
            "highest" => ThinBy::Highest,
            "first" => ThinBy::First,
            "nearest-centre" => ThinBy::NearestCentre,
            _ => {
                let expected = "expected lowest, highest, first or nearest-centre";
                return Err(format!("unknown rule {rule:?}, {expected}"));
            }
        };
        Ok(Thin { cell, by })
    }
}

impl Thin {
    /// The cell of a point on each of `D` axes, and its rank in the cell: the point with the least rank is kept.
    fn place<const D: usize>(&self, coordinates: &Coordinates, point: Point) -> Option<([i64; D], f64)> {
        let world = coordinates.to_decimal(point);
        let (mut cell, mut square) = ([0; D], 0.0);
        for axis in 0..D {
            let place = world[axis] / self.cell;
            if place.abs() > INDEX_MAX {
                return None;
            }
            let border = place.round();
            let is_on_border = (place - border).abs() <= BORDER_TOLERANCE * place.abs();
            let index = if is_on_border { border } else { place.floor() };
            cell[axis] = index as i64;
            square += ((place - index - 0.5) * CENTRE_STEPS).round().powi(2);
        }
        let rank = match self.by {
            ThinBy::Lowest => point[2],
            ThinBy::Highest => -point[2],
            ThinBy::First => 0.0,
            ThinBy::NearestCentre => square,
        };
        Some((cell, rank))
    }

    /// The numbers of the points of `input` that are kept, in order, and how many points it has. `done` gets
    /// the number of points so far.
    ///
    /// # Errors
    /// Those of the input; usage, if points have no elevation but the rule needs it, or cells are too small;
    /// [`ErrorKind::Memory`] if the occupied cells do not fit the budget.
    pub(super) fn winners(
        &self,
        input: &dyn Passes,
        budget: &Budget,
        done: impl FnMut(u64),
    ) -> Result<Winners> {
        let Description { dims, has_elevation, .. } = *input.description();
        if dims == 2 && !has_elevation && matches!(self.by, ThinBy::Lowest | ThinBy::Highest) {
            let remedy = "thin by another rule, such as --thin CELL:first";
            return Err(Error::usage(format!("points have no elevation: {remedy}")));
        }
        match dims {
            2 => self.find::<2>(input, budget, done),
            _ => self.find::<3>(input, budget, done),
        }
    }

    fn find<const D: usize>(
        &self,
        input: &dyn Passes,
        budget: &Budget,
        mut done: impl FnMut(u64),
    ) -> Result<Winners> {
        let coordinates = input.description().coordinates;
        let mut cells = Cells::<D> { kept: HashMap::new(), bytes_max: budget.bytes() };
        let mut points = 0;
        let prepare = |batch: &PointBatch, places: &mut Vec<([i64; D], f64)>| {
            places.clear();
            for &point in &batch.points {
                let Some(place) = self.place(&coordinates, point) else {
                    let world = coordinates.to_world(point);
                    let message =
                        format!("cells of side {:e} are too small for the point {world:?}", self.cell);
                    return Err(Error::usage(format!("{message}: give larger ones to --thin")));
                };
                places.push(place);
            }
            Ok(())
        };
        read_ahead(&mut *input.read()?, prepare, |_, places| {
            for &mut (cell, rank) in places {
                cells.add(cell, rank, points)?;
                points += 1;
            }
            done(points);
            Ok(())
        })?;
        let mut numbers: Vec<u64> = cells.kept.into_values().map(|(_, number)| number).collect();
        numbers.sort_unstable();
        Ok(Winners { numbers, points })
    }
}

/// The point that each occupied cell keeps so far: its rank and its number.
struct Cells<const D: usize> {
    kept: HashMap<[i64; D], (f64, u64)>,
    bytes_max: u64,
}

impl<const D: usize> Cells<D> {
    fn add(&mut self, cell: [i64; D], rank: f64, number: u64) -> Result<()> {
        if self.kept.len() == self.kept.capacity() {
            self.grow()?;
        }
        match self.kept.entry(cell) {
            Entry::Vacant(entry) => {
                entry.insert((rank, number));
            }
            Entry::Occupied(mut entry) if rank < entry.get().0 => {
                entry.insert((rank, number));
            }
            Entry::Occupied(_) => {}
        }
        Ok(())
    }

    /// Doubles the table. Both tables exist until all cells have moved; the numbers of the kept points are
    /// collected beside the table.
    fn grow(&mut self) -> Result<()> {
        let entry_len = size_of::<([i64; D], (f64, u64))>() as u64 + 1;
        let more = self.kept.capacity().max(512);
        // Seven of eight places of a table are used.
        let needed = (self.kept.capacity() as u64 + 2 * more as u64) * entry_len * 8 / 7;
        if needed > self.bytes_max {
            return Err(Error::new(
                ErrorKind::Memory,
                format!(
                    "thinning: {} cells hold points so far, more need {} MiB and the memory budget leaves {}: \
                     raise --memory, or give larger cells to --thin",
                    self.kept.len(),
                    needed.div_ceil(1 << 20),
                    self.bytes_max >> 20
                ),
            ));
        }
        self.kept.reserve(more);
        Ok(())
    }
}

/// The points that are kept.
pub(super) struct Winners {
    /// Their numbers in the input, increasing.
    numbers: Vec<u64>,
    /// Points of the input.
    points: u64,
}

impl Winners {
    /// Number of points that are dropped.
    pub(super) fn dropped(&self) -> u64 {
        self.points - self.numbers.len() as u64
    }

    /// Memory in bytes.
    pub(super) fn bytes(&self) -> u64 {
        size_of_val(&self.numbers[..]) as u64
    }
}

/// An input of which only some points are kept.
pub(super) struct Thinned<'a> {
    input: &'a dyn Passes,
    description: Description,
    winners: Winners,
}

impl<'a> Thinned<'a> {
    pub(super) fn new(input: &'a dyn Passes, winners: Winners) -> Self {
        let stated_points = Some(winners.numbers.len() as u64);
        let description = Description { stated_points, ..input.description().clone() };
        Thinned { input, description, winners }
    }
}

impl Passes for Thinned<'_> {
    fn description(&self) -> &Description {
        &self.description
    }

    fn read(&self) -> Result<Box<dyn PointReader + '_>> {
        Ok(Box::new(KeptPoints::new(self.input, ThinnedPass { winners: &self.winners, next: 0, read: 0 })?))
    }

    fn source(&self) -> Option<&dyn Passes> {
        Some(self.input)
    }
}

/// One pass over a thinned input.
struct ThinnedPass<'a> {
    winners: &'a Winners,
    /// Points kept so far, and points read.
    next: usize,
    read: u64,
}

impl Keep for ThinnedPass<'_> {
    fn keeps(&mut self, _: &mut Point) -> bool {
        let is_kept = self.winners.numbers.get(self.next) == Some(&self.read);
        self.read += 1;
        self.next += usize::from(is_kept);
        is_kept
    }

    fn end(&mut self) -> Result<()> {
        let is_same = self.read == self.winners.points && self.next == self.winners.numbers.len();
        if is_same { Ok(()) } else { Err(input_changed()) }
    }
}
