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
    neighbours: Neighbours,
    /// The regions of the last point, increasing.
    regions: Vec<u32>,
    others: Vec<u32>,
}

impl Members {
    /// All regions of `among` that points in a closed box have, and perhaps a few more, increasing. `among`
    /// is increasing, and has all regions that they have.
    ///
    /// Cost: a few times that of one point, if the box is small.
    pub(crate) fn of_all(
        &mut self,
        extent: Extent,
        among: &[u32],
        diagram: &Diagram,
        boxes: &Boxes,
    ) -> &[u32] {
        match Set::around(extent) {
            Some(set) => {
                diagram.search_near(set.point, set.near, &mut self.search, |_| true);
                self.find(set, among, diagram, boxes);
            }
            None => {
                self.regions.clear();
                self.regions.extend(among);
            }
        }
        &self.regions
    }

    /// The only region of all points in a closed box, if they certainly have no other.
    ///
    /// Cost: less than that of all regions, if there are several.
    pub(crate) fn only(&mut self, extent: Extent, diagram: &Diagram, boxes: &Boxes) -> Option<u32> {
        let set = Set::around(extent)?;
        let (mut only, mut is_one) = (None, true);
        diagram.search_near(set.point, set.near, &mut self.search, |place| {
            is_one = place.is_some() && place == *only.get_or_insert(place);
            is_one
        });
        let only = only.flatten().filter(|_| is_one)?;
        let region = boxes.get(only as usize);
        let is_inside = |&edge: &[u32; 2]| {
            let place = diagram.balls.get(edge[1] as usize).and_then(|ball| ball.place);
            place == Some(only) || is_inside(&region, &vertex_on(edge, set, diagram))
        };
        self.search.border.iter().all(is_inside).then_some(only)
    }

    /// The regions of a point, increasing, out of `among`, as above: those of the boxes that its Voronoi
    /// cell, among the points of the sample and itself, meets, and perhaps a few that it hardly misses.
    ///
    /// Cost: that of an insertion without its change.
    pub(crate) fn of(&mut self, point: Point3, among: &[u32], diagram: &Diagram, boxes: &Boxes) -> &[u32] {
        let is_sample = diagram.search(point, &mut self.search);
        self.find(Set { point, near: 0.0, is_sample }, among, diagram, boxes);
        &self.regions
    }

    /// Finds the regions of the boxes that the Voronoi cells of a set meet.
    fn find(&mut self, set: Set, among: &[u32], diagram: &Diagram, boxes: &Boxes) {
        let Members { search, neighbours, regions, others } = self;
        regions.clear();
        let mut found = Found { among, regions, are_all_known: true };
        found.add_vertices(set, diagram, boxes, search);
        let are_all_known = found.are_all_known;
        let vertices = regions.len();
        // Cells may meet other boxes between their vertices.
        let is_between = |number: &&u32| {
            let met = &regions[..vertices];
            !(met.contains(number) || are_all_known && is_beside(&boxes.get(**number as usize), met, boxes))
        };
        others.clear();
        others.extend(among.iter().filter(is_between));
        if !others.is_empty() {
            neighbours.find(diagram, search);
            let nearer = || neighbours.found.iter().map(|&vertex| diagram.points[vertex as usize]);
            let is_met = |number: u32, extent: &Extent| {
                let within = intersection(&boxes.get(number as usize), extent);
                !is_empty(&within) && !nearer().any(|other| is_nearer(other, set, &within))
            };
            let extent = extent_of_centres(diagram, search);
            others.retain(|&number| is_met(number, &extent));
            regions.append(others);
        }
        regions.sort_unstable();
        debug_assert!(!regions.is_empty(), "a Voronoi cell meets a box");
    }
}

/// The boxes that have vertices of the Voronoi cells of a set, and perhaps a few more.
struct Found<'f> {
    /// All that the cells meet, increasing.
    among: &'f [u32],
    regions: &'f mut Vec<u32>,
    /// Whether all vertices lie in these boxes.
    are_all_known: bool,
}

