//! Copies of knots, drawn apart.

use std::collections::{HashMap, HashSet};
use std::f64::consts::TAU;

use spmesh_configurations::Configurations;
use spmesh_stream::model::bounds::Point;

/// How far copies move: this share of the distance from their place to the nearest neighbour.
const SHARE: f64 = 0.22;

/// How often the moves of copies are halved, at most.
const HALVINGS_MAX: usize = 16;

/// The places of knots, with the copies of each on a small circle around their place.
///
/// Two copies move so that the flat triangles of the start triangulation between them open to the side that
/// their order states, as if the knots had been pulled apart slightly (thesis, figure 8.7). More copies are
/// spaced evenly, in the order of the directions of their neighbours. Moves are halved until they turn no
/// triangle of three places over.
pub(super) fn apart(places: &[Point], start: Option<&Configurations>) -> Vec<Point> {
    let triangles: Vec<[usize; 3]> =
        start.into_iter().flat_map(Configurations::iter).map(|(b, _)| b.map(|knot| knot as usize)).collect();
    let mut moves = moves(places, &Surroundings::of(places, &triangles));
    let mut moved = at(places, &moves);
    for _ in 0..HALVINGS_MAX {
        let turned =
            triangles.iter().filter(|corners| area(places, corners) > 0.0 && area(&moved, corners) <= 0.0);
        let turned: Vec<usize> = turned.flatten().copied().collect();
        if turned.is_empty() {
            break;
        }
        // Copies stay at the same distance from their place.
        let keys: HashSet<Key> = turned.into_iter().map(|knot| key(&places[knot])).collect();
        for (_, offset) in places.iter().zip(&mut moves).filter(|(place, _)| keys.contains(&key(place))) {
            *offset = offset.map(|part| part / 2.0);
        }
        moved = at(places, &moves);
    }
    moved
}

/// What is equal for the copies of a knot.
type Key = [u64; 2];

fn key([x, y, _]: &Point) -> Key {
    // Adding 0.0 turns -0.0 into 0.0.
    [x + 0.0, y + 0.0].map(f64::to_bits)
}

/// The move of each knot; knots without copies stay.
fn moves(places: &[Point], surroundings: &Surroundings) -> Vec<[f64; 2]> {
    let mut groups: HashMap<Key, Vec<usize>> = HashMap::new();
    for (knot, place) in places.iter().enumerate() {
        groups.entry(key(place)).or_default().push(knot);
    }
    let mut moves = vec![[0.0; 2]; places.len()];
    for copies in groups.into_values().filter(|copies| copies.len() > 1) {
        let reach = copies.iter().map(|&copy| surroundings.nearest[copy]).fold(f64::INFINITY, f64::min);
        let radius = SHARE * if reach.is_finite() { reach } else { spacing(places) };
        for (copy, way) in surroundings.directions(&copies) {
            moves[copy] = way.map(|part| radius * part);
        }
    }
    moves
}

fn at(places: &[Point], moves: &[[f64; 2]]) -> Vec<Point> {
    places.iter().zip(moves).map(|([x, y, z], [dx, dy])| [x + dx, y + dy, *z]).collect()
}

/// Twice the signed area of a triangle, rounded.
fn area(places: &[Point], corners: &[usize; 3]) -> f64 {
    let [a, b, c] = corners.map(|knot| places[knot]);
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// What lies around each knot.
struct Surroundings {
    /// Sum of the directions of neighbours elsewhere.
    towards: Vec<[f64; 2]>,
    /// For knots with copies: the direction that opens their flat triangles.
    opening: Vec<[f64; 2]>,
    /// Distance to the nearest neighbour elsewhere.
    nearest: Vec<f64>,
}

impl Surroundings {
    fn of(places: &[Point], triangles: &[[usize; 3]]) -> Surroundings {
        let count = places.len();
        let mut found = Surroundings {
            towards: vec![[0.0; 2]; count],
            opening: vec![[0.0; 2]; count],
            nearest: vec![f64::INFINITY; count],
        };
        for triangle in triangles {
            for at in 0..3 {
                let [a, b, c] = [0, 1, 2].map(|next| triangle[(at + next) % 3]);
                for other in [b, c] {
                    found.see(places, a, other);
                }
                // Two copies: the third corner is to the left of the way from the first to the second.
                if is_same(places, a, b) && !is_same(places, a, c) {
                    let [x, y] = direction(places, a, c);
                    add(&mut found.opening[b], [y, -x]);
                    add(&mut found.opening[a], [-y, x]);
                }
            }
        }
        found
    }

    fn see(&mut self, places: &[Point], knot: usize, other: usize) {
        if is_same(places, knot, other) {
            return;
        }
        let [dx, dy] = [0, 1].map(|axis| places[other][axis] - places[knot][axis]);
        self.nearest[knot] = self.nearest[knot].min(dx.hypot(dy));
        let towards = direction(places, knot, other);
        add(&mut self.towards[knot], towards);
    }

    /// A unit vector for each of the copies of a knot, all different.
    fn directions(&self, copies: &[usize]) -> Vec<(usize, [f64; 2])> {
        if let &[a, b] = copies {
            let between = |of: &[[f64; 2]]| [0, 1].map(|axis| of[b][axis] - of[a][axis]);
            let ways = [between(&self.opening), between(&self.towards), [1.0, 0.0]];
            let way = ways.into_iter().find(|[x, y]| x.hypot(*y) > 1e-9).unwrap_or([1.0, 0.0]);
            let [x, y] = way.map(|part| part / way[0].hypot(way[1]));
            return vec![(a, [-x, -y]), (b, [x, y])];
        }
        let angle = |copy: usize| self.towards[copy][1].atan2(self.towards[copy][0]);
        let mut ordered = copies.to_vec();
        ordered.sort_by(|&a, &b| angle(a).total_cmp(&angle(b)));
        let first = angle(ordered[0]);
        let step = TAU / ordered.len() as f64;
        let turned = |number: usize| (first + step * number as f64).sin_cos();
        ordered
            .into_iter()
            .enumerate()
            .map(|(number, copy)| (copy, [turned(number).1, turned(number).0]))
            .collect()
    }
}

fn is_same(places: &[Point], a: usize, b: usize) -> bool {
    places[a][..2] == places[b][..2]
}

fn add(sum: &mut [f64; 2], term: [f64; 2]) {
    sum.iter_mut().zip(term).for_each(|(sum, term)| *sum += term);
}

/// The unit vector from a knot to another one elsewhere.
fn direction(places: &[Point], from: usize, to: usize) -> [f64; 2] {
    let [x, y] = [0, 1].map(|axis| places[to][axis] - places[from][axis]);
    [x, y].map(|part| part / x.hypot(y))
}

/// About the distance of knots from each other, where no triangle tells it.
fn spacing(places: &[Point]) -> f64 {
    let range = |axis: usize| {
        let [low, high] = places.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], place| {
            [low.min(place[axis]), high.max(place[axis])]
        });
        high - low
    };
    let size = range(0).max(range(1)) / (places.len() as f64).sqrt();
    if size > 0.0 { size } else { 1.0 }
}
