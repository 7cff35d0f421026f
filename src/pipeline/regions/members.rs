//! The regions that a point is in.

use super::boxes::{Boxes, Extent};
use super::diagram::{Ball, Diagram, INFINITE, ROUNDING, Search, square_of_distance};
use super::outward::Outward;
use spmesh_delaunay::predicates::Point3;
use spmesh_stream::model::bounds::Region;

/// Finds the regions of points: buffers of one thread.
#[derive(Debug, Default)]
pub(crate) struct Members {
    search: Search,
    neighbours: Vec<u32>,
    /// The regions of the last point, increasing.
    regions: Vec<u32>,
}

impl Members {
    /// The only region of all these points, if they certainly have no other.
    ///
    /// Cost: a few times that of one of them, if they are near each other.
    pub(crate) fn of_all(&mut self, points: &[Point3], diagram: &Diagram, boxes: &Boxes) -> Option<u32> {
        let mut around = Growing::new();
        points.iter().for_each(|&point| around.add(point, 0.0));
        let Growing([low, high]) = around;
        let point: Point3 = std::array::from_fn(|axis| 0.5 * low[axis] + 0.5 * high[axis]);
        // Squares of what is less may underflow.
        let least = 4.0 * f64::MIN_POSITIVE.sqrt();
        let near = square_of_distance(low, high).sqrt() * (0.5 + ROUNDING) + least;
        let is_bounded = near.is_finite() && diagram.search_near(point, near, &mut self.search);
        if is_bounded {
            only_box(Set { point, near, is_sample: false }, diagram, boxes, &self.search)
        } else {
            None
        }
    }

    /// The regions of a point, increasing: those of the boxes that its Voronoi cell, among the points of the
    /// sample and itself, meets, and perhaps a few that it hardly misses.
    ///
    /// Cost: that of an insertion without its change.
    pub(crate) fn of(&mut self, point: Point3, diagram: &Diagram, boxes: &Boxes) -> &[u32] {
        let is_sample = diagram.search(point, &mut self.search);
        let set = Set { point, near: 0.0, is_sample };
        let Members { search, neighbours, regions } = self;
        regions.clear();
        if let Some(only) = only_box(set, diagram, boxes, search) {
            regions.push(only);
            return regions;
        }
        let extent = extent_of_cell(set, diagram, search);
        boxes.visit(extent, &mut |number| regions.push(number));
        if regions.len() > 1 {
            find_neighbours(diagram, search, neighbours);
            regions.retain(|&number| {
                let within = intersection(&boxes.get(number as usize), &extent);
                let mut nearer = neighbours.iter().map(|&vertex| diagram.points[vertex as usize]);
                !nearer.any(|other| is_nearer(other, point, &within))
            });
        }
        debug_assert!(!regions.is_empty(), "a Voronoi cell meets a box");
        regions
    }
}

/// All places up to `near` from a point, or a point of the sample.
#[derive(Debug, Clone, Copy)]
struct Set {
    point: Point3,
    near: f64,
    is_sample: bool,
}

/// The points of the sample whose cells are beside the one that was searched.
fn find_neighbours(diagram: &Diagram, search: &Search, neighbours: &mut Vec<u32>) {
    neighbours.clear();
    for &[cell, beyond] in &search.border {
        let [cell, beyond] = [cell, beyond].map(|cell| &diagram.cells[cell as usize].vertices);
        let shared = cell.iter().filter(|vertex| **vertex != INFINITE && beyond.contains(vertex));
        neighbours.extend(shared);
    }
    neighbours.sort_unstable();
    neighbours.dedup();
}

