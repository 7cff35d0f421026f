//! The points of a fit with their weights, in world coordinates or in the frame of knots.

use std::cell::Cell;
use std::path::PathBuf;
use std::rc::Rc;

use super::elevations::Elevations;
use super::frame::Frame;
use super::sites::Sites;
use crate::fitting::{self, Observation, ObservationReader, Observations};
use spmesh_base::error::{Error, Result, counted};
use spmesh_delaunay::predicates::Point2;
use spmesh_formats::source::{FillValues, Input, SourceOptions};
use spmesh_stream::Crs;

/// Up to this number, points that many passes read are held in memory, with 32 bytes each: most sources take
/// longer to decode...
const HELD_OFTEN: usize = 1 << 23;
/// ...and up to this number if few passes read them. A few more passes are cheap, and memory stays bounded.
const HELD_SELDOM: usize = 1 << 20;
/// Least size of the sample of elevations, if there are as many points.
const SAMPLE: usize = 1 << 12;
/// The part of elevations that is cut off at each end of their range.
const OUTSIDE: f64 = 0.02;
/// Places from which the density of points is found, at most.
const PLACES_MAX: u64 = 1 << 22;
/// Points per batch of held points.
const BATCH: usize = 1 << 14;

/// The points of an input with their weights, in world coordinates.
#[derive(Debug)]
pub struct Points {
    input: Rc<Input>,
    weights: Option<Vec<f64>>,
    held: Option<Vec<Observation>>,
    /// A sample of elevations, sorted.
    sample: Vec<f64>,
    count: u64,
    /// Points of one place merged, if there are any.
    sites: Option<Sites>,
    /// Elevations that stand for none.
    no_data: Vec<f64>,
    /// How many points of the current pass had one of them.
    dropped: Cell<u64>,
}

impl Points {
    /// Opens files and reads them once. `weights` are the weights of the points, in their order; `often` says
    /// whether many passes will follow.
    ///
    /// Memory: 32 bytes per point up to 8 million points if `often`, and up to one million otherwise. More
    /// points are not held, but read again in each pass.
    ///
    /// # Errors
    /// As [`Input::open`]; no elevation; another number of weights; malformed, if elevations are
    /// [`FillValues`] which `no_data` does not name.
    pub fn open(
        paths: &[PathBuf],
        options: &SourceOptions,
        weights: Option<Vec<f64>>,
        no_data: Vec<f64>,
        often: bool,
        mut done: impl FnMut(u64),
    ) -> Result<Points> {
        let input = Input::open(paths, &SourceOptions { dims: 2, ..options.clone() })?;
        let mut points = Points {
            input: Rc::new(input),
            weights,
            held: None,
            sample: Vec::new(),
            count: 0,
            sites: None,
            no_data,
            dropped: Cell::new(0),
        };
        let mut held = Some(Vec::new());
        let (mut reader, mut batch) = (points.read_world()?, Vec::new());
        let held_max = if often { HELD_OFTEN } else { HELD_SELDOM };
        let (mut count, mut sample, mut fill_values) = (0, Sample::default(), FillValues::default());
        loop {
            batch.clear();
            reader.append(&mut batch)?;
            if batch.is_empty() {
                break;
            }
            count += batch.len() as u64;
            batch.iter().for_each(|one| sample.add(one.value));
            fill_values.add([f64::NEG_INFINITY, f64::INFINITY], batch.iter().map(|one| one.value));
            match &mut held {
                Some(all) if all.len() + batch.len() <= held_max => all.extend_from_slice(&batch),
                _ => held = None,
            }
            done(count);
        }
        drop(reader);
        points.check_weights(count)?;
        if !fill_values.is_empty() {
            let flags = fill_values.values().into_iter().map(|value| format!(" --no-data {value:?}"));
            let flags: String = flags.collect();
            let what = format!(
                "{}: if that stands for no value, leave these points out with{}",
                fill_values.finding(),
                flags.replace(".0", "")
            );
            return Err(Error::malformed(what).of_input(points.name()));
        }
        points.sites = held.as_deref().and_then(Sites::of);
        (points.held, points.sample, points.count) = (held, sample.in_order(), count);
        Ok(points)
    }

    fn check_weights(&self, count: u64) -> Result<()> {
        match &self.weights {
            Some(weights) if weights.len() as u64 != count => {
                {
                    let message = format!("{} weights for {count} points: one each is needed", weights.len());
                    let error = Error::usage(message).of_input(self.name());
                    // The weights may be those of all points of the file.
                    let dropped =
                        [self.input.withheld_notice(), self.input.invalid_notice(), self.no_data_notice()];
                    Err(dropped.iter().flatten().fold(error, |error, notice| error.noting(notice)))
                }
            }
            _ => Ok(()),
        }
    }

    /// The name of the input in messages.
    pub fn name(&self) -> String {
        self.input.name()
    }

    /// Notices about the files for the user.
    pub fn notices(&self) -> Vec<String> {
        let dropped = [self.input.withheld_notice(), self.input.invalid_notice(), self.no_data_notice()];
        self.input.notices().iter().cloned().chain(dropped.into_iter().flatten()).collect()
    }

