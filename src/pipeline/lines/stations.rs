//! Elevations along the centre line of a river.

use std::ops::Range;

use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::points::Point2;

/// Parts of a centre line in a leaf of the tree of boxes.
const LEAF: usize = 8;

/// A centre line with the elevation of each of its vertices: its *stations*.
pub(crate) struct Stations {
    places: Vec<Point2>,
    /// The boxes of a binary tree: node 1 is the root, nodes 2n and 2n + 1 are below n, and the second half
    /// are leaves.
    boxes: Vec<[Point2; 2]>,
    /// Stored elevations, which never rise downstream.
    pub(crate) elevations: Vec<f64>,
}

/// A place on a centre line: the number of a part, and the place on it from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub(crate) struct Station {
    part: usize,
    along: f64,
}

impl Station {
    /// The start of a line.
    pub(crate) const START: Station = Station { part: 0, along: 0.0 };

    /// The end of a part.
    pub(crate) fn end(part: usize) -> Station {
        Station { part, along: 1.0 }
    }

    /// The lower one.
    pub(crate) fn max(self, other: Station) -> Station {
        if other > self { other } else { self }
    }

    /// The nearer vertex; the upper one of equally near ones.
    pub(crate) fn vertex(self) -> usize {
        self.part + usize::from(self.along > 0.5)
    }
}

impl Stations {
    /// Stations at two places at least.
    pub(crate) fn new(places: Vec<Point2>) -> Stations {
        let parts = places.len() - 1;
        let leaves = parts.div_ceil(LEAF).next_power_of_two();
        let mut boxes = vec![NOWHERE; 2 * leaves];
        for (part, ends) in places.windows(2).enumerate() {
            let leaf = &mut boxes[leaves + part / LEAF];
            ends.iter().for_each(|&place| *leaf = join(*leaf, [place; 2]));
        }
        (1..leaves).rev().for_each(|node| boxes[node] = join(boxes[2 * node], boxes[2 * node + 1]));
        Stations { places, boxes, elevations: Vec::new() }
    }

    /// A line through points, whose elevations are kept.
    pub(crate) fn of(points: &[Point]) -> Stations {
        let places = points.iter().map(|&[x, y, _]| [x, y]).collect();
        Stations { elevations: points.iter().map(|point| point[2]).collect(), ..Stations::new(places) }
    }

    pub(crate) fn places(&self) -> &[Point2] {
        &self.places
    }

    /// The station nearest to a place, the upper one of equally near ones. Distances are those of f64.
    pub(crate) fn nearest(&self, place: Point2) -> Station {
        self.nearest_of(0..self.places.len() - 1, place)
    }

    /// The square of the distance to the nearest station, and the elevation there.
    pub(crate) fn nearest_level(&self, place: Point2) -> (f64, f64) {
        let (station, square) = self.find(0..self.places.len() - 1, place);
        (square, self.elevation(station))
    }

    /// The nearest station of some parts.
    pub(crate) fn nearest_of(&self, parts: Range<usize>, place: Point2) -> Station {
        self.find(parts, place).0
    }

    /// The nearest station of some parts, and the square of its distance.
    fn find(&self, parts: Range<usize>, place: Point2) -> (Station, f64) {
        let mut found = (Station { part: parts.start, along: 0.0 }, f64::INFINITY);
        self.search(1, &parts, place, &mut found);
        found
    }

    /// Finds a nearer station below a node of the tree; `found` has the nearest one so far, and the square of
    /// its distance.
    fn search(&self, node: usize, parts: &Range<usize>, place: Point2, found: &mut (Station, f64)) {
        let leaves = self.boxes.len() / 2;
        let level = node.ilog2();
        let width = LEAF * (leaves >> level);
        let first = (node - (1 << level)) * width;
        let own = first.max(parts.start)..(first + width).min(parts.end);
        // A margin for rounding.
        if own.is_empty() || self.away(node, place) * (1.0 - 1e-12) > found.1 {
            return;
        }
        if node < leaves {
            let mut below = [2 * node, 2 * node + 1];
            if self.away(below[1], place) < self.away(below[0], place) {
                below.reverse();
            }
            return below.into_iter().for_each(|node| self.search(node, parts, place, found));
        }
        for part in own {
            let (along, square) = project([self.places[part], self.places[part + 1]], place);
            if square < found.1 || square == found.1 && part < found.0.part {
                *found = (Station { part, along }, square);
            }
        }
    }

