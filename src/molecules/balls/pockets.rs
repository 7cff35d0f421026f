//! Pockets and voids of a union of balls.
//!
//! The tetrahedra of the power diagram's dual whose orthocentre no ball covers are *empty*. From an empty
//! tetrahedron the discrete flow leads across each facet that separates it from its orthocentre. What flows
//! to the outside is outside; the other empty tetrahedra, joined across facets that the balls leave open, are
//! the pockets. Open facets between a pocket and the outside are its mouths; a pocket without a mouth is a
//! void.
//!
//! Volume and area are those of the part that no ball covers, by short inclusion and exclusion over the
//! corners, edges and facets of the tetrahedra: exact for voids. Balls that reach through a mouth from inside
//! are counted whole, so that pockets have that much less.
//!
//! Source: Edelsbrunner, Facello and Liang, "On the definition and the construction of pockets in
//! macromolecules", 1998, as in the server CASTp.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;

use super::Balls;
use super::dual::Dual;
use super::shares::{
    Measure, angle, ball, dihedral, length, lens, lens_of_disks, solid_angle, triple, volume,
};
use super::tile::{Tile, with_all};
use spmesh_base::error::Result;
use spmesh_delaunay::delaunay3::{EDGES, Tetrahedron};
use spmesh_delaunay::predicates::Point3;
use spmesh_delaunay::simplex::TETRAHEDRON_FACETS;
use spmesh_delaunay::vector::{cross, difference};

/// A pocket, or a void if it has no mouth.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Pocket {
    /// Volume that no ball covers.
    pub volume: f64,
    /// Area of the spheres around it.
    pub area: f64,
    /// The mouths, the largest first.
    pub mouths: Vec<Mouth>,
    /// Greatest distance of the centre of a ball around the pocket from the nearest centre at a mouth; 0 if
    /// there is no mouth.
    pub depth: f64,
    /// Its tetrahedra, by the balls at their corners, positively oriented.
    pub tetrahedra: Vec<[u32; 4]>,
    /// The balls around it, in increasing order.
    pub balls: Vec<u32>,
}

/// An opening of a pocket to the outside.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mouth {
    /// Area of its facets that no ball covers.
    pub area: f64,
    /// The balls at its facets, in increasing order.
    pub balls: Vec<u32>,
}

impl Pocket {
    /// Area of all mouths that no ball covers.
    pub fn mouth_area(&self) -> f64 {
        // The sum of none would be -0.
        self.mouths.iter().map(|mouth| mouth.area).fold(0.0, std::ops::Add::add)
    }
}

/// The pockets and voids of a union of balls, the largest volume first.
///
/// # Errors
/// As [`super::measure`].
///
/// Cost: that of the triangulation of all balls, on one thread. Memory: about 500 bytes per ball.
pub fn pockets(balls: Balls<'_>) -> Result<Vec<Pocket>> {
    super::check(balls)?;
    with_all(balls, |tile| Ok(with_members(tile).into_iter().map(|(pocket, _)| pocket).collect()))
}

/// Spheres: the centre of each, and its radius.
pub type Spheres = Vec<(Point3, f64)>;

/// For each pocket, in the order of [`pockets`], whether it is a void, and of each of its tetrahedra the
/// sphere around the orthocentre that touches the nearest ball.
///
/// # Errors
/// As [`pockets`].
pub fn pocket_spheres(balls: Balls<'_>) -> Result<Vec<(bool, Spheres)>> {
    super::check(balls)?;
    with_all(balls, |tile| {
        let sphere = |t: usize| {
            let centre = tile.centre(t);
            let gap = |&v: &u32| length(difference(centre, tile.point(v))) - tile.radius(v);
            let radius = tile.tetrahedra()[t].vertices.iter().map(gap).fold(f64::INFINITY, f64::min);
            (centre, radius.max(0.0))
        };
        let pockets = with_members(tile).into_iter();
        Ok(pockets
            .map(|(pocket, members)| (pocket.mouths.is_empty(), members.into_iter().map(sphere).collect()))
            .collect())
    })
}

