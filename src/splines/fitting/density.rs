//! Knots that follow the density of places: the corners of a graded quadtree, moved a little.
//!
//! Where places are spread evenly, the corners are those of a grid. Only where they are four times as dense
//! are cells halved, and they are doubled where places are sixteen times as sparse: a grid predicts better
//! than knots that follow every chance accumulation. Cells without places grow with their distance from
//! places, so that a gap takes few knots, and the spline bends there as a thin plate does.

use foldhash::{HashMap, HashSet};

use super::hull::Border;
use super::knot_placement::{MOVED, between, break_border_chords, check_area, unit};
use spmesh_base::error::{Error, Result};
use spmesh_base::random::Random;
use spmesh_delaunay::predicates::Point2;

/// Halvings of the square around all places, at most.
const DEPTH_MAX: u32 = 30;
/// Places in a cell from which the local density is estimated, at most: fewer make it uncertain.
const PLACES_MAX: usize = 24;
/// Cells between cells of one size and those twice as large, at least.
const LAYERS: i64 = 3;
/// Corners nearer to the border, in sides of their cells, are left out.
const NEAR: f64 = 0.5;
/// Attempts to find a step with few enough knots.
const ATTEMPTS: usize = 8;

/// Places, with their typical distance.
#[derive(Debug)]
pub struct Density {
    places: Vec<Point2>,
    bounds: [Point2; 2],
    distance: f64,
    /// Lesser differences of coordinates are rounding errors.
    rounding: f64,
}

/// A grid of knots, whose cells follow the density.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Sides of cells, in typical distances of places.
    pub step: f64,
    /// How far the convex hull of the knots reaches beyond that of the places. Units: those of coordinates.
    pub margin: f64,
    /// How far the cells reach. Knots of several margins are the same inside if this is.
    pub reach: f64,
    /// Knots at most: the step is made larger until there are no more.
    pub knots_max: usize,
}

impl Density {
    /// The density of distinct places. Of a sample of places, `share` is the part of all.
    ///
    /// # Errors
    /// Places that span no area.
    pub fn of(places: Vec<Point2>, share: f64) -> Result<Density> {
        let bounds =
            places.iter().fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], place| {
                [
                    [0, 1].map(|axis| low[axis].min(place[axis])),
                    [0, 1].map(|axis| high[axis].max(place[axis])),
                ]
            });
        check_area(bounds, places.len() as u64)?;
        let side = [0, 1].map(|axis| bounds[1][axis] - bounds[0][axis]).into_iter().fold(0.0, f64::max);
        let codes = codes(&places, bounds[0], [side; 2]);
        let mut spacings: Vec<(f64, usize)> = leaves(&codes).iter().map(Leaf::spacing).collect();
        spacings.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut left = places.len() / 2;
        let median = spacings.iter().find(|&&(_, count)| {
            let is_here = left < count;
            left = left.saturating_sub(count);
            is_here
        });
        let distance = median.map_or(side, |&(spacing, _)| spacing * side) * share.sqrt();
        let rounding = f64::EPSILON * bounds.as_flattened().iter().fold(0.0, |most, x| x.abs().max(most));
        Ok(Density { places, bounds, distance, rounding })
    }

    /// The same for knots that are moved to a grid with cells of this side.
    #[must_use]
    pub fn on_grid(self, side: f64) -> Density {
        Density { rounding: self.rounding.max(side), ..self }
    }

    /// The typical distance of places: half of them are denser. Units: those of coordinates.
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// The longer side of their box. Units: those of coordinates.
    pub fn extent(&self) -> f64 {
        let [low, high] = self.bounds;
        (high[0] - low[0]).max(high[1] - low[1])
    }

    /// The part of places that are at most so far from the border of their convex hull.
    pub fn part_near_border(&self, distance: f64) -> f64 {
        let border = Border::around(&self.places, distance);
        let near = self.places.iter().filter(|&&place| border.depth(place) <= 2.0 * distance).count();
        near as f64 / self.places.len() as f64
    }

    /// The places.
    pub fn places(&self) -> &[Point2] {
        &self.places
    }

    /// Indices of places, neighbours close to each other: along a curve of Morton.
    pub fn order(&self) -> Vec<u32> {
        let [low, high] = self.bounds;
        let codes = unsorted_codes(&self.places, low, [0, 1].map(|axis| high[axis] - low[axis]));
        let mut order: Vec<u32> = (0..self.places.len() as u32).collect();
        order.sort_by_key(|&index| codes[index as usize]);
        order
    }

    /// Knots over the convex hull of all places and a margin around it, distinct.
    ///
    /// # Errors
    /// Too many knots, however large the step is.
    pub fn knots(&self, placement: Placement) -> Result<Vec<Point2>> {
        let border = Border::around(&self.places, placement.margin);
        let mut step = placement.step;
        for _ in 0..ATTEMPTS {
            let knots = Lattice::new(self, step, placement.reach.max(placement.margin)).knots(self, &border);
            let excess = knots.len() as f64 / placement.knots_max as f64;
            if excess <= 1.0 {
                let middles = break_border_chords(&knots, Vec::new(), usize::MAX)?;
                return Ok([knots, middles].concat());
            }
            step *= 1.05 * excess.sqrt();
        }
        Err(Error::usage(format!("more than {} knots: take a grid, with --step", placement.knots_max)))
    }
}