    /// The square of the distance of a place from the box of a node.
    fn away(&self, node: usize, place: Point2) -> f64 {
        let [min, max] = self.boxes[node];
        let [x, y] = [0, 1].map(|axis| (min[axis] - place[axis]).max(place[axis] - max[axis]).max(0.0));
        x * x + y * y
    }

    /// The elevation at a station.
    pub(crate) fn elevation(&self, station: Station) -> f64 {
        let [a, b] = [self.elevations[station.part], self.elevations[station.part + 1]];
        // Exact at both ends, and never beyond them.
        if station.along >= 1.0 { b } else { (a + (b - a) * station.along).clamp(b.min(a), a.max(b)) }
    }

    /// Takes elevations at vertices, where they are known: interpolates the others linearly along the line,
    /// keeps the nearest known one before the first and behind the last, and lowers each to those upstream.
    /// Returns how many were lowered; `None` if none is known.
    pub(crate) fn settle(&mut self, known: &[Option<f64>]) -> Option<u64> {
        let first = known.iter().position(Option::is_some)?;
        let mut levels = vec![known[first]?; known.len()];
        let mut before = first;
        for index in first + 1..known.len() {
            levels[index] = known[index].unwrap_or(levels[before]);
            if let Some(z) = known[index] {
                self.fill(&mut levels, [before, index], z);
                before = index;
            }
        }
        let mut lowered = 0;
        for index in 1..levels.len() {
            if levels[index] > levels[index - 1] {
                levels[index] = levels[index - 1];
                lowered += 1;
            }
        }
        self.elevations = levels;
        Some(lowered)
    }

    /// Interpolates between two known vertices.
    fn fill(&self, levels: &mut [f64], [from, to]: [usize; 2], z: f64) {
        let length = |part: usize| {
            let [a, b] = [self.places[part], self.places[part + 1]];
            (b[0] - a[0]).hypot(b[1] - a[1])
        };
        let whole: f64 = (from..to).map(length).sum();
        let mut along = 0.0;
        for index in from + 1..to {
            along += length(index - 1);
            let part = if whole > 0.0 { along / whole } else { 0.0 };
            levels[index] = levels[from] + (z - levels[from]) * part;
        }
    }
}

/// A box without places.
const NOWHERE: [Point2; 2] = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];

/// The box around two boxes.
fn join([a, b]: [Point2; 2], [c, d]: [Point2; 2]) -> [Point2; 2] {
    [[0, 1].map(|axis| a[axis].min(c[axis])), [0, 1].map(|axis| b[axis].max(d[axis]))]
}

/// The place on a part nearest to another one, from 0 to 1, and the square of their distance.
pub(crate) fn project([a, b]: [Point2; 2], [x, y]: Point2) -> (f64, f64) {
    let [u, v] = [b[0] - a[0], b[1] - a[1]];
    let square = u * u + v * v;
    let along = if square > 0.0 { ((x - a[0]) * u + (y - a[1]) * v) / square } else { 0.0 };
    let along = along.clamp(0.0, 1.0);
    let [p, q] = [x - (a[0] + along * u), y - (a[1] + along * v)];
    (along, p * p + q * q)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elevations_never_rise_and_gaps_are_filled() {
        let mut river = Stations::new([0.0, 1.0, 2.0, 4.0, 5.0, 6.0].map(|x| [x, 0.0]).to_vec());
        assert_eq!(river.settle(&[None; 6]), None);
        assert_eq!(river.settle(&[None, Some(9.0), None, Some(3.0), Some(5.0), None]), Some(2));
        assert_eq!(river.elevations, [9.0, 9.0, 7.0, 3.0, 3.0, 3.0]);
        let at = |place: Point2| river.elevation(river.nearest(place));
        assert_eq!((at([1.5, 7.0]), at([-3.0, 1.0]), at([9.0, 0.0]), at([3.0, -1.0])), (8.0, 9.0, 3.0, 5.0));
    }

    #[test]
    fn the_nearest_station_is_found_among_all_or_some() {
        let places: Vec<Point2> = (0..200).map(|i| [f64::from(i), f64::from(i * i % 17)]).collect();
        let river = Stations::new(places.clone());
        for number in 0..300 {
            let place = [f64::from(number * 7 % 211), f64::from(number % 23)];
            for parts in [0..199, number as usize % 150..number as usize % 150 + 49, 7..8] {
                let all = parts.clone().map(|part| (project([places[part], places[part + 1]], place), part));
                let ((along, _), part) = all.min_by(|a, b| a.0.1.total_cmp(&b.0.1)).unwrap();
                assert_eq!(river.nearest_of(parts, place), Station { part, along }, "{place:?}");
            }
        }
    }
}