/// The box that has all vertices of the Voronoi cells of a set inside, and so the cells, as boxes are convex.
fn only_box(set: Set, diagram: &Diagram, boxes: &Boxes, search: &Search) -> Option<u32> {
    let place = |cell: &u32| diagram.balls.get(*cell as usize).and_then(|ball| ball.place);
    let first = search.conflicts.iter().find_map(place)?;
    // Vertices may lie between any two centres that only some of the points take.
    if (set.is_sample || set.near > 0.0) && !search.conflicts.iter().all(|cell| place(cell) == Some(first)) {
        return None;
    }
    let region = boxes.get(first as usize);
    let is_inside = |&[cell, beyond]: &[u32; 2]| {
        let Some(taken) = diagram.balls.get(cell as usize) else { return false };
        let mut extent = Growing::new();
        match diagram.balls.get(beyond as usize) {
            Some(left) if taken.place == Some(first) && left.place == Some(first) => return true,
            Some(left) => add_crossing(&mut extent, set, taken, left),
            None => add_ray(&mut extent, set, taken, &Outward::of(diagram, beyond)),
        }
        let Growing([low, high]) = extent;
        (0..3).all(|axis| low[axis] > region.min[axis] && high[axis] < region.max[axis])
    };
    (set.is_sample || search.border.iter().all(is_inside)).then_some(first)
}

/// A box that grows around what is added.
struct Growing(Extent);

impl Growing {
    fn new() -> Growing {
        Growing([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]])
    }

    /// Adds a place that may be off by `error`.
    #[inline]
    fn add(&mut self, place: Point3, error: f64) {
        let Growing([low, high]) = self;
        for axis in 0..3 {
            let off = error + ROUNDING * place[axis].abs();
            let (least, greatest) = (place[axis] - off, place[axis] + off);
            // What is not known is everywhere.
            low[axis] = low[axis].min(if least.is_finite() { least } else { f64::NEG_INFINITY });
            high[axis] = high[axis].max(if greatest.is_finite() { greatest } else { f64::INFINITY });
        }
    }

    fn add_centre(&mut self, ball: &Ball) {
        self.add(ball.centre, ball.error);
    }

    /// Adds what lies infinitely far outside of a facet of the hull.
    fn add_direction(&mut self, outward: &Outward) {
        let Growing([low, high]) = self;
        for axis in 0..3 {
            let (normal, error) = (outward.normal[axis], outward.error[axis]);
            // A normal that overflowed may go both ways.
            let is_known = normal.is_finite() && error.is_finite();
            if !is_known || normal + error > 0.0 {
                high[axis] = f64::INFINITY;
            }
            if !is_known || normal - error < 0.0 {
                low[axis] = f64::NEG_INFINITY;
            }
        }
    }
}

/// The box of the Voronoi cell of a point.
///
/// A vertex of the cell lies on an edge between a centre that the point takes and one that it does not take,
/// where the power of the point in the balls changes its sign; it is linear along the edge.
fn extent_of_cell(set: Set, diagram: &Diagram, search: &Search) -> Extent {
    let mut extent = Growing::new();
    if set.is_sample {
        for &cell in &search.conflicts {
            match diagram.balls.get(cell as usize) {
                Some(ball) => extent.add_centre(ball),
                None => extent.add_direction(&Outward::of(diagram, cell)),
            }
        }
        return extent.0;
    }
    for &[cell, beyond] in &search.border {
        match (diagram.balls.get(cell as usize), diagram.balls.get(beyond as usize)) {
            (Some(taken), Some(left)) => add_crossing(&mut extent, set, taken, left),
            (Some(taken), None) => add_ray(&mut extent, set, taken, &Outward::of(diagram, beyond)),
            (None, Some(left)) => {
                extent.add_centre(left);
                extent.add_direction(&Outward::of(diagram, cell));
            }
            (None, None) => {
                extent.add_direction(&Outward::of(diagram, cell));
                extent.add_direction(&Outward::of(diagram, beyond));
            }
        }
    }
    extent.0
}