/// The pockets, the largest volume first, each with the numbers of its tetrahedra.
pub(super) fn with_members(tile: &Tile<'_>) -> Vec<(Pocket, Vec<usize>)> {
    let mut pockets = Search::new(tile).pockets();
    pockets.sort_by(|(p, _), (q, _)| q.volume.total_cmp(&p.volume).then_with(|| p.balls.cmp(&q.balls)));
    pockets
}

/// What is known of a tetrahedron.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    /// The balls cover its orthocentre.
    Covered,
    /// Empty, and part of the outside or draining to it.
    Outside,
    /// Empty, and not known to drain.
    Empty,
}

struct Search<'t> {
    tile: &'t Tile<'t>,
    dual: Dual<'t>,
    states: Vec<State>,
}

impl<'t> Search<'t> {
    fn new(tile: &'t Tile<'t>) -> Self {
        let dual = Dual::new(tile);
        let state = |(t, tetrahedron): (usize, &Tetrahedron)| {
            let is_outer = tetrahedron.vertices.iter().any(|&v| tile.ball(v).is_none());
            match (is_outer, dual.is_empty(t)) {
                (true, _) => State::Outside,
                (_, true) => State::Empty,
                _ => State::Covered,
            }
        };
        let states = tile.tetrahedra().iter().enumerate().map(state).collect();
        let mut search = Search { tile, dual, states };
        search.drain();
        search
    }

    /// Marks all empty tetrahedra from which the flow leads outside.
    fn drain(&mut self) {
        let is_outside = |&t: &usize| self.states[t] == State::Outside;
        let mut open: Vec<usize> = (0..self.states.len()).filter(is_outside).collect();
        while let Some(t) = open.pop() {
            for side in 0..4 {
                let Some((other, across)) = self.dual.across(t, side) else { continue };
                if self.states[other] == State::Empty && self.dual.flows(other, across) {
                    self.states[other] = State::Outside;
                    open.push(other);
                }
            }
        }
    }

    fn pockets(&self) -> Vec<(Pocket, Vec<usize>)> {
        let edges = self.closed_edges();
        let mut is_seen = vec![false; self.states.len()];
        let mut pockets = Vec::new();
        for start in 0..self.states.len() {
            if self.states[start] == State::Empty && !is_seen[start] {
                let members = self.component(start, &mut is_seen);
                pockets.push((self.pocket(&members, &edges), members));
            }
        }
        pockets
    }

    /// The tetrahedra that are joined to `start` across open facets.
    fn component(&self, start: usize, is_seen: &mut [bool]) -> Vec<usize> {
        let mut members = vec![start];
        is_seen[start] = true;
        let mut next = 0;
        while next < members.len() {
            let t = members[next];
            next += 1;
            for corner in 0..4 {
                let Some((other, _)) = self.dual.across(t, corner) else { continue };
                if self.states[other] == State::Empty && !is_seen[other] && !self.dual.is_closed(t, corner) {
                    is_seen[other] = true;
                    members.push(other);
                }
            }
        }
        members
    }

    /// Edges of empty tetrahedra whose cells share a face in the union.
    fn closed_edges(&self) -> BTreeSet<[u32; 2]> {
        let mut wanted = BTreeSet::new();
        for (t, tetrahedron) in self.tile.tetrahedra().iter().enumerate() {
            if self.states[t] == State::Empty {
                wanted.extend(EDGES.map(|(ends, _)| sorted(ends.map(|i| tetrahedron.vertices[i]))));
            }
        }
        let mut closed = BTreeSet::new();
        self.tile.for_each_face(
            |ends| wanted.contains(&sorted(ends)),
            |ends| {
                closed.insert(sorted(ends));
            },
        );
        closed
    }

