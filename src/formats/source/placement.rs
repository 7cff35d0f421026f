//! Moves points from the coordinates of their file to those of the whole input, and drops points by filters.

use crate::source::filters::{DropReason, Dropped, Sample};
use crate::source::options::{InvalidAdvice, SourceOptions};
use spmesh_base::error::{Error, Result};
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::{Bounds, Point, Region};

/// Greatest relative deviation of a ratio of scales from the fraction that it stands for: 2^-40. Division and
/// decimal notation of scales cause deviations of about 2^-51. Over the range of 32 bits a coordinate moves
/// by at most 2^-9 of its file's step.
pub(crate) const RATIO_TOLERANCE: f64 = 1.0 / (1u64 << 40) as f64;

/// Greatest factor between steps: a stored integer times the factor, plus a shift, is exact in f64.
const FACTOR_MAX: f64 = (1u64 << 21) as f64;

/// Greatest deviation of an offset from a multiple of the quantum, and of a coordinate from a side of a
/// window, in quanta.
const QUANTA_TOLERANCE: f64 = 1e-6;

/// How the points of one file become points of the input.
#[derive(Debug)]
pub(crate) struct Placement {
    step: Step,
    /// Boxes that keep points, in the file's stored coordinates, and why they drop others.
    windows: Vec<(DropReason, Bounds)>,
    /// The places that are kept, and the file's coordinates, which say where they are.
    sample: Option<(Sample, Coordinates)>,
    /// The part of the input that is wanted, in its coordinates; `None` if it has all points of the file.
    window: Option<Region<3>>,
    skip_invalid: bool,
    advice: InvalidAdvice,
    /// Points that filters dropped so far.
    pub(crate) dropped: Dropped,
    /// Points dropped so far because a coordinate is not finite.
    pub(crate) invalid: u64,
}

#[derive(Debug)]
enum Step {
    Same,
    /// Both grids are integers, and a step of the file is an integer multiple of a step of the input. Nothing
    /// is rounded, and equal points stay equal. Where scales differ in their notation only, world coordinates
    /// may move by a relative [`RATIO_TOLERANCE`].
    Integers {
        factor: Point,
        shift: Point,
    },
    ToWorld(Coordinates),
    /// To the nearest grid point.
    ToGrid {
        from: Coordinates,
        to: Coordinates,
    },
}

impl Placement {
    pub(crate) fn new(from: &Coordinates, to: &Coordinates, options: &SourceOptions) -> Self {
        let step = if from == to {
            Step::Same
        } else if *to == Coordinates::F64 {
            Step::ToWorld(*from)
        } else if let Some((factor, shift)) = whole_steps(from, to) {
            Step::Integers { factor, shift }
        } else {
            Step::ToGrid { from: *from, to: *to }
        };
        let stored = |&(reason, bounds): &(_, Bounds)| (reason, stored_bounds(from, bounds));
        let windows = options.windows().iter().map(stored).collect();
        let (skip_invalid, advice) = (options.skip_invalid, options.invalid_advice);
        let window = options.window;
        let sample = options.filters.sample.map(|sample| (sample, *from));
        let dropped = Dropped::default();
        Placement { step, windows, sample, window, skip_invalid, advice, dropped, invalid: 0 }
    }

    /// Says that all points of the file are in this box of its stored coordinates, so that none may have to
    /// be looked at.
    pub(crate) fn within(self, stated: Option<Bounds>) -> Self {
        let contains = |window: &Region<3>, bounds: &Bounds| {
            [bounds.min, bounds.max].iter().all(|&corner| window.contains(self.place(corner)))
        };
        let is_inside = self.window.zip(stated).is_some_and(|(window, bounds)| contains(&window, &bounds));
        Placement { window: self.window.filter(|_| !is_inside), ..self }
    }

    /// A point of the file in the coordinates of the input.
    #[inline]
    fn place(&self, stored: Point) -> Point {
        match &self.step {
            Step::Same => stored,
            Step::Integers { factor, shift } => {
                std::array::from_fn(|axis| stored[axis] * factor[axis] + shift[axis])
            }
            Step::ToWorld(from) => from.to_world(stored),
            Step::ToGrid { from, to } => to.to_stored(from.to_world(stored)),
        }
    }

    /// Whether a point of the file is one of another part of the input.
    #[inline]
    pub(crate) fn is_elsewhere(&self, stored: Point) -> bool {
        self.window.is_some_and(|window| !window.contains(self.place(stored)))
    }

    /// Points that filters dropped so far, and those that are not finite.
    pub(crate) fn left_out(&self) -> u64 {
        self.dropped.total() + self.invalid
    }

    /// Whether all points with integer coordinates stay unchanged. Integer coordinates are finite.
    pub(crate) fn keeps_integers(&self) -> bool {
        let keeps_all = self.windows.is_empty() && self.window.is_none() && self.sample.is_none();
        matches!(self.step, Step::Same) && keeps_all
    }