    fn no_data_notice(&self) -> Option<String> {
        let values: Vec<String> = self.no_data.iter().map(f64::to_string).collect();
        let points = counted(self.dropped.get(), "point", "points");
        (!values.is_empty()).then(|| format!("left out {points} without data (z = {})", values.join(" or ")))
    }

    /// The points of one place merged; `None` if there are none, or points are too many to be held.
    pub fn sites(&self) -> Option<&Sites> {
        self.sites.as_ref()
    }

    /// The places of points, without copies, and the part of all that they are: one, if points are held.
    ///
    /// # Errors
    /// If points cannot be read.
    pub(super) fn places(&self) -> Result<(Vec<Point2>, f64)> {
        if let Some(held) = self.sites.as_ref().map(|sites| &sites.merged).or(self.held.as_ref()) {
            return Ok((held.iter().map(|one| one.point).collect(), 1.0));
        }
        let stride = self.count.div_ceil(PLACES_MAX).max(1) as usize;
        let (mut reader, mut batch, mut places, mut first) = (self.read_world()?, Vec::new(), Vec::new(), 0);
        loop {
            reader.append(&mut batch)?;
            if batch.is_empty() {
                return Ok((places, 1.0 / stride as f64));
            }
            let skipped = (stride - first % stride) % stride;
            places.extend(batch.iter().skip(skipped).step_by(stride).map(|one| one.point));
            // The hull is that of all points.
            let all: Vec<Point2> = batch.iter().map(|one| one.point).collect();
            places.extend(fitting::hull_corners(&all));
            first += batch.len();
            batch.clear();
        }
    }

    /// The points of some places.
    ///
    /// # Errors
    /// Usage, if points are too many to be held.
    pub(super) fn only(&self, at: impl Fn(Point2) -> bool) -> Result<Points> {
        let Some(held) = &self.held else {
            let what =
                format!("{} points are too many for cross-validation: take a part of them", self.count);
            return Err(Error::usage(what).of_input(self.name()));
        };
        let held: Vec<Observation> = held.iter().filter(|one| at(one.point)).copied().collect();
        let mut sample = Sample::default();
        held.iter().for_each(|one| sample.add(one.value));
        Ok(Points {
            input: Rc::clone(&self.input),
            weights: None,
            sample: sample.in_order(),
            count: held.len() as u64,
            sites: Sites::of(&held),
            held: Some(held),
            no_data: Vec::new(),
            dropped: Cell::new(0),
        })
    }

    /// Calls `visit` with all points and their numbers.
    ///
    /// # Errors
    /// If points cannot be read.
    pub(super) fn for_each(&self, mut visit: impl FnMut(u64, &Observation)) -> Result<()> {
        let (mut reader, mut batch, mut index) = (self.read_world()?, Vec::new(), 0);
        loop {
            batch.clear();
            reader.append(&mut batch)?;
            if batch.is_empty() {
                return Ok(());
            }
            for one in &batch {
                visit(index, one);
                index += 1;
            }
        }
    }

    /// The coordinate reference system.
    pub fn crs(&self) -> &Crs {
        &self.input.description().crs
    }

    /// Number of points.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The range of most elevations, estimated from a sample, so that a few gross errors change it little.
    pub fn range(&self) -> [f64; 2] {
        let ends = [OUTSIDE, 1.0 - OUTSIDE];
        let place = |part: f64| (part * self.sample.len().saturating_sub(1) as f64).round() as usize;
        ends.map(|part| self.sample.get(place(part)).copied().unwrap_or(0.0))
    }

    /// The points in a frame; `done` gets the number of points read so far, in all passes together.
    pub fn in_frame<'a>(&'a self, frame: &'a Frame, done: &'a dyn Fn(u64)) -> PointsInFrame<'a> {
        PointsInFrame { points: self, frame, is_merged: false, read: Cell::new(0), done }
    }

    /// The same, with the points of one place merged into one with their mean and weight.
    pub fn sites_in_frame<'a>(&'a self, frame: &'a Frame, done: &'a dyn Fn(u64)) -> PointsInFrame<'a> {
        PointsInFrame { is_merged: true, ..self.in_frame(frame, done) }
    }

    /// A pass in world coordinates.
    pub(super) fn read_world(&self) -> Result<Box<dyn ObservationReader + '_>> {
        if let Some(held) = &self.held {
            return Ok(Box::new(Held(held)));
        }
        self.dropped.set(0);
        let elevations = Elevations::of(&self.input)?.into_reader()?;
        let (no_data, dropped) = (&self.no_data[..], &self.dropped);
        let elevations = Box::new(WithData { reader: elevations, no_data, dropped });
        let weights = self.weights.as_deref();
        Ok(Box::new(Weighed { reader: elevations, weights, next: 0 }))
    }
}

