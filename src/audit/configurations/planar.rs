//! Checks that centroid triangulations are planar.
//!
//! The centroid triangulation of order k + 1 has the (k + 1)-sets as vertices, at their centroids. A
//! configuration (B, I) of degree k is the triangle of the sets I + b; a configuration of degree k - 1 is the
//! triangle of the sets I + B - b. Both are homothetic to B. An edge is a facet (F, J): it joins J with
//! either knot of F. So triangles are counterclockwise if boundaries are. If facets match
//! ([`super::check_facets`]), then every edge has a triangle on each side, except the edges of infinite
//! configurations of degree k. If these edges make one convex polygon that goes around once, the triangles
//! tile it, by the argument of [`crate`].

use std::cmp::Ordering;
use std::collections::HashMap;

use super::circles::{Disk, moved, turn};
use super::{Configurations, Knots};
use crate::exact::plane::Xy;
use num_bigint::BigInt;
use spmesh_base::error::{Error, ErrorKind, Result};

/// A directed edge of the border, from the set `interior` + `from` to `interior` + `to`.
#[derive(Debug)]
struct BorderEdge<'a> {
    interior: &'a [u32],
    from: u32,
    to: u32,
}

impl BorderEdge<'_> {
    fn set_with(&self, knot: u32) -> Vec<u32> {
        let mut set = [self.interior, &[knot]].concat();
        set.sort_unstable();
        set
    }
}

/// Checks that boundaries are counterclockwise, and that the centroid triangulation of order `k + 1` has a
/// convex polygon as its border; edges may be in line. If facets match and the boundaries of degree `k - 1`
/// are counterclockwise too, that triangulation is planar. Copies of a knot count as the limit that
/// [`Knots`] defines.
///
/// Cost: an orientation per configuration, big integers for each infinite one.
///
/// # Errors
/// The first violation (kind [`ErrorKind::Audit`]).
pub fn check_centroids(knots: &Knots, configurations: &Configurations) -> Result<()> {
    for (boundary, interior) in configurations.finite() {
        let what = format!("configuration {boundary:?}, {interior:?}");
        if boundary.iter().chain(interior).any(|&id| id as usize >= knots.len()) {
            return Err(Error::new(ErrorKind::Audit, "a knot is unknown").at(what));
        }
        if turn(knots, boundary) != Ordering::Greater {
            return Err(Error::new(ErrorKind::Audit, "the boundary is not counterclockwise").at(what));
        }
    }
    let edges = border(knots, configurations)?;
    check_convex(knots, &edges).map_err(|error| {
        error.at(format!("border of the centroid triangulation of order {}", configurations.degree() + 1))
    })
}

fn border<'a>(knots: &Knots, configurations: &'a Configurations) -> Result<Vec<BorderEdge<'a>>> {
    let mut edges = Vec::new();
    for ([from, to], interior) in configurations.infinite() {
        if [from, to].iter().chain(interior).any(|&id| id as usize >= knots.len()) {
            return Err(Error::new(ErrorKind::Audit, "a knot is unknown")
                .at(format!("infinite configuration {from}, {to}, {interior:?}")));
        }
        // The line has its set to the left and the centroids to the right.
        edges.push(BorderEdge { interior, from: to, to: from });
    }
    Ok(edges)
}

/// Checks that the edges are one polygon that turns left by less than half a turn at each vertex, and once
/// around in all.
fn check_convex(knots: &Knots, edges: &[BorderEdge]) -> Result<()> {
    let fail = |what: String| Err(Error::new(ErrorKind::Audit, what));
    let mut starts: HashMap<Vec<u32>, usize> = HashMap::new();
    for (number, edge) in edges.iter().enumerate() {
        if starts.insert(edge.set_with(edge.from), number).is_some() {
            return fail(format!("two edges start at {:?}", edge.set_with(edge.from)));
        }
    }
    let (mut at, mut steps, mut rounds) = (0, 0, 0);
    while steps == 0 || at != 0 {
        let Some(edge) = edges.get(at) else { return fail("there is none".into()) };
        let end = edge.set_with(edge.to);
        let Some(&next) = starts.get(&end) else { return fail(format!("it ends at {end:?}")) };
        let [cross, dot, height, next_height] = corner(knots, [edge, &edges[next]]);
        if cross == Ordering::Less || cross == Ordering::Equal && dot != Ordering::Greater {
            return fail(format!("it is not convex at {end:?}"));
        }
        rounds += usize::from(height == Ordering::Less && next_height == Ordering::Greater);
        (at, steps) = (next, steps + 1);
    }
    if steps != edges.len() {
        return fail(format!("only {steps} of {} edges are on one polygon", edges.len()));
    }
    if rounds != 1 {
        return fail(format!("it goes around {rounds} times"));
    }
    Ok(())
}

