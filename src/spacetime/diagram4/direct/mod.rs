//! The way of the thesis (3.6.4): cells of any number of vertices, made as points come.
//!
//! Each cell has its vertices, its neighbours, and the tuple of its sphere in integers. A new point is inside
//! of the sphere of red cells, on that of green ones, outside of those of blue ones. Red cells vanish; green
//! cells get the point as a vertex; each facet between a red and a blue cell makes a cell with the point,
//! whose sphere is a combination of the two (eq. 3.1), divided by what its components have in common.
//! Euclid's algorithm finds that divisor: theorem 3.6.1 gives it only where nothing is cospherical.
//!
//! A check of the other way, with which it shares little: no perturbation, no simplices, no rounded numbers.

use std::time::Instant;

use super::Stats;
use super::canonical::canonical;
use super::exact::Exactness;
use super::simplices::insertions;
use super::sites::Sites;
use crate::diagram4::determinant::{Number, difference, dot, lift, normal, sphere};
use foldhash::{HashMap, HashSet};
use num_traits::Signed;
use spmesh_base::error::Result;
use spmesh_delaunay::predicates::Extent;
use spmesh_delaunay::predicates::exact_integers::integers_of;
use spmesh_stream::model::cells4::{Cell4, Cells4, Point4};

/// The faraway point.
const INFINITE: u32 = u32::MAX;

/// Greatest difference of integer coordinates with which all combinations fit into 128 bits.
///
/// Values are at most 60 E^6, components of tuples at most 260 E^6, so combinations are at most 2 * 60 * 260
/// E^12, which is below 2^127 for E up to 670. Steps of the walk are shorter.
const INT128_MAX: f64 = 670.0;

/// The diagram of sites.
pub(super) fn cells(sites: &Sites, stats: &mut Stats) -> Result<Cells4> {
    let started = Instant::now();
    let order = insertions(sites)?;
    stats.order += started.elapsed();
    let started = Instant::now();
    let cells =
        if sites.exactness != Exactness::Big && Extent::of(&sites.points).max_difference() <= INT128_MAX {
            build(integers(sites), &order, stats)
        } else {
            build(integers_of(&sites.points), &order, stats)
        };
    stats.insertion = started.elapsed();
    Ok(cells)
}

/// The points as integers about the centre of their box; they are integers of that width.
fn integers(sites: &Sites) -> Vec<[i128; 4]> {
    let centre = sites.centre.map(|x| (x / sites.unit) as i128);
    let from = |point: &Point4| std::array::from_fn(|axis| point[axis] as i128 - centre[axis]);
    sites.points.iter().map(from).collect()
}

fn build<T: Integer>(points: Vec<[T; 4]>, order: &[u32], stats: &mut Stats) -> Cells4 {
    let mut diagram = Direct { points, cells: Vec::new(), free: Vec::new() };
    diagram.insert_first(std::array::from_fn(|place| order[place]));
    let mut start = 0;
    for &q in &order[5..] {
        start = diagram.insert(q, start, stats);
    }
    canonical(&diagram.all())
}

/// A cell; one without vertices is none.
#[derive(Debug, Clone)]
struct Cell<T> {
    /// Numbers of sites, increasing; [`INFINITE`] is the last of an infinite cell.
    vertices: Vec<u32>,
    neighbours: Vec<u32>,
    sphere: Tuple<T>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Colour {
    Red,
    Green,
    Blue,
}

/// What is known of a cell, as seen from a new point.
struct Seen<T> {
    cell: u32,
    colour: Colour,
    value: T,
}

/// The diagram of the points so far.
struct Direct<T> {
    /// By number of their site.
    points: Vec<[T; 4]>,
    cells: Vec<Cell<T>>,
    /// Cells that are none.
    free: Vec<u32>,
}

impl<T: Integer> Direct<T> {
    /// The simplex of five points that span space, and the cells around it.
    fn insert_first(&mut self, simplex: [u32; 5]) {
        let at = |number: u32| &self.points[number as usize];
        let mut cells = vec![(simplex.to_vec(), Tuple::sphere(simplex.map(at)))];
        for side in 0..5 {
            let facet: [u32; 4] = std::array::from_fn(|i| simplex[i + usize::from(i >= side)]);
            let hyperplane = Tuple::hyperplane(facet.map(at), at(simplex[side]));
            cells.push(([&facet[..], &[INFINITE]].concat(), hyperplane));
        }
        for (number, (mut vertices, sphere)) in (0u32..).zip(cells) {
            vertices.sort_unstable();
            let neighbours = (0..6).filter(|&other| other != number).collect();
            self.cells.push(Cell { vertices, neighbours, sphere });
        }
    }

