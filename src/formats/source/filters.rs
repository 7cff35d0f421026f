//! Which points of an input are kept, and how many are dropped for which reason.

use std::num::NonZeroU32;
use std::str::FromStr;

use spmesh_base::random::mixed;
use spmesh_stream::model::bounds::Bounds;

/// Which points to keep. Only LAS and LAZ files have the fields that all filters but `z` and `sample` look
/// at.
///
/// Points that are withheld count as deleted, says the LAS specification: they are dropped by default.
#[derive(Debug, Clone, Default)]
pub struct Filters {
    /// Keep points that are marked as withheld.
    pub keep_withheld: bool,
    /// Drop points that are marked as synthetic: not measured by the scanner.
    pub drop_synthetic: bool,
    /// Drop points in the overlap of swaths: of class 12 in formats 0 to 5, with the overlap flag in others.
    pub drop_overlap: bool,
    /// Keep only points that are marked as key points of the model.
    pub keep_keypoint: bool,
    /// Keep only points of these classes, if any are given.
    pub keep_class: Vec<u8>,
    /// Drop points of these classes.
    pub drop_class: Vec<u8>,
    /// Drop points of the classes of noise, low points and high noise, where files have classes.
    pub drop_noise: bool,
    /// Keep only first returns.
    pub first_only: bool,
    /// Keep only last returns.
    pub last_only: bool,
    /// Keep only points with these return numbers, if any are given.
    pub keep_return: Vec<u8>,
    /// Keep only points with an intensity in this interval.
    pub intensity: Option<Interval>,
    /// Keep only points with user data in this interval.
    pub user_data: Option<Interval>,
    /// Keep only points with a point source ID in this interval.
    pub point_source: Option<Interval>,
    /// Keep only points with a GPS time in this interval.
    pub gps_time: Option<Interval>,
    /// Keep only points whose z in the world is in this interval.
    pub z: Option<Interval>,
    /// Keep only points at these places.
    pub sample: Option<Sample>,
}

/// A part of all places of the plane, which a hash of x and y in the world chooses. So it depends neither on
/// the order of points nor on their files and grids, and points at one place stay together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// The hash chooses one of so many places on average.
    pub one_in: NonZeroU32,
    /// Whether these are not in the sample, and all others are.
    pub is_complement: bool,
}

impl Sample {
    /// Whether a place is in the sample.
    pub(crate) fn contains(&self, [x, y]: [f64; 2]) -> bool {
        // -0 and 0 are one place.
        let [x, y] = [x, y].map(|at| (at + 0.0).to_bits());
        mixed(mixed(x) ^ y).is_multiple_of(self.one_in.get().into()) != self.is_complement
    }
}

/// The classes of noise: low points, and high noise.
pub(crate) const NOISE: [u8; 2] = [7, 18];

impl Filters {
    /// What a filter needs that only points of LAS and LAZ files have.
    pub(crate) fn needs(&self) -> Option<&'static str> {
        let needs = [
            (self.drop_synthetic || self.drop_overlap || self.keep_keypoint, "flags are"),
            (!self.keep_class.is_empty() || !self.drop_class.is_empty(), "classes are"),
            (self.first_only || self.last_only || !self.keep_return.is_empty(), "returns are"),
            (self.intensity.is_some(), "the intensity is"),
            (self.user_data.is_some(), "user data are"),
            (self.point_source.is_some(), "the point source is"),
            (self.gps_time.is_some(), "the GPS time is"),
        ];
        needs.into_iter().find(|(is_needed, _)| *is_needed).map(|(_, what)| what)
    }
}

/// A closed interval, whose ends may be infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    min: f64,
    max: f64,
}

impl Interval {
    /// The numbers from `min` to `max`; `None` if these are none.
    pub fn new(min: f64, max: f64) -> Option<Interval> {
        (min <= max).then_some(Interval { min, max })
    }