/// A cell of a quadtree with few places.
struct Leaf {
    depth: u32,
    at: [u32; 2],
    count: usize,
}

impl Leaf {
    /// The distance of its places, in sides of the root, and their number.
    fn spacing(&self) -> (f64, usize) {
        (0.5f64.powi(self.depth as i32) / (self.count as f64).sqrt(), self.count)
    }
}

/// The cells of the root square in units of cells of one size, and of quadtree cells.
struct Lattice {
    bounds: [Point2; 2],
    /// Cells of the usual size along each axis.
    counts: [u32; 2],
    /// Halvings of the root square that lead to cells of the usual size.
    depth: u32,
    /// The typical distance of places, in sides of the root.
    distance: f64,
}

impl Lattice {
    fn new(density: &Density, step: f64, margin: f64) -> Lattice {
        let [low, high] = density.bounds;
        let bounds = [low.map(|x| x - margin), high.map(|x| x + margin)];
        let side = step * density.distance;
        let most = f64::from(1u32 << (DEPTH_MAX / 2));
        let counts =
            [0, 1].map(|axis| ((bounds[1][axis] - bounds[0][axis]) / side).round().clamp(2.0, most) as u32);
        let depth = counts[0].max(counts[1]).next_power_of_two().trailing_zeros();
        // Cells are about square.
        let distance = 0.5f64.powi(depth as i32) / step;
        Lattice { bounds, counts, depth, distance }
    }

    fn knots(&self, density: &Density, border: &Border) -> Vec<Point2> {
        let root = [0, 1].map(|axis| {
            let cell = (self.bounds[1][axis] - self.bounds[0][axis]) / f64::from(self.counts[axis]);
            cell * f64::from(1u32 << self.depth)
        });
        let codes = codes(&density.places, self.bounds[0], root);
        let mut split = Split(vec![HashSet::default(); 2]);
        split.refine(0, [0; 2], 2);
        for leaf in leaves(&codes) {
            split.refine(leaf.depth, leaf.at, self.target(&leaf));
        }
        split.balance();
        let cell = root[0].max(root[1]) * 0.5f64.powi(self.depth as i32);
        let mut knots = border.knots(density.rounding, |place| {
            let part = |axis: usize| (place[axis] - self.bounds[0][axis]) / root[axis];
            root[0].max(root[1]) * split.side_at([part(0), part(1)]).max(1e-3 * cell / root[0])
        });
        knots.extend(self.placed(&split.corners(self), border));
        knots
    }

    /// The depth of cells at the places of a leaf.
    fn target(&self, leaf: &Leaf) -> u32 {
        let density = (self.distance / leaf.spacing().0).log2();
        // Half as dense places along each axis may be a chance, or a leaf that is half empty.
        let finer = if density >= 0.0 { density.floor() } else { (density + 1.0).ceil().min(0.0) };
        (f64::from(self.depth) + finer).clamp(1.0, f64::from(DEPTH_MAX - 2)) as u32
    }

    /// Corners in the world that are well inside of the border, moved a little.
    fn placed(&self, corners: &Corners, border: &Border) -> Vec<Point2> {
        let ends = self.counts.map(|count| (u64::from(count) << (corners.depth - self.depth)) as f64);
        let mut all: Vec<_> = corners.sizes.iter().map(|(&[x, y], &size)| ([y, x], size)).collect();
        all.sort_unstable();
        let cell = (self.bounds[1][0] - self.bounds[0][0]) / ends[0];
        let placed = all.into_iter().filter_map(|([y, x], size)| {
            let size = size as f64;
            // By the place alone, whatever other corners there are.
            let mut random = Random::new(y << 32 ^ x);
            let moved = [unit(&mut random), unit(&mut random)];
            let at = |by: f64| {
                [0, 1].map(|axis| {
                    let [low, high] = self.bounds.map(|corner| corner[axis]);
                    between(low, high, ([x, y][axis] as f64 + by * moved[axis] * size) / ends[axis])
                })
            };
            (border.depth(at(0.0)) > NEAR * size * cell).then(|| at(MOVED))
        });
        placed.collect()
    }
}

