//! The way of the thesis (3.6.4): cells of any number of vertices, made as points come.
//!
//! Each cell has its vertices, its neighbours, and the tuple of its sphere in integers. A new point is inside
//! of the sphere of red cells, on that of green ones, outside of those of blue ones. Red cells vanish; green
//! cells get the point as a vertex; each facet between a red and a blue cell makes a cell with the point,
//! whose sphere is a combination of the two (eq. 3.1), divided by what its components have in common.
//! Euclid's algorithm finds that divisor: theorem 3.6.1 gives it only where nothing is cospherical.
//!
//! A check of the other way, with which it shares little: no perturbation, no simplices, no rounded numbers.

mod horizon;
mod tuple;

use super::Stats;
use super::canonical::canonical;
use super::exact::Exactness;
use super::simplices::insertions;
use super::sites::Sites;
use foldhash::{HashMap, HashSet};
use horizon::{Facet, in_common};
use spmesh_base::error::Result;
use spmesh_delaunay::predicates::Extent;
use spmesh_delaunay::predicates::exact_integers::integers_of;
use spmesh_stream::model::cells4::{Cell4, Cells4, Point4};
use std::time::Instant;
use tuple::{Integer, Tuple};

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
        for [a, b] in horizon::neighbours(facets, around) {
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