/// Adds the places between two centres at which the power of a point of a set may be zero.
#[inline]
fn add_crossing(extent: &mut Growing, set: Set, taken: &Ball, left: &Ball) {
    let sizes = taken.centre.iter().chain(&left.centre).fold(0.0, |sum, x| sum + x.abs());
    let error = taken.error + left.error + ROUNDING * sizes;
    for share in crossing(power(set, taken), power(set, left)) {
        let place = |axis: usize| (1.0 - share) * taken.centre[axis] + share * left.centre[axis];
        extent.add([0, 1, 2].map(place), error);
    }
}

/// The power of the point of a set in a ball, and how far off those of all its points may be.
#[inline]
fn power(Set { point, near, .. }: Set, ball: &Ball) -> (f64, f64) {
    let square = square_of_distance(point, ball.centre);
    let off = 8.0 * ball.error * (square.sqrt() + ball.square.sqrt() + ball.error + near);
    let error = off + near * (2.0 * square.sqrt() + near) * (1.0 + ROUNDING);
    (square - ball.square, error + ROUNDING * (square + ball.square))
}

/// The least and the greatest part of the way from a place of this power, which is not positive, to one of
/// that power, which is not negative, at which it is zero.
fn crossing((taken, taken_error): (f64, f64), (left, left_error): (f64, f64)) -> [f64; 2] {
    let part = |from: f64, to: f64| {
        let (sum, part) = (from + to, from / (from + to));
        (sum.is_finite() && part.is_finite()).then_some(part)
    };
    let near = part((-taken - taken_error).max(0.0), left + left_error).unwrap_or(0.0);
    let far = part(-taken + taken_error, (left - left_error).max(0.0)).unwrap_or(1.0);
    [(near - ROUNDING).max(0.0), (far + ROUNDING).min(1.0)]
}

/// Adds the places on the ray from a centre outward at which the power of a point of a set may be zero.
fn add_ray(extent: &mut Growing, set: Set, taken: &Ball, outward: &Outward) {
    let Set { point, near, .. } = set;
    let Outward { normal, error, from } = outward;
    extent.add_centre(taken);
    let (mut slope, mut slope_error) = (0.0, 0.0);
    for axis in 0..3 {
        let length = from[axis] - point[axis];
        slope += 2.0 * normal[axis] * length;
        let size = from[axis].abs() + point[axis].abs();
        slope_error += 4.0 * (error[axis] * length.abs() + ROUNDING * normal[axis].abs() * size);
        slope_error += 2.0 * near * (normal[axis].abs() + error[axis]) * (1.0 + ROUNDING);
    }
    let (power, power_error) = power(set, taken);
    let reach = (power_error - power) / (slope - slope_error);
    if !(slope > slope_error && reach.is_finite()) {
        return extent.add_direction(outward);
    }
    for side in [-1.0, 1.0] {
        let place = |axis: usize| taken.centre[axis] + reach * (normal[axis] + side * error[axis]);
        extent.add([0, 1, 2].map(place), taken.error);
    }
}

/// What a box and an extent have in common.
fn intersection(region: &Region<3>, extent: &Extent) -> Extent {
    let [low, high] = extent;
    [0, 1].map(|side| {
        std::array::from_fn(|axis| match side {
            0 => region.min[axis].max(low[axis]),
            _ => region.max[axis].min(high[axis]),
        })
    })
}

/// Whether all of these places are certainly nearer to `other` than to `point`.
fn is_nearer(other: Point3, point: Point3, places: &Extent) -> bool {
    // 2 (c - p) (q - p) - |q - p|^2 is positive where c is nearer to q.
    let (mut least, mut size) = (0.0, 0.0);
    for axis in 0..3 {
        let way = other[axis] - point[axis];
        if way == 0.0 {
            continue;
        }
        let place = places[usize::from(way < 0.0)][axis];
        least += (2.0 * (place - point[axis]) - way) * way;
        size += (2.0 * (place.abs() + point[axis].abs()) + way.abs()) * way.abs();
    }
    // A NaN is not greater.
    least > ROUNDING * size + f64::MIN_POSITIVE
}
