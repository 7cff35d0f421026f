//! From configurations to elements: simplex splines of degree k - 1, each with a linear factor for some
//! functions of degree k.
//!
//! A B-spline of degree k is the sum of `area(x, f) M(x | J u f)` over the edges f of the link of its set J
//! (thesis, equation 8.1). A configuration (B, I) of degree k - 1 is in three links, with one edge in each,
//! and its M is the same in all of them. So it is evaluated once, as an *element*, and its three edges make
//! the linear factors. Where several knots are at one place, opposite edges of an element cancel, and
//! elements of different knots are the same function and are merged.

use foldhash::HashMap;
use spmesh_configurations::{Configurations, Knots};
use spmesh_delaunay::delaunay2::distinct;
use spmesh_delaunay::order::{Curve, SpatialOrder};
use spmesh_delaunay::predicates::{Extent, FiniteFloatPredicates, Point2, Predicates2, Sign, area};

/// The linear factor of a function in an element: `factor * area(x, a, b)`, for an edge ab.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Share {
    pub(super) function: u32,
    pub(super) edge: [u32; 2],
    pub(super) factor: f64,
}

/// Simplex splines with their shares in flat arrays, in the order of a space-filling curve.
#[derive(Debug, Clone)]
pub(super) struct Elements {
    /// Number of knots of each element.
    pub(super) size: usize,
    knots: Vec<u32>,
    offsets: Vec<u32>,
    shares: Vec<Share>,
}

impl Elements {
    /// Elements of all finite configurations, without those that are zero everywhere. `functions_of` gets the
    /// number of a configuration, a corner and the interior set. It passes on the functions, with their
    /// factors, that the set with the corner added belongs to.
    pub(super) fn of_configurations(
        knots: &Knots,
        configurations: &Configurations,
        mut functions_of: impl FnMut(u32, u32, &[u32], &mut dyn FnMut(u32, f64)),
    ) -> Elements {
        let size = configurations.degree() + 3;
        let mut gathered = Gathered::new(knots, size);
        let mut all = Vec::with_capacity(size);
        for (number, (boundary, interior)) in (0..).zip(configurations.iter()) {
            all.clear();
            all.extend(boundary.iter().chain(interior));
            if knots.are_collinear(&all) {
                continue;
            }
            let element = gathered.element(&mut all);
            for corner in 0..3 {
                let edge = [boundary[(corner + 1) % 3], boundary[(corner + 2) % 3]];
                functions_of(number, boundary[corner], interior, &mut |function, factor| {
                    gathered.add(element, Share { function, edge, factor });
                });
            }
        }
        gathered.sorted()
    }

    pub(super) fn len(&self) -> usize {
        self.offsets.len() - 1
    }

    pub(super) fn knots(&self, element: usize) -> &[u32] {
        &self.knots[element * self.size..][..self.size]
    }

    /// The shares of an element, in order of functions.
    pub(super) fn shares(&self, element: usize) -> &[Share] {
        &self.shares[self.offsets[element] as usize..self.offsets[element + 1] as usize]
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        4 * (self.knots.len() + self.offsets.len()) + std::mem::size_of_val(&self.shares[..])
    }

    /// Gives functions new numbers.
    pub(super) fn renumber(&mut self, numbers: &[u32]) {
        self.shares.iter_mut().for_each(|share| share.function = numbers[share.function as usize]);
    }
}

/// Elements while configurations are collected.
struct Gathered<'a> {
    knots: &'a Knots,
    size: usize,
    /// For each knot, the first knot at its place; empty if all places are distinct.
    firsts: Vec<u32>,
    /// Knots of elements, concatenated.
    all: Vec<u32>,
    /// Shares with their elements.
    shares: Vec<(u32, Share)>,
    /// Elements by the first knots at their places; used where several knots are at one place.
    by_places: HashMap<Vec<u32>, u32>,
}