/// A sample of elevations at a regular stride, which doubles when the sample is full.
#[derive(Default)]
struct Sample {
    taken: Vec<f64>,
    /// Elevations to skip before the next one is taken, and between later ones.
    left: u64,
    stride: u64,
}

impl Sample {
    fn add(&mut self, elevation: f64) {
        if self.left > 0 {
            self.left -= 1;
            return;
        }
        self.taken.push(elevation);
        if self.taken.len() == 2 * SAMPLE {
            let mut is_kept = false;
            self.taken.retain(|_| {
                is_kept = !is_kept;
                is_kept
            });
            self.stride = 2 * self.stride + 1;
        }
        self.left = self.stride;
    }

    fn in_order(mut self) -> Vec<f64> {
        self.taken.sort_by(f64::total_cmp);
        self.taken
    }
}

struct Held<'a>(&'a [Observation]);

impl ObservationReader for Held<'_> {
    fn append(&mut self, observations: &mut Vec<Observation>) -> Result<()> {
        let (next, rest) = self.0.split_at(self.0.len().min(BATCH));
        observations.extend_from_slice(next);
        self.0 = rest;
        Ok(())
    }
}

/// Points of files without those that have no data.
struct WithData<'a> {
    reader: Box<dyn ObservationReader + 'a>,
    no_data: &'a [f64],
    dropped: &'a Cell<u64>,
}

impl ObservationReader for WithData<'_> {
    fn append(&mut self, observations: &mut Vec<Observation>) -> Result<()> {
        let first = observations.len();
        // A batch of no data is not the end.
        loop {
            self.reader.append(observations)?;
            let read = observations.len() - first;
            if read == 0 || self.no_data.is_empty() {
                return Ok(());
            }
            let mut rest = observations.split_off(first);
            rest.retain(|one| !self.no_data.iter().any(|&value| is_about(one.value, value)));
            self.dropped.set(self.dropped.get() + (read - rest.len()) as u64);
            observations.append(&mut rest);
            if observations.len() > first {
                return Ok(());
            }
        }
    }
}

/// Files write fill values with six digits.
fn is_about(found: f64, value: f64) -> bool {
    (found - value).abs() <= 1e-6 * value.abs()
}

/// Points that are decoded, with weights.
struct Weighed<'a> {
    reader: Box<dyn ObservationReader + 'a>,
    weights: Option<&'a [f64]>,
    next: usize,
}

impl ObservationReader for Weighed<'_> {
    fn append(&mut self, observations: &mut Vec<Observation>) -> Result<()> {
        let first = observations.len();
        self.reader.append(observations)?;
        if let Some(weights) = self.weights {
            // If there are too few weights, the other points keep weight one; `check_weights` refuses the
            // input at the end.
            let own = weights.iter().skip(self.next);
            observations[first..].iter_mut().zip(own).for_each(|(one, &weight)| one.weight = weight);
        }
        self.next += observations.len() - first;
        Ok(())
    }
}

/// Points in the frame of knots.
#[derive(Clone)]
pub struct PointsInFrame<'a> {
    points: &'a Points,
    frame: &'a Frame,
    is_merged: bool,
    read: Cell<u64>,
    done: &'a dyn Fn(u64),
}

impl Observations for PointsInFrame<'_> {
    fn read(&self) -> Result<Box<dyn ObservationReader + '_>> {
        let reader = match &self.points.sites {
            Some(sites) if self.is_merged => Box::new(Held(&sites.merged)),
            _ => self.points.read_world()?,
        };
        Ok(Box::new(Moved { all: self, reader }))
    }
}

struct Moved<'a> {
    all: &'a PointsInFrame<'a>,
    reader: Box<dyn ObservationReader + 'a>,
}

impl ObservationReader for Moved<'_> {
    fn append(&mut self, observations: &mut Vec<Observation>) -> Result<()> {
        let PointsInFrame { frame, read, done, .. } = self.all;
        let first = observations.len();
        self.reader.append(observations)?;
        observations[first..].iter_mut().for_each(|one| one.point = frame.to_stored(one.point));
        read.set(read.get() + (observations.len() - first) as u64);
        done(read.get());
        Ok(())
    }
}

/// Reads world coordinates and elevations of points by increasing number.
pub(super) struct Cursor<'a> {
    reader: Box<dyn ObservationReader + 'a>,
    batch: Vec<Observation>,
    /// The number of the first point in the batch.
    first: u64,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(points: &'a Points) -> Result<Cursor<'a>> {
        Ok(Cursor { reader: points.read_world()?, batch: Vec::new(), first: 0 })
    }

    /// The point with this number; numbers must not decrease from call to call.
    pub(super) fn at(&mut self, index: u64) -> Result<(Point2, f64)> {
        while index >= self.first + self.batch.len() as u64 {
            self.first += self.batch.len() as u64;
            self.batch.clear();
            self.reader.append(&mut self.batch)?;
            if self.batch.is_empty() {
                return Err(Error::malformed("there were more points before: the file has changed"));
            }
        }
        let one = self.batch[(index - self.first) as usize];
        Ok((one.point, one.value))
    }
}
