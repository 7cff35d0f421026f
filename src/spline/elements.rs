//! From configurations to elements: simplex splines of one degree less, each with a linear factor for some functions.
//!
//! A B-spline of degree k is the sum of `area(x, f) M(x | J u f)` over the edges f of the link of its set J (thesis,
//! equation 8.1). A configuration (B, I) of degree k - 1 is in three links, with one edge in each, and its M is the same in
//! all of them. So it is evaluated once, as an *element*, and its three edges make the linear factors. Where knots are at
//! one place, edges of one element cancel, and elements of different knots are the same function: they are merged.

use super::area::area;
use crate::config::{Configurations, Knots};
use crate::delaunay2::distinct;
use crate::order::{Curve, SpatialOrder};
use crate::predicates::{Extent, Point2, Predicates2, Sign, TotalPredicates};
use foldhash::HashMap;

/// The share of a function in an element: `factor * area(x, a, b)`, for an edge ab.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Share {
    pub(super) function: u32,
    pub(super) edge: [u32; 2],
    pub(super) factor: f64,
}

/// Simplex splines with their shares, in the order of a curve through the plane: flat arrays.
#[derive(Debug, Clone)]
pub(super) struct Elements {
    /// Number of knots of each.
    pub(super) size: usize,
    knots: Vec<u32>,
    offsets: Vec<u32>,
    shares: Vec<Share>,
}

impl Elements {
    /// Elements of all finite configurations; `functions_of` tells which functions, with which factors, the set of a
    /// configuration, by its number, and of one of its corners belongs to. Those that are zero everywhere are left out.
    pub(super) fn of_configurations(
        knots: &Knots,
        configurations: &Configurations,
        mut functions_of: impl FnMut(u32, u32, &[u32]) -> Vec<(u32, f64)>,
    ) -> Elements {
        let size = configurations.degree() + 3;
        let mut gathered = Gathered::new(knots);
        for (number, (boundary, interior)) in (0..).zip(configurations.iter()) {
            let all: Vec<u32> = boundary.iter().chain(interior).copied().collect();
            if is_flat(knots, &all) {
                continue;
            }
            let mut shares = Vec::with_capacity(3);
            for corner in 0..3 {
                let edge = [boundary[(corner + 1) % 3], boundary[(corner + 2) % 3]];
                let functions = functions_of(number, boundary[corner], interior);
                let of_edge =
                    functions.into_iter().map(|(function, factor)| Share { function, edge, factor });
                shares.extend(of_edge);
            }
            gathered.add(all, shares);
        }
        gathered.sorted(knots, size)
    }

    pub(super) fn len(&self) -> usize {
        self.offsets.len() - 1
    }

    pub(super) fn knots(&self, element: usize) -> &[u32] {
        &self.knots[element * self.size..][..self.size]
    }

    /// The shares, those of one function next to each other, in order.
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

/// Elements while they are found.
struct Gathered<'a> {
    knots: &'a Knots,
    /// The first knots at all places.
    firsts: Vec<u32>,
    elements: Vec<(Vec<u32>, Vec<Share>)>,
    /// Elements by their places; empty if no knots are at one place.
    by_places: HashMap<Vec<u32>, usize>,
}