    /// Inserts a site; says where to start for one nearby.
    fn insert(&mut self, q: u32, start: u32, stats: &mut Stats) -> u32 {
        let found = self.locate(q, start);
        let (red, others) = self.search(q, found);
        stats.in_sphere_tests += (red.len() + others.len()) as u64;
        let places: HashMap<u32, usize> = others.iter().map(|seen| seen.cell).zip(0..).collect();
        let mut facets = Vec::new();
        for seen in &red {
            for number in self.cell(seen.cell).neighbours.clone() {
                if let Some(&place) = places.get(&number) {
                    facets.push(self.facet(q, seen, &others[place]));
                    stats.created += u64::from(others[place].colour == Colour::Blue);
                }
            }
        }
        self.connect(&facets, &red);
        for green in others.iter().filter(|seen| seen.colour == Colour::Green) {
            let vertices = &mut self.cells[green.cell as usize].vertices;
            let place = vertices.partition_point(|&vertex| vertex < q);
            vertices.insert(place, q);
        }
        facets[0].cell
    }

    fn cell(&self, number: u32) -> &Cell<T> {
        &self.cells[number as usize]
    }

    /// Walks to a red cell: across a facet with the point on its other side (eq. 3.2).
    fn locate(&self, q: u32, start: u32) -> u32 {
        let point = &self.points[q as usize];
        // A point in the hyperplane of an infinite cell would not be on either side.
        let mut at = if self.cell(start).sphere.m.is_zero() { self.inside(start) } else { start };
        let mut value = self.cell(at).sphere.value(point);
        while !value.is_negative() {
            let m = &self.cell(at).sphere.m;
            let next = self.cell(at).neighbours.iter().find_map(|&next| {
                let sphere = &self.cell(next).sphere;
                let there = sphere.value(point);
                let side = m.clone() * there.clone() - sphere.m.clone() * value.clone();
                side.is_negative().then_some((next, there))
            });
            (at, value) = next.expect("a point is in a cell, or beyond a facet of it");
        }
        at
    }

    /// All red cells, and the green and blue ones around them.
    fn search(&self, q: u32, found: u32) -> (Vec<Seen<T>>, Vec<Seen<T>>) {
        let mut known = HashSet::default();
        known.insert(found);
        let (mut red, mut others) = (vec![self.see(q, found)], Vec::new());
        let mut next = 0;
        while next < red.len() {
            for &cell in &self.cell(red[next].cell).neighbours {
                if known.insert(cell) {
                    let seen = self.see(q, cell);
                    if seen.colour == Colour::Red { red.push(seen) } else { others.push(seen) }
                }
            }
            next += 1;
        }
        (red, others)
    }

    /// The colour of a cell. On the hyperplane of an infinite cell, the finite neighbour decides (thesis
    /// 4.4).
    fn see(&self, q: u32, cell: u32) -> Seen<T> {
        let value = self.cell(cell).sphere.value(&self.points[q as usize]);
        let colour = if value.is_negative() {
            Colour::Red
        } else if value.is_positive() {
            Colour::Blue
        } else if self.cell(cell).sphere.m.is_zero() {
            self.see(q, self.inside(cell)).colour
        } else {
            Colour::Green
        };
        Seen { cell, colour, value }
    }

