//! Crossings, and the segments that pass through hot pixels, by division of the plane.
//!
//! A cell is a rectangle of pixels; the first ones are those of a grid ([`CellTree`]). It is divided until
//! few segments meet it, or until it has no vertex and [`super::chords`] proves that no two of its segments
//! meet in it. A cell of one pixel needs no division either: it is hot if it has a vertex or a crossing, and
//! then all of its segments are bent to its centre. So segments that share a vertex, or run close to each
//! other, are compared in pairs nowhere.

use super::chords::Chords;
use super::collinear::Segments;
use super::exact::{Place, crossing_pixel, meets_pixel};
use super::{BEND_BYTES, CROSSING_BYTES, NodingOptions};
use crate::cell_tree::{CellTree, Fineness, Grid, Item};
use crate::error::{Error, Result};

/// Segments in a cell that are compared in pairs.
const FEW: usize = 12;

/// Segments of a cell that have a say in how it is divided.
const SAMPLE: usize = 32;

/// The grids where the division starts. A segment is listed in all cells that places are in within so many
/// pixels of it: more than half of a pixel, for the sides of cells, and all rounding errors.
const STARTS: Fineness = Fineness {
    items_per_cell: 12.0,
    cells: [1.0, f64::INFINITY],
    entries: [4, 1],
    crowd: 256,
    reach: 1.5,
    is_whole: true,
};

/// A bound of the rounding error of coordinates computed in f64: they are below 2^43, with three roundings.
const MARGIN: f64 = 1.0 / 64.0;

pub(super) struct Found {
    /// Pixels of crossings that have no vertex, all different.
    pub(super) crossings: Vec<Place>,
    /// A segment, and a hot pixel that it passes through without ending there: the number of a place, or
    /// beyond these, of a crossing.
    pub(super) touches: Vec<[u32; 2]>,
}

/// A segment for quick comparisons; its coordinates are exact.
struct Geometry {
    a: [f64; 2],
    b: [f64; 2],
    slope: f64,
}

impl Geometry {
    fn of([a, b]: [Place; 2]) -> Geometry {
        let [a, b] = [a, b].map(|place| place.map(|value| value as f64));
        Geometry { a, b, slope: if a[0] == b[0] { 0.0 } else { (b[1] - a[1]) / (b[0] - a[0]) } }
    }

    fn ends(&self) -> [Place; 2] {
        [self.a, self.b].map(|place| place.map(|value| value as i64))
    }

    /// Least and greatest coordinate on an axis.
    fn range(&self, axis: usize) -> [f64; 2] {
        let (a, b) = (self.a[axis], self.b[axis]);
        if a <= b { [a, b] } else { [b, a] }
    }

    fn has_end(&self, place: [f64; 2]) -> bool {
        self.a == place || self.b == place
    }

    /// Whether the segment may meet the sides or the inside of a cell; true if it does.
    fn may_meet(&self, cell: &Cell) -> bool {
        let [low, high] = self.range(1);
        let (min, max) = (cell.min.map(|min| min as f64 - 0.5), cell.max.map(|max| max as f64 - 0.5));
        if self.b[0] < min[0] || self.a[0] > max[0] || high < min[1] || low > max[1] {
            return false;
        }
        if self.a[0] == self.b[0] {
            return true;
        }
        let height = |x: f64| self.a[1] + self.slope * (x - self.a[0]);
        let (first, last) = (height(self.a[0].max(min[0])), height(self.b[0].min(max[0])));
        first.min(last) <= max[1] + MARGIN && first.max(last) >= min[1] - MARGIN
    }
}

/// The pixels with centres from `min` to below `max` on both axes.
#[derive(Clone, Copy)]
pub(super) struct Cell {
    pub(super) min: Place,
    pub(super) max: Place,
}

impl Cell {
    /// A cell of a grid.
    fn of(grid: &Grid, number: usize) -> Cell {
        let cell = grid.cell_box(number).within(&grid.bounds);
        Cell { min: cell.min.map(|x| x as i64), max: cell.max.map(|x| x as i64) }
    }

    fn contains(&self, place: Place) -> bool {
        (0..2).all(|axis| self.min[axis] <= place[axis] && place[axis] < self.max[axis])
    }

    pub(super) fn len(&self, axis: usize) -> i64 {
        self.max[axis] - self.min[axis]
    }

    fn middle(&self, axis: usize) -> i64 {
        self.min[axis] + self.len(axis) / 2
    }
}