/// Cells of a quadtree that are divided, by their depth.
struct Split(Vec<HashSet<[u32; 2]>>);

/// Corners of cells on the lattice of the smallest ones, each with the side of the smallest cell around it.
struct Corners {
    depth: u32,
    sizes: HashMap<[u64; 2], u64>,
}

impl Split {
    /// Divides a cell, and those above it, into cells of depth `target`.
    fn refine(&mut self, depth: u32, at: [u32; 2], target: u32) {
        if self.0.len() < target as usize {
            self.0.resize(target as usize, HashSet::default());
        }
        for above in 0..target.min(depth) {
            self.0[above as usize].insert(at.map(|x| x >> (depth - above)));
        }
        for below in depth..target {
            let side = 1 << (below - depth);
            let first = at.map(|x| x << (below - depth));
            let all = (0..side).flat_map(|j| (0..side).map(move |i| [first[0] + i, first[1] + j]));
            self.0[below as usize].extend(all);
        }
    }

    /// Divides cells until sizes change gradually.
    fn balance(&mut self) {
        for depth in (1..self.0.len()).rev() {
            let end = 1i64 << depth;
            let (above, here) = self.0.split_at_mut(depth);
            for at in &here[0] {
                let around = (-LAYERS..=LAYERS).flat_map(|j| (-LAYERS..=LAYERS).map(move |i| [i, j]));
                for by in around {
                    let next = [0, 1].map(|axis| i64::from(at[axis]) + by[axis]);
                    if next.iter().all(|x| (0..end).contains(x)) {
                        above[depth - 1].insert(next.map(|x| (x >> 1) as u32));
                    }
                }
            }
        }
    }

    /// The side of the cell at a place, in sides of the root.
    fn side_at(&self, part: Point2) -> f64 {
        let at = |depth: usize| part.map(|x| (x.clamp(0.0, 1.0 - 1e-9) * f64::from(1u32 << depth)) as u32);
        let depth = (0..self.0.len()).take_while(|&depth| self.0[depth].contains(&at(depth))).count();
        0.5f64.powi(depth as i32)
    }

    fn corners(&self, lattice: &Lattice) -> Corners {
        let depth = lattice.depth.max(self.0.len() as u32);
        let ends = lattice.counts.map(|count| u64::from(count) << (depth - lattice.depth));
        let mut sizes = HashMap::default();
        for (above, cells) in (1u32..).zip(&self.0) {
            let size = 1u64 << (depth - above);
            let children = cells
                .iter()
                .flat_map(|&[x, y]| [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[i, j]| [2 * x + i, 2 * y + j]));
            let is_leaf = |at: &[u32; 2]| self.0.get(above as usize).is_none_or(|split| !split.contains(at));
            for at in children.filter(is_leaf).map(|at| at.map(|x| u64::from(x) * size)) {
                if (0..2).any(|axis| at[axis] >= ends[axis]) {
                    continue;
                }
                for corner in [[0, 0], [size, 0], [0, size], [size, size]] {
                    let corner = [0, 1].map(|axis| (at[axis] + corner[axis]).min(ends[axis]));
                    let known = sizes.entry(corner).or_insert(size);
                    *known = size.min(*known);
                }
            }
        }
        Corners { depth, sizes }
    }
}

/// Codes of Morton of places in a box, in order.
fn codes(places: &[Point2], low: Point2, sides: Point2) -> Vec<u64> {
    let mut codes = unsorted_codes(places, low, sides);
    codes.sort_unstable();
    codes
}

fn unsorted_codes(places: &[Point2], low: Point2, sides: Point2) -> Vec<u64> {
    let end = f64::from(1u32 << DEPTH_MAX);
    let code = |place: &Point2| {
        let [x, y] = [0, 1].map(|axis| {
            let part = (place[axis] - low[axis]) / sides[axis];
            ((part * end).max(0.0) as u64).min((1 << DEPTH_MAX) - 1)
        });
        spaced(x) | spaced(y) << 1
    };
    places.iter().map(code).collect()
}

/// The bits of a number with a zero before each.
fn spaced(x: u64) -> u64 {
    // Masks have n zeros before n ones each.
    [16, 8, 4, 2, 1].into_iter().fold(x, |x, n| (x | x << n) & (u64::MAX / ((1 << n) + 1)))
}

/// Every second bit of a code.
fn packed(code: u64) -> u32 {
    (0..DEPTH_MAX).map(|bit| (code >> (2 * bit) & 1) << bit).sum::<u64>() as u32
}