impl<'a> Gathered<'a> {
    fn new(knots: &'a Knots, size: usize) -> Gathered<'a> {
        let firsts = if knots.has_copies() { distinct(knots.points()) } else { Vec::new() };
        Gathered { knots, size, firsts, all: Vec::new(), shares: Vec::new(), by_places: HashMap::default() }
    }

    /// The number of the element of these knots; with several knots at one place, of the element at these
    /// places.
    fn element(&mut self, knots: &mut [u32]) -> u32 {
        let next = (self.all.len() / self.size) as u32;
        if !self.firsts.is_empty() {
            knots.iter_mut().for_each(|id| *id = self.firsts[*id as usize]);
            knots.sort_unstable();
            match self.by_places.get(&*knots) {
                Some(&known) => return known,
                None => self.by_places.insert(knots.to_vec(), next),
            };
        }
        self.all.extend_from_slice(knots);
        next
    }

    fn add(&mut self, element: u32, share: Share) {
        let edge = share.edge.map(|id| self.firsts.get(id as usize).copied().unwrap_or(id));
        self.shares.push((element, Share { edge, ..share }));
    }

    /// The elements that have shares after opposite edges have cancelled, along a Hilbert curve.
    fn sorted(mut self) -> Elements {
        let Gathered { knots, size, .. } = self;
        cancel(&mut self.shares);
        let count = self.all.len() / size;
        let mut ranges = vec![0..0; count];
        let mut start = 0;
        for of_element in self.shares.chunk_by(|a, b| a.0 == b.0) {
            ranges[of_element[0].0 as usize] = start..start + of_element.len();
            start += of_element.len();
        }
        let middles: Vec<Point2> = self.all.chunks_exact(size).map(|all| middle(knots, all)).collect();
        let mut curve = SpatialOrder::default();
        let order = curve.sort(&middles, &Extent::of(&middles), Curve::Hilbert);
        let mut elements = Elements { size, knots: Vec::new(), offsets: vec![0], shares: Vec::new() };
        for at in order.map(|at| at as usize).filter(|&at| !ranges[at].is_empty()) {
            elements.knots.extend_from_slice(&self.all[at * size..][..size]);
            elements.shares.extend(self.shares[ranges[at].clone()].iter().map(|&(_, share)| share));
            elements.offsets.push(elements.shares.len() as u32);
        }
        elements
    }
}

fn middle(knots: &Knots, all: &[u32]) -> Point2 {
    [0, 1].map(|axis| all.iter().map(|&id| knots.at(id)[axis] / all.len() as f64).sum())
}

/// Sorts shares by element, function and edge, adds up shares of equal edges, and drops zeros.
fn cancel(shares: &mut Vec<(u32, Share)>) {
    for (_, share) in shares.iter_mut() {
        if share.edge[0] > share.edge[1] {
            share.edge.reverse();
            share.factor = -share.factor;
        }
    }
    let key = |(element, share): &(u32, Share)| (*element, share.function, share.edge);
    shares.sort_unstable_by_key(key);
    shares.dedup_by(|next, kept| {
        let is_same = key(next) == key(kept);
        if is_same {
            kept.1.factor += next.1.factor;
        }
        is_same
    });
    shares.retain(|(_, share)| share.factor != 0.0 && share.edge[0] != share.edge[1]);
}

/// The edges of the strict convex hull, from corner to corner, with the hull on their left. Domain: knots
/// that are not all on one line.
pub(super) fn hull_edges(points: &[Point2]) -> Vec<[Point2; 2]> {
    let mut predicates = FiniteFloatPredicates::default();
    let mut edges: Vec<[Point2; 2]> = Vec::with_capacity(points.len());
    for (&p, &q) in points.iter().flat_map(|p| points.iter().map(move |q| (p, q))) {
        let mut is_outside = |r: Point2| match predicates.orient2d(p, q, r) {
            Sign::Negative => true,
            Sign::Zero => !is_between(p, q, r),
            Sign::Positive => false,
        };
        if p != q && !points.iter().any(|&r| is_outside(r)) && !edges.contains(&[p, q]) {
            edges.push([p, q]);
        }
    }
    edges
}

/// Whether `r`, on the line through `p` and `q`, is between them, ends included.
fn is_between(p: Point2, q: Point2, r: Point2) -> bool {
    (0..2).all(|axis| p[axis].min(q[axis]) <= r[axis] && r[axis] <= p[axis].max(q[axis]))
}

/// The area of the convex hull.
pub(super) fn hull_area(edges: &[[Point2; 2]]) -> f64 {
    let Some(&[first, _]) = edges.first() else { return 0.0 };
    edges.iter().map(|&[p, q]| area(first, p, q)).sum()
}

/// The interior sets of functions, with their factors.
#[derive(Debug, Clone, Default)]
pub(super) struct FunctionSets {
    pub(super) size: usize,
    knots: Vec<u32>,
    factors: Vec<f64>,
    offsets: Vec<u32>,
}

impl FunctionSets {
    pub(super) fn new(size: usize) -> FunctionSets {
        FunctionSets { size, offsets: vec![0], ..FunctionSets::default() }
    }

    pub(super) fn len(&self) -> usize {
        self.offsets.len() - 1
    }

    pub(super) fn push<'a>(&mut self, terms: impl Iterator<Item = (&'a [u32], f64)>) {
        for (set, factor) in terms {
            self.knots.extend_from_slice(set);
            self.factors.push(factor);
        }
        self.offsets.push(self.factors.len() as u32);
    }

    pub(super) fn terms(&self, function: usize) -> impl Iterator<Item = (&[u32], f64)> {
        let range = self.offsets[function] as usize..self.offsets[function + 1] as usize;
        range.map(|at| (&self.knots[at * self.size..][..self.size], self.factors[at]))
    }

    pub(super) fn greville(&self, function: usize, points: &[Point2]) -> Point2 {
        let whole: f64 = self.terms(function).map(|(_, factor)| factor).sum();
        // If the factors sum to zero, a weighted mean is undefined: all sets weigh the same.
        let weight = |factor: f64| {
            if whole == 0.0 { 1.0 / self.terms(function).count() as f64 } else { factor / whole }
        };
        let mean = |set: &[u32], axis: usize| {
            set.iter().map(|&id| points[id as usize][axis]).sum::<f64>() / self.size as f64
        };
        [0, 1].map(|axis| self.terms(function).map(|(set, factor)| mean(set, axis) * weight(factor)).sum())
    }
}