/// Finds the crossings of segments, and the hot pixels that they pass through.
pub(super) fn search(places: &[Place], segments: &Segments, options: &NodingOptions) -> Result<Found> {
    let mut search = Search {
        places,
        numbers: Vec::new(),
        geometry: Vec::new(),
        cells: Vec::new(),
        found: Found { crossings: Vec::new(), touches: Vec::new() },
        options: *options,
        chords: Chords::default(),
        pixels: Vec::new(),
    };
    let (count, mut vertices) = (segments.ends.len() as u32, Vec::new());
    starts(places, segments).for_each_leaf(&mut |grid, cell, items| {
        let cell = Cell::of(grid, cell);
        let (numbers, places) = items.split_at(items.partition_point(|&item| item < count));
        if numbers.is_empty() || cell.len(0) <= 0 || cell.len(1) <= 0 {
            return Ok(());
        }
        vertices.clear();
        vertices.extend(places.iter().map(|place| place - count));
        search.enter(segments, numbers);
        search.divide(&cell, 0, &mut vertices)
    })?;
    Ok(search.found)
}

/// Segments and, with numbers behind theirs, places in cells. A pixel begins half of its side before its
/// centre.
fn starts(places: &[Place], segments: &Segments) -> CellTree {
    let at = |place: u32| places[place as usize].map(|value| value as f64 + 0.5);
    let count = segments.ends.len();
    let item = |item: u32| match segments.ends.get(item as usize) {
        Some(ends) => Item::Segment(ends.map(at)),
        None => Item::Place(at(item - count as u32)),
    };
    CellTree::new((count + places.len()) as u32, item, &STARTS)
}

struct Search<'a> {
    places: &'a [Place],
    /// The segments of the present cell of the grid, by their numbers...
    numbers: Vec<u32>,
    /// ...and their coordinates.
    geometry: Vec<Geometry>,
    /// Places in `geometry` of the segments of the cells on the way to the present one, which has the last
    /// ones.
    cells: Vec<u32>,
    found: Found,
    options: NodingOptions,
    chords: Chords,
    /// A buffer.
    pixels: Vec<Place>,
}