impl Found<'_> {
    fn add(&mut self, number: u32) {
        if self.among.binary_search(&number).is_err() {
            // No cell has such a centre. But the edges to it, where some have a vertex, may meet any box.
            self.are_all_known = false;
        } else if !self.regions.contains(&number) {
            self.regions.push(number);
        }
    }

    /// Adds boxes until there are no more.
    fn add_vertices(&mut self, set: Set, diagram: &Diagram, boxes: &Boxes, search: &Search) {
        for &cell in &search.conflicts {
            match diagram.balls.get(cell as usize) {
                Some(&Ball { place: Some(number), .. }) => self.add(number),
                Some(ball) => boxes.visit(Growing::of_centre(ball), &mut |number| self.add(number)),
                None => self.are_all_known = false,
            }
        }
        for &edge in set.border(search) {
            if self.regions.len() == self.among.len() {
                break;
            }
            let [taken, left] = edge.map(|cell| diagram.balls.get(cell as usize));
            self.are_all_known &= taken.is_some() || left.is_some();
            let place = taken.and_then(|ball| ball.place);
            if place.is_none() || place != left.and_then(|ball| ball.place) {
                boxes.visit(vertex_on(edge, set, diagram), &mut |number| self.add(number));
            }
        }
    }
}

/// All places up to `near` from a point, or a point of the sample.
#[derive(Debug, Clone, Copy)]
struct Set {
    point: Point3,
    near: f64,
    is_sample: bool,
}

impl Set {
    /// All places in a ball that a box lies in, if it is finite.
    fn around([low, high]: Extent) -> Option<Set> {
        let point: Point3 = std::array::from_fn(|axis| 0.5 * low[axis] + 0.5 * high[axis]);
        // Squares of what is less may underflow.
        let least = 4.0 * f64::MIN_POSITIVE.sqrt();
        let half: Point3 =
            std::array::from_fn(|axis| (point[axis] - low[axis]).max(high[axis] - point[axis]));
        let near = square_of_distance(half, [0.0; 3]).sqrt() * (1.0 + ROUNDING) + least;
        near.is_finite().then_some(Set { point, near, is_sample: false })
    }

    /// The edges from centres that points of the set take to others. A point of the sample has no vertices
    /// there.
    fn border(self, search: &Search) -> &[[u32; 2]] {
        if self.is_sample { &[] } else { &search.border }
    }
}

/// The points of the sample whose cells are beside the one that was searched.
#[derive(Debug, Default)]
struct Neighbours {
    found: Vec<u32>,
    /// For each point of the sample the number of the last search that found it.
    seen: Vec<u32>,
    number: u32,
}

impl Neighbours {
    fn find(&mut self, diagram: &Diagram, search: &Search) {
        self.found.clear();
        if self.seen.len() != diagram.points.len() || self.number == u32::MAX {
            self.seen.clear();
            self.seen.resize(diagram.points.len(), 0);
            self.number = 0;
        }
        self.number += 1;
        for &[cell, beyond] in &search.border {
            let [cell, beyond] = [cell, beyond].map(|cell| &diagram.cells[cell as usize].vertices);
            for &vertex in cell.iter().filter(|vertex| **vertex != INFINITE && beyond.contains(vertex)) {
                if std::mem::replace(&mut self.seen[vertex as usize], self.number) != self.number {
                    self.found.push(vertex);
                }
            }
        }
    }
}

/// A box that grows around what is added.
struct Growing(Extent);