impl<'a> Gathered<'a> {
    fn new(knots: &'a Knots) -> Gathered<'a> {
        let firsts = if knots.has_copies() { distinct(knots.points()) } else { Vec::new() };
        Gathered { knots, firsts, elements: Vec::new(), by_places: HashMap::default() }
    }

    fn add(&mut self, knots: Vec<u32>, mut shares: Vec<Share>) {
        if !self.knots.has_copies() {
            self.elements.push((knots, shares));
            return;
        }
        let place = |id: u32| self.firsts[id as usize];
        shares.iter_mut().for_each(|share| share.edge = share.edge.map(place));
        let mut places: Vec<u32> = knots.into_iter().map(place).collect();
        places.sort_unstable();
        let next = self.elements.len();
        let at = *self.by_places.entry(places.clone()).or_insert(next);
        if at == next {
            self.elements.push((places, Vec::new()));
        }
        self.elements[at].1.append(&mut shares);
    }

    /// The elements that are left when opposite edges have cancelled, along a curve.
    fn sorted(mut self, knots: &Knots, size: usize) -> Elements {
        for (_, shares) in &mut self.elements {
            cancel(shares);
        }
        self.elements.retain(|(_, shares)| !shares.is_empty());
        let middle = |(all, _): &(Vec<u32>, Vec<Share>)| {
            let mean = |axis: usize| all.iter().map(|&id| knots.at(id)[axis] / size as f64).sum();
            [mean(0), mean(1)]
        };
        let middles: Vec<Point2> = self.elements.iter().map(middle).collect();
        let mut curve = SpatialOrder::default();
        let order = curve.sort(&middles, &Extent::of(&middles), Curve::Hilbert);
        let mut elements = Elements { size, knots: Vec::new(), offsets: vec![0], shares: Vec::new() };
        for at in order {
            let (all, shares) = &self.elements[at as usize];
            elements.knots.extend_from_slice(all);
            elements.shares.extend_from_slice(shares);
            elements.offsets.push(elements.shares.len() as u32);
        }
        elements
    }
}

/// Sorts shares by function and edge, sums those of one edge, and drops what is zero.
fn cancel(shares: &mut Vec<Share>) {
    for share in shares.iter_mut() {
        if share.edge[0] > share.edge[1] {
            share.edge.reverse();
            share.factor = -share.factor;
        }
    }
    shares.sort_unstable_by_key(|share| (share.function, share.edge));
    shares.dedup_by(|next, kept| {
        let is_same = next.function == kept.function && next.edge == kept.edge;
        if is_same {
            kept.factor += next.factor;
        }
        is_same
    });
    shares.retain(|share| share.factor != 0.0 && share.edge[0] != share.edge[1]);
}

/// Whether all knots are on one line.
fn is_flat(knots: &Knots, all: &[u32]) -> bool {
    let first = knots.at(all[0]);
    let Some(second) = all.iter().map(|&id| knots.at(id)).find(|&other| other != first) else { return true };
    let mut predicates = TotalPredicates::default();
    all.iter().all(|&id| predicates.orient2d(first, second, knots.at(id)) == Sign::Zero)
}

/// An edge of the convex hull of some knots, with the other knots.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct HullEdge {
    /// The ends, the hull on the left.
    pub(super) ends: [Point2; 2],
    /// All knots but one at either end.
    pub(super) others: Vec<Point2>,
}

/// The edges of the strict convex hull, from corner to corner. Domain: knots that are not all on one line.
pub(super) fn hull_edges(points: &[Point2]) -> Vec<HullEdge> {
    let mut predicates = TotalPredicates::default();
    let mut edges: Vec<HullEdge> = Vec::new();
    for (i, &p) in points.iter().enumerate() {
        for (j, &q) in points.iter().enumerate() {
            let mut is_outside = |r: Point2| match predicates.orient2d(p, q, r) {
                Sign::Negative => true,
                Sign::Zero => !is_between(p, q, r),
                Sign::Positive => false,
            };
            if p == q || points.iter().any(|&r| is_outside(r)) || edges.iter().any(|edge| edge.ends == [p, q])
            {
                continue;
            }
            let others = points.iter().enumerate().filter(|&(at, _)| at != i && at != j);
            edges.push(HullEdge { ends: [p, q], others: others.map(|(_, &point)| point).collect() });
        }
    }
    edges
}

/// Whether `r`, on the line through `p` and `q`, is between them, ends included.
fn is_between(p: Point2, q: Point2, r: Point2) -> bool {
    (0..2).all(|axis| p[axis].min(q[axis]) <= r[axis] && r[axis] <= p[axis].max(q[axis]))
}

/// The area of the convex hull.
pub(super) fn hull_area(edges: &[HullEdge]) -> f64 {
    let Some(first) = edges.first() else { return 0.0 };
    edges.iter().map(|edge| area(first.ends[0], edge.ends[0], edge.ends[1])).sum()
}