/// The largest cells with few enough places, without empty ones.
fn leaves(codes: &[u64]) -> Vec<Leaf> {
    let mut found = Vec::new();
    let mut open = vec![(0, 0..codes.len())];
    while let Some((depth, range)) = open.pop() {
        if range.is_empty() {
            continue;
        }
        let shift = 2 * (DEPTH_MAX - depth);
        let cell = codes[range.start] >> shift;
        if range.len() <= PLACES_MAX || depth == DEPTH_MAX {
            let at = [packed(cell), packed(cell >> 1)];
            found.push(Leaf { depth, at, count: range.len() });
            continue;
        }
        let mut start = range.start;
        for child in 0..4 {
            let last = cell << 2 | child;
            let count = codes[start..range.end].partition_point(|code| code >> (shift - 2) <= last);
            open.push((depth + 1, start..start + count));
            start += count;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random_places(count: usize, side: f64) -> Vec<Point2> {
        let mut random = Random::new(5);
        (0..count).map(|_| [side * random.unit(), side * random.unit()]).collect()
    }

    fn placement(step: f64) -> Placement {
        Placement { step, margin: 0.5, reach: 0.5, knots_max: 1_000_000 }
    }

    /// The distance from a place to the nearest of some others.
    fn nearest(place: Point2, others: &[Point2]) -> f64 {
        let distance = |other: &Point2| (other[0] - place[0]).hypot(other[1] - place[1]);
        others.iter().map(distance).filter(|&distance| distance > 0.0).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn even_places_have_a_grid() {
        let density = Density::of(random_places(4000, 100.0), 1.0).unwrap();
        // The root of the area of a place.
        assert!((density.distance() / 1.58 - 1.0).abs() < 0.15, "{}", density.distance());
        let knots = density.knots(placement(1.0)).unwrap();
        let cells = 101.0 / density.distance();
        let part = knots.len() as f64 / (cells + 1.0).powi(2);
        assert!((0.9..1.2).contains(&part), "{part}");
        let few = density.knots(Placement { knots_max: 500, ..placement(1.0) }).unwrap();
        assert!((250..600).contains(&few.len()), "{}", few.len());
    }

    #[test]
    fn knots_inside_do_not_depend_on_the_margin() {
        let density = Density::of(random_places(500, 10.0), 1.0).unwrap();
        let wide = density.knots(Placement { margin: 10.0, reach: 10.0, ..placement(1.0) }).unwrap();
        let near = density.knots(Placement { reach: 10.0, ..placement(1.0) }).unwrap();
        let is_inside = |knot: &&Point2| knot.iter().all(|x| (1.0..9.0).contains(x));
        assert!(near.iter().filter(is_inside).count() > 200);
        assert!(near.iter().filter(is_inside).all(|knot| wide.contains(knot)));
        assert!(wide.len() < 2 * near.len());
    }

    #[test]
    fn knots_are_dense_where_places_are() {
        let mut places = random_places(2000, 1.0);
        places.extend(random_places(100, 100.0));
        let density = Density::of(places, 1.0).unwrap();
        assert!(density.distance() < 0.05, "{}", density.distance());
        let knots = density.knots(placement(1.0)).unwrap();
        assert!(knots.len() < 6000, "{}", knots.len());
        for (place, range) in [([0.5, 0.5], 0.0..0.05), ([50.0, 50.0], 2.0..12.0)] {
            let distance = nearest(place, &knots);
            let side =
                nearest(knots.iter().copied().find(|&k| nearest(place, &[k]) == distance).unwrap(), &knots);
            assert!(range.contains(&side), "{place:?}: {side}");
        }
    }

    #[test]
    fn gaps_have_few_knots_which_become_denser_towards_places() {
        let sides = (0..400).flat_map(|i| [[0.0, f64::from(i)], [400.0, f64::from(i)]]);
        let density = Density::of(sides.collect(), 1.0).unwrap();
        let knots = density.knots(placement(1.0)).unwrap();
        assert!(knots.len() < 3000, "{}", knots.len());
        let inside = |low: f64, high: f64| knots.iter().filter(|k| (low..high).contains(&k[0])).count();
        assert!(inside(0.0, 20.0) > 3 * inside(180.0, 200.0));
        assert!(inside(150.0, 250.0) >= 20, "{}", inside(150.0, 250.0));
    }

    #[test]
    fn neighbours_are_close_in_order() {
        let density = Density::of(random_places(1000, 100.0), 1.0).unwrap();
        let order = density.order();
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..1000));
        let at = |index: u32| density.places()[index as usize];
        let steps = order.windows(2).map(|pair| nearest(at(pair[0]), &[at(pair[1])]));
        assert!(steps.sum::<f64>() / 999.0 < 6.0);
    }

    #[test]
    fn places_without_an_area_are_refused() {
        for places in [vec![], vec![[1.0, 2.0]], vec![[0.0, 0.0], [1.0, 0.0]]] {
            assert!(Density::of(places, 1.0).is_err());
        }
    }
}