    fn pocket(&self, members: &[usize], edges: &BTreeSet<[u32; 2]>) -> Pocket {
        let mut free = Measure::default();
        let mut balls = BTreeSet::new();
        let mut facets: Vec<[u32; 3]> = Vec::new();
        for &t in members {
            let vertices = self.tile.tetrahedra()[t].vertices;
            balls.extend(vertices.iter().filter_map(|&v| self.tile.ball(v)));
            free.add(1.0, self.free_part(t, edges));
            for (corner, facet) in TETRAHEDRON_FACETS.into_iter().enumerate() {
                let other = self.dual.across(t, corner);
                let is_outside = other.is_none_or(|(other, _)| self.states[other] == State::Outside);
                if is_outside && !self.dual.is_closed(t, corner) {
                    facets.push(facet.map(|i| vertices[i]));
                }
            }
        }
        Pocket {
            volume: free.volume.max(0.0),
            area: free.area.max(0.0),
            depth: self.depth(members, &facets),
            mouths: self.mouths(&facets, edges),
            tetrahedra: members.iter().map(|&t| self.balls_of(self.tile.tetrahedra()[t].vertices)).collect(),
            balls: balls.into_iter().collect(),
        }
    }

    /// The balls of vertices of a pocket, none of which is an outpost.
    fn balls_of<const N: usize>(&self, vertices: [u32; N]) -> [u32; N] {
        vertices.map(|v| self.tile.ball(v).unwrap_or_default())
    }

    /// Groups of facets that are joined at edges that the balls leave open, the largest first.
    fn mouths(&self, facets: &[[u32; 3]], edges: &BTreeSet<[u32; 2]>) -> Vec<Mouth> {
        let mut groups: BTreeMap<usize, (f64, BTreeSet<u32>)> = BTreeMap::new();
        for (&facet, group) in facets.iter().zip(joined(facets, edges)) {
            let (area, balls) = groups.entry(group).or_default();
            *area += self.open_area(facet, edges);
            balls.extend(self.balls_of(facet));
        }
        let mouth = |(area, balls): (f64, BTreeSet<u32>)| Mouth {
            area: area.max(0.0),
            balls: balls.into_iter().collect(),
        };
        let mut mouths: Vec<Mouth> = groups.into_values().map(mouth).collect();
        mouths.sort_by(|p, q| q.area.total_cmp(&p.area).then_with(|| p.balls.cmp(&q.balls)));
        mouths
    }

    /// The part of a tetrahedron that no ball covers.
    fn free_part(&self, t: usize, edges: &BTreeSet<[u32; 2]>) -> Measure {
        let vertices = self.tile.tetrahedra()[t].vertices;
        let points = vertices.map(|v| self.tile.point(v));
        let radii = vertices.map(|v| self.tile.radius(v));
        // The area of spheres is that of what is subtracted, with the opposite sign.
        let mut rest = Measure { area: 0.0, volume: volume(points) };
        for (corner, others) in TETRAHEDRON_FACETS.into_iter().enumerate() {
            let share = solid_angle(points[corner], others.map(|i| points[i])) / (4.0 * PI);
            rest.add(-share, ball(radii[corner]));
            if self.dual.is_closed(t, corner) {
                rest.add(-0.5, triple(others.map(|i| points[i]), others.map(|i| radii[i])));
            }
        }
        for (ends, others) in EDGES {
            if edges.contains(&sorted(ends.map(|i| vertices[i]))) {
                let ends_at = ends.map(|i| points[i]);
                let share = dihedral(ends_at, others.map(|i| points[i])) / (2.0 * PI);
                rest.add(share, lens(ends_at, ends.map(|i| radii[i])));
            }
        }
        Measure { area: -rest.area, ..rest }
    }