/// Signs of the cross product and the scalar product of two edges, and for each edge the half of all
/// directions that it is in.
fn corner(knots: &Knots, edges: [&BorderEdge; 2]) -> [Ordering; 4] {
    let points = moved(knots, [edges[0].from, edges[0].to, edges[1].from, edges[1].to]);
    let zero = BigInt::ZERO;
    let [u, v] = [0, 2].map(|i| [&points[i + 1][0] - &points[i][0], &points[i + 1][1] - &points[i][1]]);
    let half = |u: &[BigInt; 2]| u[1].cmp(&zero).then(u[0].cmp(&zero));
    let cross = (&u[0] * &v[1] - &u[1] * &v[0]).cmp(&zero);
    let dot = (&u[0] * &v[0] + &u[1] * &v[1]).cmp(&zero);
    [cross, dot, half(&u), half(&v)]
}

/// Most points of a box without boxes inside.
const LEAF: usize = 16;

/// A balanced tree of boxes. Each box is the bounding box of a range of points; its two children have the
/// halves of the range.
pub(super) struct Tree {
    ids: Vec<u32>,
    /// Least and greatest coordinates of each box. Box `i` has the children 2 i + 1 and 2 i + 2.
    boxes: Vec<[Xy; 2]>,
}

impl Tree {
    pub(super) fn of(points: &[Xy]) -> Tree {
        let mut ids: Vec<u32> = (0..points.len() as u32).collect();
        let mut boxes = Vec::new();
        build(points, &mut ids, 0, &mut boxes);
        Tree { ids, boxes }
    }

    /// Calls `take` with all points that a disk may contain, and possibly others, until it returns false.
    pub(super) fn for_each_in(&self, disk: &Disk, mut take: impl FnMut(u32) -> bool) {
        let mut waiting = vec![(0, 0..self.ids.len())];
        while let Some((node, range)) = waiting.pop() {
            if range.is_empty() || !disk.may_meet(self.boxes[node]) {
                continue;
            }
            if range.len() > LEAF {
                let middle = range.start.midpoint(range.end);
                waiting.extend([(2 * node + 1, range.start..middle), (2 * node + 2, middle..range.end)]);
            } else if !self.ids[range].iter().all(|&id| take(id)) {
                return;
            }
        }
    }
}

/// Sorts ids so that each range is split at its median along the longer side of its box, and finds the boxes.
fn build(points: &[Xy], ids: &mut [u32], node: usize, boxes: &mut Vec<[Xy; 2]>) {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for &id in ids.iter() {
        for axis in 0..2 {
            low[axis] = low[axis].min(points[id as usize][axis]);
            high[axis] = high[axis].max(points[id as usize][axis]);
        }
    }
    if boxes.len() <= node {
        boxes.resize(node + 1, [[0.0; 2]; 2]);
    }
    boxes[node] = [low, high];
    if ids.len() > LEAF {
        let axis = usize::from(high[1] - low[1] > high[0] - low[0]);
        let middle = ids.len() / 2;
        ids.select_nth_unstable_by(middle, |&a, &b| {
            points[a as usize][axis].total_cmp(&points[b as usize][axis]).then(a.cmp(&b))
        });
        let (left, right) = ids.split_at_mut(middle);
        build(points, left, 2 * node + 1, boxes);
        build(points, right, 2 * node + 2, boxes);
    }
}