impl Growing {
    fn new() -> Growing {
        Growing([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]])
    }

    fn of_centre(ball: &Ball) -> Extent {
        let mut extent = Growing::new();
        extent.add_centre(ball);
        extent.0
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

/// A box of the Voronoi cells of a set: their vertices lie between the centres that were searched.
fn extent_of_centres(diagram: &Diagram, search: &Search) -> Extent {
    let mut extent = Growing::new();
    for &cell in search.conflicts.iter().chain(search.border.iter().map(|[_, beyond]| beyond)) {
        match diagram.balls.get(cell as usize) {
            Some(ball) => extent.add_centre(ball),
            None => extent.add_direction(&Outward::of(diagram, cell)),
        }
    }
    extent.0
}

/// The box of the vertices on the edge between a centre that points of a set take, and one that they do not
/// take: where the power of the point in the balls, which is linear along the edge, changes its sign.
fn vertex_on([cell, beyond]: [u32; 2], set: Set, diagram: &Diagram) -> Extent {
    let mut extent = Growing::new();
    match [cell, beyond].map(|cell| diagram.balls.get(cell as usize)) {
        [Some(taken), Some(left)] => add_crossing(&mut extent, set, taken, left),
        [Some(taken), None] => add_ray(&mut extent, set, taken, &Outward::of(diagram, beyond)),
        [None, Some(left)] => {
            extent.add_centre(left);
            extent.add_direction(&Outward::of(diagram, cell));
        }
        [None, None] => {
            extent.add_direction(&Outward::of(diagram, cell));
            extent.add_direction(&Outward::of(diagram, beyond));
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

/// Whether a box lies on one side of a plane along the axes, and all of some others on the other side.
fn is_beside(region: &Region<3>, others: &[u32], boxes: &Boxes) -> bool {
    let others = || others.iter().map(|&number| boxes.get(number as usize));
    (0..3).any(|axis| {
        others().all(|other| other.max[axis] <= region.min[axis])
            || others().all(|other| region.max[axis] <= other.min[axis])
    })
}

/// Whether a box lies within a region, and not on its sides.
fn is_inside(region: &Region<3>, [low, high]: &Extent) -> bool {
    (0..3).all(|axis| low[axis] > region.min[axis] && high[axis] < region.max[axis])
}

fn is_empty([low, high]: &Extent) -> bool {
    (0..3).any(|axis| low[axis] > high[axis])
}

/// Whether all of these places are certainly nearer to `other` than to any point of a set.
fn is_nearer(other: Point3, Set { point, near, .. }: Set, places: &Extent) -> bool {
    // 2 (c - p) (q - p) - |q - p|^2, the square of |c - p| without that of |c - q|, is positive where c is
    // nearer to q.
    let (mut least, mut size, mut far) = (0.0, 0.0, 0.0);
    for axis in 0..3 {
        let way = other[axis] - point[axis];
        let [low, high] = [0, 1].map(|side| places[side][axis] - point[axis]);
        far += low.abs().max(high.abs()).powi(2);
        if way == 0.0 {
            continue;
        }
        let place = places[usize::from(way < 0.0)][axis];
        least += (2.0 * (place - point[axis]) - way) * way;
        size += (2.0 * (place.abs() + point[axis].abs()) + way.abs()) * way.abs();
    }
    // The other points of the set are nearer to c by so much at most.
    let off = if near > 0.0 { 2.0 * near * far.sqrt() * (1.0 + ROUNDING) } else { 0.0 };
    // A NaN is not greater.
    least > off + ROUNDING * size + f64::MIN_POSITIVE
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_base::random::Random;

    /// A place on a bumpy surface.
    fn place(random: &mut Random) -> Point3 {
        let [x, y] = [0; 2].map(|_| 8.0 * random.unit());
        [x, y, (1.3 * x).sin() + (1.1 * y).cos()]
    }

    /// A place in the Voronoi cell of a point, in a random direction.
    fn within_cell(point: Point3, sample: &[Point3], random: &mut Random) -> Point3 {
        let way: Point3 = [0; 3].map(|_| random.unit() - 0.5);
        let far = sample.iter().map(|other| {
            let off: Point3 = std::array::from_fn(|axis| other[axis] - point[axis]);
            let [square, along] = [off, way].map(|by| (0..3).map(|axis| by[axis] * off[axis]).sum::<f64>());
            if along > 0.0 { 0.5 * square / along } else { f64::INFINITY }
        });
        let reach = random.unit().sqrt() * far.fold(50.0, f64::min);
        std::array::from_fn(|axis| point[axis] + reach * way[axis])
    }

    #[test]
    fn all_boxes_that_a_cell_meets_are_found() {
        let mut random = Random::new(11);
        let sample: Vec<Point3> = (0..300).map(|_| place(&mut random)).collect();
        let mut diagram = Diagram::of(&sample).unwrap().unwrap();
        let boxes = Boxes::lay(&diagram, &vec![0.0; sample.len()], 20);
        boxes.place_centres(&mut diagram);
        let all: Vec<u32> = (0..boxes.len() as u32).collect();
        let mut members = Members::default();
        let (mut some_of_all, mut met) = (0, 0);
        for round in 0..300 {
            let size = [0.01, 0.1, 0.3, 0.6, 1.0, 2.0][round % 6];
            let low = place(&mut random);
            let some = members.of_all([low, low.map(|x| x + size)], &all, &diagram, &boxes).to_vec();
            some_of_all += some.len();
            for _ in 0..4 {
                let point: Point3 = low.map(|x| x + size * random.unit());
                let regions = members.of(point, &some, &diagram, &boxes);
                for _ in 0..10 {
                    let place = within_cell(point, &sample, &mut random);
                    let mut number = u32::MAX;
                    boxes.visit([place, place], &mut |found| number = found);
                    assert!(some.contains(&number), "{point:?} within {size}, {place:?}");
                    assert!(regions.contains(&number), "{point:?}, {place:?}");
                    met += usize::from(number != regions[0]);
                }
            }
        }
        assert!(some_of_all < 225 * all.len() && met > 5_000, "{some_of_all}, {met}");
    }
}