impl Search<'_> {
    /// Replaces the segments of the present cell of the grid.
    fn enter(&mut self, segments: &Segments, numbers: &[u32]) {
        let of =
            |&number: &u32| Geometry::of(segments.ends[number as usize].map(|end| self.places[end as usize]));
        self.geometry.clear();
        self.geometry.extend(numbers.iter().map(of));
        self.numbers.clear();
        self.numbers.extend_from_slice(numbers);
        self.cells.clear();
        self.cells.extend(0..numbers.len() as u32);
    }

    /// Searches a cell with these vertices, and the segments from `start` on.
    fn divide(&mut self, cell: &Cell, start: usize, vertices: &mut [u32]) -> Result<()> {
        let end = self.cells.len();
        let count = end - start;
        if count == 0 || (count == 1 && vertices.is_empty()) {
            return Ok(());
        }
        if count <= FEW {
            return self.search_few(cell, start, vertices);
        }
        if cell.len(0) == 1 && cell.len(1) == 1 {
            return self.search_pixel(cell, start, vertices.first().copied());
        }
        match *vertices {
            [] if self.is_apart(cell, start) => return Ok(()),
            // Segments with a common end meet nowhere else.
            [vertex] if self.all_end_at(start, vertex) => return Ok(()),
            _ => {}
        }
        let axis = self.axis(cell, start);
        let middle = cell.middle(axis);
        let split = partition(vertices, |&vertex| self.places[vertex as usize][axis] < middle);
        let (left_vertices, right_vertices) = vertices.split_at_mut(split);
        let (mut left, mut right) = (*cell, *cell);
        left.max[axis] = middle;
        right.min[axis] = middle;
        for (half, other, vertices) in [(&left, &right, left_vertices), (&right, &left, right_vertices)] {
            for index in start..end {
                let segment = self.cells[index];
                if self.geometry[segment as usize].is_in_half(half, other, axis) {
                    self.cells.push(segment);
                }
            }
            self.divide(half, end, vertices)?;
            self.cells.truncate(end);
        }
        Ok(())
    }

    fn all_end_at(&self, start: usize, vertex: u32) -> bool {
        let place = self.places[vertex as usize].map(|value| value as f64);
        self.cells[start..].iter().all(|&segment| self.geometry[segment as usize].has_end(place))
    }

    /// The axis along which a cell is divided: the longer one, unless the middle of the other one cuts no
    /// segment.
    fn axis(&self, cell: &Cell, start: usize) -> usize {
        let long = usize::from(cell.len(1) > cell.len(0));
        let short = 1 - long;
        let middle = cell.middle(short) as f64 - 0.5;
        let segments = &self.cells[start..];
        let mut sample = segments.iter().step_by(segments.len().div_ceil(SAMPLE));
        let is_cut = |&segment: &u32| {
            let [low, high] = self.geometry[segment as usize].range(short);
            low < middle && middle < high
        };
        if cell.len(short) == 1 || sample.any(is_cut) { long } else { short }
    }

    /// Whether no two segments of a cell without vertices meet in it, as far as that can be told.
    fn is_apart(&mut self, cell: &Cell, start: usize) -> bool {
        let segments = self.cells[start..].iter();
        self.chords.are_apart(cell, segments.map(|&segment| self.geometry[segment as usize].ends()))
    }

    fn search_few(&mut self, cell: &Cell, start: usize, vertices: &[u32]) -> Result<()> {
        self.pixels.clear();
        for i in start..self.cells.len() {
            let one = &self.geometry[self.cells[i] as usize];
            let ([low, high], ends) = (one.range(1), one.ends());
            for &other in &self.cells[i + 1..] {
                let other = &self.geometry[other as usize];
                let [other_low, other_high] = other.range(1);
                let is_near = one.a[0] <= other.b[0] && other.a[0] <= one.b[0];
                if is_near && low <= other_high && other_low <= high {
                    let pixel = crossing_pixel(ends, other.ends());
                    self.pixels.extend(pixel.filter(|&pixel| cell.contains(pixel)));
                }
            }
        }
        for &vertex in vertices {
            self.touch(start, self.places[vertex as usize], vertex)?;
        }
        let mut pixels = std::mem::take(&mut self.pixels);
        pixels.sort_unstable();
        pixels.dedup();
        pixels.retain(|pixel| self.places.binary_search(pixel).is_err());
        pixels.iter().try_for_each(|&pixel| self.cross(start, pixel))?;
        self.pixels = pixels;
        Ok(())
    }

    fn search_pixel(&mut self, cell: &Cell, start: usize, vertex: Option<u32>) -> Result<()> {
        match vertex {
            Some(vertex) => self.touch(start, cell.min, vertex),
            // The proof is complete for cells of one pixel: if it fails, segments do meet.
            None if !self.is_apart(cell, start) => self.cross(start, cell.min),
            None => Ok(()),
        }
    }

    /// Enters a crossing that has no vertex.
    fn cross(&mut self, start: usize, pixel: Place) -> Result<()> {
        if self.found.crossings.len() >= self.options.crossings_max {
            return Err(too_many(self.options.crossings_max, "crossings"));
        }
        let number = (self.places.len() + self.found.crossings.len()) as u32;
        self.found.crossings.push(pixel);
        self.touch(start, pixel, number)
    }

    /// Enters all segments of the cell that pass through a hot pixel and do not end there.
    fn touch(&mut self, start: usize, pixel: Place, number: u32) -> Result<()> {
        let [x, y] = pixel.map(|value| value as f64);
        for &segment in &self.cells[start..] {
            let geometry = &self.geometry[segment as usize];
            let [low, high] = geometry.range(1);
            let is_near =
                geometry.a[0] - 1.0 < x && x < geometry.b[0] + 1.0 && low - 1.0 < y && y < high + 1.0;
            if is_near && !geometry.has_end([x, y]) && meets_pixel(geometry.ends(), pixel) {
                self.found.touches.push([self.numbers[segment as usize], number]);
            }
        }
        // Crossings of two segments bend four times at most, the vertices of lines once each in good lines.
        let most = 4 * self.options.crossings_max + 4 * self.places.len();
        if self.found.touches.len() > most { Err(too_many(most, "bends")) } else { self.check_memory() }
    }

    fn check_memory(&self) -> Result<()> {
        let [crossings, bends] = [self.found.crossings.len(), self.found.touches.len()];
        let bytes = crossings as u64 * CROSSING_BYTES + bends as u64 * BEND_BYTES;
        if bytes > self.options.bytes_max {
            Err(Error::LinesBeyondMemory { crossings, bends })
        } else {
            Ok(())
        }
    }
}

fn too_many(most: usize, what: &'static str) -> Error {
    Error::TooManyOfLines { what, most }
}

impl Geometry {
    /// Whether a segment of a cell may meet this half of it, which is divided along `axis`.
    fn is_in_half(&self, half: &Cell, other: &Cell, axis: usize) -> bool {
        let [low, high] = self.range(axis);
        let (min, max) = (half.min[axis] as f64 - 0.5, half.max[axis] as f64 - 0.5);
        if high < min || low > max {
            return false;
        }
        let is_whole = if half.min[axis] < other.min[axis] { high < max } else { low > min };
        is_whole || self.may_meet(half)
    }
}

/// Moves the items with a property before the others, and returns their number.
fn partition<T>(items: &mut [T], has: impl Fn(&T) -> bool) -> usize {
    let mut count = 0;
    for index in 0..items.len() {
        if has(&items[index]) {
            items.swap(count, index);
            count += 1;
        }
    }
    count
}