    /// The finite neighbour of an infinite cell.
    fn inside(&self, cell: u32) -> u32 {
        let is_finite = |&&other: &&u32| !self.cell(other).sphere.m.is_zero();
        *self.cell(cell).neighbours.iter().find(is_finite).expect("an infinite cell has a finite neighbour")
    }

    /// The facet between a red cell and another one, and the cell of it and the new point.
    fn facet(&mut self, q: u32, red: &Seen<T>, other: &Seen<T>) -> Facet {
        let vertices = in_common(&self.cell(red.cell).vertices, &self.cell(other.cell).vertices);
        let cell = if other.colour == Colour::Green {
            other.cell
        } else {
            let (inner, outer) = (&self.cell(red.cell).sphere, &self.cell(other.cell).sphere);
            let is_in_one_hyperplane = red.value.is_zero() && other.value.is_zero();
            let sphere = if is_in_one_hyperplane {
                outer.clone()
            } else {
                outer.combined(&(T::zero() - red.value.clone()), inner, &other.value)
            };
            let mut vertices = vertices.clone();
            vertices.push(q);
            vertices.sort_unstable();
            self.add(Cell { vertices, neighbours: vec![other.cell], sphere })
        };
        // What was across the facet is not there any more.
        let neighbours = &mut self.cells[other.cell as usize].neighbours;
        neighbours.retain(|&number| number != red.cell);
        if cell != other.cell {
            neighbours.push(cell);
        }
        Facet { red: red.cell, vertices, cell }
    }

    fn add(&mut self, cell: Cell<T>) -> u32 {
        match self.free.pop() {
            Some(number) => {
                self.cells[number as usize] = cell;
                number
            }
            None => {
                self.cells.push(cell);
                self.cells.len() as u32 - 1
            }
        }
    }

    /// Makes neighbours of cells that have a ridge of the horizon in common, and takes the red ones away.
    fn connect(&mut self, facets: &[Facet], red: &[Seen<T>]) {
        let cells = &self.cells;
        let around = |number: u32| {
            cells[number as usize].neighbours.iter().map(|&other| &cells[other as usize].vertices[..])
        };
        for [a, b] in neighbours(facets, around) {
            if !self.cell(a).neighbours.contains(&b) {
                self.cells[a as usize].neighbours.push(b);
                self.cells[b as usize].neighbours.push(a);
            }
        }
        for seen in red {
            self.cells[seen.cell as usize].vertices.clear();
            self.free.push(seen.cell);
        }
    }

    /// All cells, in any order.
    fn all(&self) -> Cells4 {
        let mut places = vec![0; self.cells.len()];
        let live = || self.cells.iter().enumerate().filter(|(_, cell)| !cell.vertices.is_empty());
        live().zip(0..).for_each(|((number, _), place)| places[number] = place);
        let mut cells = Cells4::default();
        for (_, cell) in live() {
            let is_infinite = cell.vertices.last() == Some(&INFINITE);
            let vertices = &cell.vertices[..cell.vertices.len() - usize::from(is_infinite)];
            let neighbours: Vec<u32> = cell.neighbours.iter().map(|&other| places[other as usize]).collect();
            cells.push(Cell4 { is_infinite, vertices, neighbours: &neighbours });
        }
        cells
    }
}

/// A facet between a red cell and a green or blue one.
#[derive(Debug)]
pub(super) struct Facet {
    pub(super) red: u32,
    /// Its vertices, increasing.
    pub(super) vertices: Vec<u32>,
    /// The cell that holds it when the point is inserted.
    pub(super) cell: u32,
}

/// Least number of vertices of a ridge: three or more points of a face, being cospherical, span two
/// dimensions (thesis, lemma 3.6.2). The faraway point is one like others here.
const RIDGE_MIN: usize = 3;

/// Numbers that two increasing lists have in common.
pub(super) fn in_common(a: &[u32], b: &[u32]) -> Vec<u32> {
    a.iter().copied().filter(|number| b.binary_search(number).is_ok()).collect()
}

/// Pairs of cells on both sides of a ridge of the horizon.
///
/// `around` gives the vertices of the neighbours of a red cell.
pub(super) fn neighbours<'a, I: Iterator<Item = &'a [u32]>>(
    facets: &[Facet],
    around: impl Fn(u32) -> I,
) -> Vec<[u32; 2]> {
    let mut open: HashMap<Vec<u32>, u32> = HashMap::default();
    let mut pairs = Vec::new();
    for facet in facets {
        for vertices in around(facet.red) {
            let ridge = in_common(&facet.vertices, vertices);
            // The neighbour across the facet itself has all of it.
            if ridge.len() < RIDGE_MIN || ridge.len() == facet.vertices.len() {
                continue;
            }
            match open.remove(&ridge) {
                None => {
                    open.insert(ridge, facet.cell);
                }
                Some(other) if other != facet.cell => pairs.push([other, facet.cell]),
                Some(_) => {}
            }
        }
    }
    debug_assert!(open.is_empty(), "each ridge of the horizon is between two facets");
    pairs
}

/// Integers that are wide enough.
pub(super) trait Integer: Number + num_integer::Integer + Signed {}

impl<T: Number + num_integer::Integer + Signed> Integer for T {}

/// The integers (n, m, s): the value of a point x is n . x + m |x|^2 + s, negative inside of a sphere, or
/// beyond a hyperplane of the hull, whose m is 0. They have no divisor in common.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tuple<T> {
    n: [T; 4],
    pub(super) m: T,
    s: T,
}

