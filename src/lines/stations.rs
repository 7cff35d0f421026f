//! Elevations along the centre line of a river.

use std::ops::Range;

use spmesh_model::points::Point2;

/// Parts of a centre line that have one box.
const BLOCK: usize = 16;

/// A centre line with the elevation of each of its vertices: its *stations*.
pub(crate) struct Stations {
    places: Vec<Point2>,
    /// The box of each block of parts.
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
        let of_block = |first: usize| {
            let block = &places[first..(first + BLOCK).min(parts) + 1];
            block.iter().fold([block[0]; 2], |[min, max], place| {
                [[0, 1].map(|axis| min[axis].min(place[axis])), [0, 1].map(|axis| max[axis].max(place[axis]))]
            })
        };
        let boxes = (0..parts).step_by(BLOCK).map(of_block).collect();
        Stations { places, boxes, elevations: Vec::new() }
    }

    pub(crate) fn places(&self) -> &[Point2] {
        &self.places
    }

    /// The station nearest to a place, the upper one of equally near ones. Distances are those of f64.
    pub(crate) fn nearest(&self, place: Point2) -> Station {
        self.nearest_of(0..self.places.len() - 1, place)
    }

    /// The nearest station of some parts.
    pub(crate) fn nearest_of(&self, parts: Range<usize>, place: Point2) -> Station {
        let (mut best, mut least) = (Station { part: parts.start, along: 0.0 }, f64::INFINITY);
        for block in parts.start / BLOCK..parts.end.div_ceil(BLOCK) {
            let bounds = self.boxes[block];
            let away =
                |axis: usize| (bounds[0][axis] - place[axis]).max(place[axis] - bounds[1][axis]).max(0.0);
            // A margin for rounding.
            if (away(0) * away(0) + away(1) * away(1)) * (1.0 - 1e-12) > least {
                continue;
            }
            let first = block * BLOCK;
            for part in first.max(parts.start)..(first + BLOCK).min(parts.end) {
                let (along, square) = project([self.places[part], self.places[part + 1]], place);
                if square < least {
                    (best, least) = (Station { part, along }, square);
                }
            }
        }
        best
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

/// The place on a part nearest to another one, from 0 to 1, and the square of their distance.
fn project([a, b]: [Point2; 2], [x, y]: Point2) -> (f64, f64) {
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
    fn the_nearest_station_is_found_among_blocks() {
        let places: Vec<Point2> = (0..200).map(|i| [f64::from(i), f64::from(i * i % 17)]).collect();
        let river = Stations::new(places.clone());
        for number in 0..300 {
            let place = [f64::from(number * 7 % 211), f64::from(number % 23)];
            let all = (0..199).map(|part| (project([places[part], places[part + 1]], place), part));
            let ((along, _), part) = all.min_by(|a, b| a.0.1.total_cmp(&b.0.1)).unwrap();
            assert_eq!(river.nearest(place), Station { part, along }, "{place:?}");
        }
    }
}