    /// Appends `stored`, a point in the coordinates of its file, to `batch`, unless filters drop it. Returns
    /// whether it did.
    ///
    /// # Errors
    /// If a coordinate is not finite (unless such points are skipped), or does not fit the input's grid. The
    /// caller adds the record's position.
    #[inline]
    pub(crate) fn put(&mut self, stored: Point, batch: &mut Vec<Point>) -> Result<bool> {
        if self.is_elsewhere(stored) {
            return Ok(false);
        }
        if let Some(reason) = self.reason(stored)
            && stored.iter().all(|value| value.is_finite())
        {
            self.dropped.count(reason);
            return Ok(false);
        }
        let placed = self.place(stored);
        if !placed.iter().all(|value| value.is_finite()) {
            return self.refuse(stored);
        }
        if let Step::Integers { .. } | Step::ToGrid { .. } = self.step
            && !placed.iter().all(|value| f64::from(*value as i32) == *value)
        {
            return Err(Error::usage(format!(
                "coordinates {stored:?} are {placed:?} steps of the common grid, beyond 32 bits: \
                 give spfinalize a coarser --scale or another --offset"
            )));
        }
        batch.push(placed);
        Ok(true)
    }

    /// Why a point of the file is dropped, if it is.
    #[inline]
    fn reason(&self, stored: Point) -> Option<DropReason> {
        let outside = self.windows.iter().find(|(_, bounds)| !bounds.contains(stored));
        let is_left = |(sample, from): &(Sample, Coordinates)| {
            let [x, y, _] = from.to_decimal(stored);
            !sample.contains([x, y])
        };
        let sampled = || self.sample.as_ref().is_some_and(is_left).then_some(DropReason::Sample);
        outside.map(|(reason, _)| *reason).or_else(sampled)
    }

    #[cold]
    fn refuse(&mut self, stored: Point) -> Result<bool> {
        if self.skip_invalid {
            self.invalid += 1;
            return Ok(false);
        }
        Err(Error::malformed(format!("coordinates {stored:?} are not finite ({})", self.advice.text())))
    }
}

/// How points in one encoding are expressed in another, without being dropped or moved to a grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Alignment {
    /// Stored integers times a factor, plus a shift: nothing is rounded.
    Whole {
        /// Steps of the other grid in a step of this one, per axis: positive integers of up to 2^21.
        factor: Point,
        /// Where the origin of this grid is in the other one.
        shift: Point,
    },
    /// Through world coordinates, in f64.
    World {
        /// The encoding of the points.
        from: Coordinates,
        /// The one that they are expressed in; between its steps, if it is a grid.
        to: Coordinates,
    },
}

impl Alignment {
    /// The alignment of points in `from` with `to`.
    pub fn between(from: &Coordinates, to: &Coordinates) -> Alignment {
        match whole_steps(from, to) {
            Some((factor, shift)) => Alignment::Whole { factor, shift },
            None => Alignment::World { from: *from, to: *to },
        }
    }

    /// A stored point in the other encoding.
    #[inline]
    pub fn place(&self, stored: Point) -> Point {
        match self {
            Alignment::Whole { factor, shift } => {
                std::array::from_fn(|axis| stored[axis] * factor[axis] + shift[axis])
            }
            Alignment::World { from, to } => {
                let world = from.to_world(stored);
                match to {
                    Coordinates::F64 => world,
                    Coordinates::I32 { scale, offset } => {
                        std::array::from_fn(|axis| (world[axis] - offset[axis]) / scale[axis])
                    }
                }
            }
        }
    }
}

/// Factor and shift per axis that convert stored integers of `from` to those of `to`; `None` if there are
/// none. In the world, a point moves by at most 2^-9 steps of `from` and 10^-6 steps of `to`.
pub(crate) fn whole_steps(from: &Coordinates, to: &Coordinates) -> Option<(Point, Point)> {
    let (Coordinates::I32 { scale, offset }, Coordinates::I32 { scale: to_scale, offset: to_offset }) =
        (from, to)
    else {
        return None;
    };
    let (mut factor, mut shift) = ([0.0; 3], [0.0; 3]);
    for axis in 0..3 {
        factor[axis] = whole(scale[axis] / to_scale[axis], RATIO_TOLERANCE * scale[axis] / to_scale[axis])?;
        shift[axis] = whole((offset[axis] - to_offset[axis]) / to_scale[axis], QUANTA_TOLERANCE)?;
        if !(1.0..=FACTOR_MAX).contains(&factor[axis]) {
            return None;
        }
    }
    Some((factor, shift))
}

fn whole(value: f64, tolerance: f64) -> Option<f64> {
    let rounded = value.round();
    ((value - rounded).abs() <= tolerance && rounded.abs() < 2f64.powi(52)).then_some(rounded)
}

/// A window in stored coordinates. A grid point meant to lie on a side is inside, however the
/// product of scale and integer is rounded.
fn stored_bounds(from: &Coordinates, bounds: Bounds) -> Bounds {
    let Coordinates::I32 { scale, offset } = from else { return bounds };
    let steps = |side: Point, axis: usize| (side[axis] - offset[axis]) / scale[axis];
    Bounds {
        min: std::array::from_fn(|axis| (steps(bounds.min, axis) - QUANTA_TOLERANCE).ceil()),
        max: std::array::from_fn(|axis| (steps(bounds.max, axis) + QUANTA_TOLERANCE).floor()),
    }
}