    /// The part of a mouth's facet that no ball of its corners covers.
    fn open_area(&self, facet: [u32; 3], edges: &BTreeSet<[u32; 2]>) -> f64 {
        let points = facet.map(|v| self.tile.point(v));
        let radii = facet.map(|v| self.tile.radius(v));
        let normal = cross(difference(points[1], points[0]), difference(points[2], points[0]));
        let mut area = 0.5 * length(normal);
        for i in 0..3 {
            let [j, k] = [(i + 1) % 3, (i + 2) % 3];
            area -= 0.5 * radii[i] * radii[i] * angle(points[i], [points[j], points[k]]);
            if edges.contains(&sorted([facet[i], facet[j]])) {
                area += 0.5 * lens_of_disks([points[i], points[j]], [radii[i], radii[j]]);
            }
        }
        area
    }

    fn depth(&self, members: &[usize], mouths: &[[u32; 3]]) -> f64 {
        let places = |vertices: BTreeSet<u32>| vertices.into_iter().map(|v| self.tile.point(v));
        let rim = Nearest::new(places(mouths.iter().flatten().copied().collect()).collect());
        let lining = members.iter().flat_map(|&t| self.tile.tetrahedra()[t].vertices).collect();
        places(lining).filter_map(|at| rim.distance(at)).fold(0.0, f64::max)
    }
}

/// For each facet the group of those that are joined at edges that the balls leave open.
fn joined(facets: &[[u32; 3]], closed: &BTreeSet<[u32; 2]>) -> Vec<usize> {
    let mut at_edges: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
    for (number, facet) in facets.iter().enumerate() {
        for i in 0..3 {
            let edge = sorted([facet[i], facet[(i + 1) % 3]]);
            if !closed.contains(&edge) {
                at_edges.entry(edge).or_default().push(number);
            }
        }
    }
    let mut group: Vec<usize> = (0..facets.len()).collect();
    for joined in at_edges.values() {
        for pair in joined.windows(2) {
            let [p, q] = [root(&mut group, pair[0]), root(&mut group, pair[1])];
            group[p] = q;
        }
    }
    (0..facets.len()).map(|facet| root(&mut group, facet)).collect()
}

fn sorted([p, q]: [u32; 2]) -> [u32; 2] {
    [p.min(q), p.max(q)]
}

/// The root of a tree of groups; halves the way.
pub(super) fn root(group: &mut [usize], mut at: usize) -> usize {
    while group[at] != at {
        group[at] = group[group[at]];
        at = group[at];
    }
    at
}

/// Points as a k-d tree without pointers: the middle point of a slice divides the others, at each level along
/// the next axis.
///
/// Source: Bentley, "Multidimensional binary search trees used for associative searching", 1975.
pub(super) struct Nearest(Vec<Point3>);

impl Nearest {
    /// Cost: O(n log n).
    pub(super) fn new(mut points: Vec<Point3>) -> Nearest {
        arrange(&mut points, 0);
        Nearest(points)
    }

    /// Distance of the nearest point; `None` if there are no points.
    pub(super) fn distance(&self, from: Point3) -> Option<f64> {
        let mut best = f64::INFINITY;
        search(&self.0, 0, from, &mut best);
        (!self.0.is_empty()).then_some(best)
    }
}

fn arrange(points: &mut [Point3], axis: usize) {
    if points.len() < 2 {
        return;
    }
    let middle = points.len() / 2;
    points.select_nth_unstable_by(middle, |p, q| p[axis].total_cmp(&q[axis]));
    let (lower, upper) = points.split_at_mut(middle);
    arrange(lower, (axis + 1) % 3);
    arrange(&mut upper[1..], (axis + 1) % 3);
}

fn search(points: &[Point3], axis: usize, from: Point3, best: &mut f64) {
    if points.is_empty() {
        return;
    }
    let (lower, upper) = points.split_at(points.len() / 2);
    *best = best.min(length(difference(upper[0], from)));
    let beyond = from[axis] - upper[0][axis];
    let (near, far) = if beyond < 0.0 { (lower, &upper[1..]) } else { (&upper[1..], lower) };
    search(near, (axis + 1) % 3, from, best);
    if beyond.abs() < *best {
        search(far, (axis + 1) % 3, from, best);
    }
}