impl<T: Integer> Tuple<T> {
    /// The sphere through five points that span space.
    pub(super) fn sphere([o, a, b, c, d]: [&[T; 4]; 5]) -> Tuple<T> {
        let (n, m) = sphere([a, b, c, d].map(|p| difference(p.clone(), o)));
        let two = T::one() + T::one();
        let shifted = std::array::from_fn(|axis| n[axis].clone() - two.clone() * m.clone() * o[axis].clone());
        let s = m.clone() * lift(o) - dot(&n, o);
        let is_negative = m.is_negative();
        Tuple { n: shifted, m, s }.with_sign(is_negative).reduced()
    }

    /// The hyperplane through four points, with a fifth on the side that is not beyond.
    pub(super) fn hyperplane([o, a, b, c]: [&[T; 4]; 4], inside: &[T; 4]) -> Tuple<T> {
        let n = normal([a, b, c].map(|p| difference(p.clone(), o)).each_ref());
        let s = T::zero() - dot(&n, o);
        let tuple = Tuple { n, m: T::zero(), s };
        let is_negative = tuple.value(inside).is_negative();
        tuple.with_sign(is_negative).reduced()
    }

    pub(super) fn value(&self, point: &[T; 4]) -> T {
        dot(&self.n, point) + self.m.clone() * lift(point) + self.s.clone()
    }

    /// `a * self + b * other`: one of their pencil (eq. 3.1).
    pub(super) fn combined(&self, a: &T, other: &Tuple<T>, b: &T) -> Tuple<T> {
        let of = |x: &T, y: &T| a.clone() * x.clone() + b.clone() * y.clone();
        let n = std::array::from_fn(|axis| of(&self.n[axis], &other.n[axis]));
        Tuple { n, m: of(&self.m, &other.m), s: of(&self.s, &other.s) }.reduced()
    }

    fn with_sign(self, is_negative: bool) -> Tuple<T> {
        let turn = |x: T| if is_negative { T::zero() - x } else { x };
        Tuple { n: self.n.map(turn), m: turn(self.m), s: turn(self.s) }
    }

    /// Divided by the greatest common divisor.
    fn reduced(self) -> Tuple<T> {
        let divisor = self.n.iter().fold(self.m.gcd(&self.s), |divisor, x| divisor.gcd(x));
        let over = |x: T| if divisor.is_one() { x } else { x / divisor.clone() };
        Tuple { n: self.n.map(over), m: over(self.m), s: over(self.s) }
    }
}
