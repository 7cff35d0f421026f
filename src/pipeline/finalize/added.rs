//! Points beside those of the input: the vertices of lines.
//!
//! They come before all others. A point of the input at the place of one of them is left out.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use foldhash::fast::FixedState;
use std::cmp::Ordering as Order;
use std::hash::BuildHasher;

use super::passes::{Keep, KeptPoints, Passes};
use super::relief::Relief;
use spmesh_base::error::Result;
use spmesh_formats::source::{Description, PointReader};
use spmesh_stream::model::bounds::{Bounds, Point};

/// Points of a batch.
const BATCH: usize = 1 << 14;

/// Points that are added to an input.
#[derive(Debug, Default)]
pub(super) struct AddedPoints {
    /// In lexicographic order of their places.
    points: Vec<Point>,
    /// A bit for each value that the hash of a place of them can have.
    hashes: Vec<u64>,
    /// Points of the input that the last pass left out.
    replaced: AtomicU64,
    /// The points of the input around these in the last pass.
    relief: Mutex<Relief>,
}

impl AddedPoints {
    /// Adds points, in stored coordinates of the input, to an input of the plane. Of several at one place,
    /// the first one counts.
    pub(super) fn new(mut points: Vec<Point>) -> AddedPoints {
        points.sort_by(by_place);
        points.dedup_by(|a, b| by_place(a, b).is_eq());
        // Of other places, one in sixteen or fewer has the hash of one of these.
        let bits = (16 * points.len()).next_power_of_two().max(64);
        let mut added = AddedPoints { points, hashes: vec![0; bits / 64], ..AddedPoints::default() };
        for index in 0..added.points.len() {
            let hash = added.hash_of(&added.points[index]);
            added.hashes[hash / 64] |= 1 << (hash % 64);
        }
        added
    }

    fn hash_of(&self, [x, y, _]: &Point) -> usize {
        // -0 and 0 are one place.
        let hash = FixedState::default().hash_one([(x + 0.0).to_bits(), (y + 0.0).to_bits()]);
        hash as usize & (64 * self.hashes.len() - 1)
    }

    /// Whether one of these points has the place of a point.
    fn has_place_of(&self, point: &Point) -> bool {
        if self.points.is_empty() {
            return false;
        }
        let hash = self.hash_of(point);
        self.hashes[hash / 64] >> (hash % 64) & 1 == 1
            && self.points.binary_search_by(|other| by_place(other, point)).is_ok()
    }

    /// Number of points that are added.
    pub(super) fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether no points are added.
    pub(super) fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// After a run: how many points of the input were left out.
    pub(super) fn replaced(&self) -> u64 {
        self.replaced.load(Ordering::Relaxed)
    }

    /// After a run: the least and the greatest elevation of points of the input around each of some of these.
    pub(super) fn around(self, points: &[Point]) -> Vec<Option<[f64; 2]>> {
        self.relief.into_inner().unwrap_or_default().around(points)
    }
}

/// The lexicographic order of places; -0 is 0. Points of the input may have coordinates that are not finite.
fn by_place(a: &Point, b: &Point) -> Order {
    (a[0] + 0.0).total_cmp(&(b[0] + 0.0)).then_with(|| (a[1] + 0.0).total_cmp(&(b[1] + 0.0)))
}

/// An input with added points.
pub(super) struct WithAdded<'a> {
    input: &'a dyn Passes,
    added: &'a AddedPoints,
    description: Description,
    /// The row of an added point.
    row: Vec<u8>,
}

impl<'a> WithAdded<'a> {
    pub(super) fn new(input: &'a dyn Passes, added: &'a AddedPoints) -> Self {
        let description = input.description().clone();
        let bounds = Bounds::of_points(&added.points);
        let description = Description {
            stated_bounds: description
                .stated_bounds
                .map(|stated| bounds.map_or(stated, |own| stated.union(own))),
            stated_points: description.stated_points.map(|points| points + added.points.len() as u64),
            ..description
        };
        WithAdded { input, added, row: description.attributes.unknown_row(), description }
    }
}

impl Passes for WithAdded<'_> {
    fn description(&self) -> &Description {
        &self.description
    }

    fn read(&self) -> Result<Box<dyn PointReader + '_>> {
        let rest = KeptPoints::new(self.input, FreePlaces::new(self.added))?;
        Ok(Box::new(WithAddedReader { added: &self.added.points, row: &self.row, rest, rows: Vec::new() }))
    }

    fn source(&self) -> Option<&dyn Passes> {
        Some(self.input)
    }
}

/// One pass over an input with added points.
struct WithAddedReader<'a> {
    /// Added points that come next.
    added: &'a [Point],
    row: &'a [u8],
    /// The points of the input.
    rest: KeptPoints<'a, FreePlaces<'a>>,
    /// The rows of added points in the batch.
    rows: Vec<u8>,
}

impl PointReader for WithAddedReader<'_> {
    fn next_batch(&mut self, batch: &mut Vec<Point>) -> Result<()> {
        self.rows.clear();
        if self.added.is_empty() {
            return self.rest.next_batch(batch);
        }
        let (points, others) = self.added.split_at(self.added.len().min(BATCH));
        self.added = others;
        batch.clear();
        batch.extend_from_slice(points);
        points.iter().for_each(|_| self.rows.extend_from_slice(self.row));
        Ok(())
    }

    fn rows(&self) -> &[u8] {
        if self.rows.is_empty() { self.rest.rows() } else { &self.rows }
    }

    fn invalid(&self) -> u64 {
        self.rest.invalid()
    }
}

/// Leaves out points of the input at places of added points.
struct FreePlaces<'a> {
    added: &'a AddedPoints,
    /// Points that were left out.
    replaced: u64,
    relief: Relief,
}

impl<'a> FreePlaces<'a> {
    fn new(added: &'a AddedPoints) -> FreePlaces<'a> {
        FreePlaces { added, replaced: 0, relief: Relief::over(&added.points) }
    }
}

impl Keep for FreePlaces<'_> {
    fn keeps(&mut self, point: &mut Point) -> bool {
        self.relief.enter(point);
        let is_free = !self.added.has_place_of(point);
        self.replaced += u64::from(!is_free);
        is_free
    }

    fn end(&mut self) -> Result<()> {
        self.added.replaced.store(self.replaced, Ordering::Relaxed);
        if let Ok(mut relief) = self.added.relief.lock() {
            *relief = std::mem::take(&mut self.relief);
        }
        Ok(())
    }
}