    /// Whether the interval contains `value`.
    pub fn contains(&self, value: f64) -> bool {
        self.min <= value && value <= self.max
    }

    /// The part of the world whose z is in the interval.
    pub(crate) fn of_z(&self) -> Bounds {
        let infinite = f64::INFINITY;
        Bounds { min: [-infinite, -infinite, self.min], max: [infinite, infinite, self.max] }
    }
}

impl FromStr for Interval {
    type Err = String;

    /// `MIN,MAX`; an end that is left out is infinite.
    fn from_str(text: &str) -> Result<Interval, String> {
        let expected = || format!("{text:?} is no interval: expected MIN,MAX, or one of them with the comma");
        let (min, max) = text.split_once(',').ok_or_else(expected)?;
        let (min, max) = (min.trim(), max.trim());
        if min.is_empty() && max.is_empty() {
            return Err(expected());
        }
        let end = |text: &str, open: f64| match text {
            "" => Ok(open),
            text => text.parse().map_err(|_| expected()),
        };
        let (min, max) = (end(min, f64::NEG_INFINITY)?, end(max, f64::INFINITY)?);
        Interval::new(min, max).ok_or_else(|| format!("the interval from {min} to {max} is empty"))
    }
}

/// Why a point is dropped, in the order in which filters are applied: a point counts under the first filter
/// that drops it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DropReason {
    /// It is withheld.
    Withheld,
    /// It is synthetic.
    Synthetic,
    /// It lies in the overlap of swaths.
    Overlap,
    /// It is no key point.
    Keypoint,
    /// Its class is not wanted.
    Class,
    /// Its return number is not wanted.
    Return,
    /// Its intensity is not wanted.
    Intensity,
    /// Its user data are not wanted.
    UserData,
    /// Its point source is not wanted.
    PointSource,
    /// Its GPS time is not wanted.
    GpsTime,
    /// It lies outside of the bounds.
    Bounds,
    /// Its z is not wanted.
    Z,
    /// It is not in the sample.
    Sample,
}

impl DropReason {
    /// All reasons, in their order.
    pub const ALL: [DropReason; 13] = [
        DropReason::Withheld,
        DropReason::Synthetic,
        DropReason::Overlap,
        DropReason::Keypoint,
        DropReason::Class,
        DropReason::Return,
        DropReason::Intensity,
        DropReason::UserData,
        DropReason::PointSource,
        DropReason::GpsTime,
        DropReason::Bounds,
        DropReason::Z,
        DropReason::Sample,
    ];

    /// Name in reports and in JSON.
    pub fn name(self) -> &'static str {
        match self {
            DropReason::Withheld => "withheld",
            DropReason::Synthetic => "synthetic",
            DropReason::Overlap => "overlap",
            DropReason::Keypoint => "keypoint",
            DropReason::Class => "class",
            DropReason::Return => "return",
            DropReason::Intensity => "intensity",
            DropReason::UserData => "user_data",
            DropReason::PointSource => "point_source",
            DropReason::GpsTime => "gps_time",
            DropReason::Bounds => "bounds",
            DropReason::Z => "z",
            DropReason::Sample => "sample",
        }
    }
}

/// Numbers of points that filters dropped.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Dropped([u64; DropReason::ALL.len()]);

impl Dropped {
    /// The number of points dropped for this reason.
    pub fn of(&self, reason: DropReason) -> u64 {
        self.0[reason as usize]
    }

    /// The number of points dropped for any reason.
    pub fn total(&self) -> u64 {
        self.0.iter().sum()
    }

    /// Counts a point.
    pub(crate) fn count(&mut self, reason: DropReason) {
        self.0[reason as usize] += 1;
    }

    /// Adds the counts of another part of the input.
    pub(crate) fn add(&mut self, other: &Dropped) {
        self.0.iter_mut().zip(other.0).for_each(|(sum, count)| *sum += count);
    }
}
