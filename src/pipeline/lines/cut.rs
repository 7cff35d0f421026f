//! Polygons of water, cut at the box of the points.
//!
//! Each side of the box cuts each ring in turn (Sutherland and Hodgman 1974). What is left of a ring may run
//! along a side and back, through dry ground. So edges are divided where vertices are on them, those that all
//! rings together have an even number of times are left out, as they bound nothing by the even-odd rule, and
//! the rest are made rings again.

use std::collections::BTreeMap;

use crate::polygons::Polygons;
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::model::points::Point2;

/// A closed chain of vertices: the first one is also the last.
type Ring = Vec<Point>;

/// The parts of a polygon inside of a box: each of them is its outer ring and its holes. Elevations are
/// interpolated along what is cut.
pub(super) fn cut(rings: &[Ring], bounds: &Bounds, coordinates: &Coordinates) -> Vec<Vec<Ring>> {
    let clipped: Vec<Ring> = rings.iter().map(|ring| clip(ring, bounds, coordinates)).collect();
    nested(chains(&edges(&clipped, bounds)))
}

/// A place as a key that sorts as its coordinates do.
fn key(point: &Point) -> [u64; 2] {
    // -0 and 0 are one place.
    [point[0], point[1]].map(|at| {
        let bits = (at + 0.0).to_bits();
        if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
    })
}

/// The edges that all rings together have an odd number of times. Those along a side of the box are divided
/// at all vertices there.
fn edges(rings: &[Ring], bounds: &Bounds) -> Vec<[Point; 2]> {
    let sides = [(0, bounds.min[0]), (0, bounds.max[0]), (1, bounds.min[1]), (1, bounds.max[1])];
    let along = sides.map(|(axis, at)| {
        let mut vertices: Vec<Point> =
            rings.iter().flatten().filter(|point| point[axis] == at).copied().collect();
        vertices.sort_by_key(key);
        vertices.dedup_by_key(|point| key(point));
        vertices
    });
    let mut counts: BTreeMap<[[u64; 2]; 2], ([Point; 2], u32)> = BTreeMap::new();
    let mut enter = |from: Point, to: Point| {
        let ends = if key(&to) < key(&from) { [to, from] } else { [from, to] };
        if key(&from) != key(&to) {
            counts.entry(ends.each_ref().map(key)).or_insert((ends, 0)).1 += 1;
        }
    };
    for ends in rings.iter().flat_map(|ring| ring.windows(2)) {
        let [from, to] = if key(&ends[1]) < key(&ends[0]) { [ends[1], ends[0]] } else { [ends[0], ends[1]] };
        let side = sides.iter().position(|&(axis, at)| from[axis] == at && to[axis] == at);
        let between = side.map_or(&[][..], |side| {
            let start = along[side].partition_point(|point| key(point) <= key(&from));
            let end = along[side].partition_point(|point| key(point) < key(&to));
            &along[side][start..end.max(start)]
        });
        let mut last = from;
        for &point in between.iter().chain([&to]) {
            enter(last, point);
            last = point;
        }
    }
    counts.into_values().filter(|(_, count)| count % 2 == 1).map(|(ends, _)| ends).collect()
}

/// Edges as closed chains. Each vertex has an even number of edges, so no chain has an end.
fn chains(edges: &[[Point; 2]]) -> Vec<Ring> {
    let mut at: BTreeMap<[u64; 2], Vec<usize>> = BTreeMap::new();
    for (number, ends) in edges.iter().enumerate() {
        ends.iter().for_each(|end| at.entry(key(end)).or_default().push(number));
    }
    let mut is_used = vec![false; edges.len()];
    let mut found = Vec::new();
    for (first, &[start, _]) in edges.iter().enumerate() {
        let (mut ring, mut end) = (vec![start], start);
        let mut next = Some(first).filter(|&edge| !is_used[edge]);
        while let Some(edge) = next {
            is_used[edge] = true;
            let [a, b] = edges[edge];
            end = if key(&a) == key(&end) { b } else { a };
            ring.push(end);
            let free = at[&key(&end)].iter().copied().find(|&edge| !is_used[edge]);
            next = free.filter(|_| key(&end) != key(&start));
        }
        if ring.len() > 1 {
            found.push(ring);
        }
    }
    found
}

/// Rings as polygons: those in an even number of others are outer ones, and the others holes of the one of
/// these that is next around them.
fn nested(rings: Vec<Ring>) -> Vec<Vec<Ring>> {
    if rings.len() < 2 {
        return rings.into_iter().map(|ring| vec![ring]).collect();
    }
    let place = |point: &Point| -> Point2 { [point[0], point[1]] };
    let ends = |(number, ring): (u32, &Ring)| -> Vec<(u32, [Point2; 2])> {
        ring.windows(2).map(|ends| (number, [place(&ends[0]), place(&ends[1])])).collect()
    };
    let all = Polygons::of_edges((0..).zip(&rings).flat_map(ends));
    let around = |ring: &Ring| {
        let [a, b] = [place(&ring[0]), place(&ring[1])];
        let mut numbers = Vec::new();
        all.for_each_around([0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])], |number| {
            numbers.push(number as usize)
        });
        numbers
    };
    let around: Vec<Vec<usize>> = rings.iter().map(around).collect();
    let mut polygons: BTreeMap<usize, Vec<Ring>> = BTreeMap::new();
    let is_outer = |number: usize| around[number].len().is_multiple_of(2);
    for (number, ring) in rings.iter().enumerate().filter(|(number, _)| is_outer(*number)) {
        polygons.insert(number, vec![ring.clone()]);
    }
    for (number, ring) in rings.into_iter().enumerate().filter(|(number, _)| !is_outer(*number)) {
        let next = around[number].iter().max_by_key(|&&other| around[other].len());
        if let Some(polygon) = next.and_then(|next| polygons.get_mut(next)) {
            polygon.push(ring);
        }
    }
    polygons.into_values().collect()
}

/// The part of a ring inside of a box, as one ring.
fn clip(ring: &Ring, bounds: &Bounds, coordinates: &Coordinates) -> Ring {
    let mut ring = ring.clone();
    for axis in 0..2 {
        ring = beyond(&ring, axis, bounds.min[axis], 1.0, coordinates);
        ring = beyond(&ring, axis, bounds.max[axis], -1.0, coordinates);
    }
    ring
}

/// The part of a ring on one side of a line: where coordinates times `sign` are at least `limit` times it.
fn beyond(ring: &[Point], axis: usize, limit: f64, sign: f64, coordinates: &Coordinates) -> Vec<Point> {
    let is_in = |place: &Point| (place[axis] - limit) * sign >= 0.0;
    let mut kept: Vec<Point> = Vec::new();
    for ends in ring.windows(2) {
        let [from, to] = [ends[0], ends[1]];
        if is_in(&from) {
            kept.push(from);
        }
        if is_in(&from) != is_in(&to) {
            kept.push(crossing(from, to, axis, limit, coordinates));
        }
    }
    kept.dedup();
    if let Some(&first) = kept.first()
        && kept.last() != Some(&first)
    {
        kept.push(first);
    }
    kept
}

/// Where an edge crosses a line, on the grid; the same for both directions of the edge.
fn crossing(a: Point, b: Point, axis: usize, limit: f64, coordinates: &Coordinates) -> Point {
    let [a, b] = if (b[0], b[1]) < (a[0], a[1]) { [b, a] } else { [a, b] };
    let along = (limit - a[axis]) / (b[axis] - a[axis]);
    let mut place: Point = std::array::from_fn(|it| coordinates.rounded(a[it] + (b[it] - a[it]) * along));
    place[axis] = limit;
    place
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: Coordinates = Coordinates::I32 { scale: [1.0; 3], offset: [0.0; 3] };

    /// Twice the signed area.
    fn area(ring: &[Point]) -> f64 {
        ring.windows(2).map(|ends| ends[0][0] * ends[1][1] - ends[1][0] * ends[0][1]).sum()
    }

    const BOX: Bounds = Bounds { min: [0.0, 0.0, 0.0], max: [10.0, 10.0, 0.0] };

    fn ring(places: &[[f64; 2]], z: f64) -> Ring {
        places.iter().chain(&places[..1]).map(|&[x, y]| [x, y, z]).collect()
    }

    fn square([left, right, bottom, top]: [f64; 4]) -> [[f64; 2]; 4] {
        [[left, bottom], [right, bottom], [right, top], [left, top]]
    }

    /// Areas of the outer rings less those of the holes, and the number of rings of each polygon.
    fn parts(rings: &[Ring]) -> Vec<(f64, usize)> {
        let polygons = cut(rings, &BOX, &GRID);
        let size = |polygon: &Vec<Ring>| {
            let holes: f64 = polygon[1..].iter().map(|hole| area(hole).abs()).sum();
            (0.5 * (area(&polygon[0]).abs() - holes), polygon.len())
        };
        let inside = |point: &Point| (0..2).all(|axis| (0.0..=10.0).contains(&point[axis]));
        assert!(polygons.iter().flatten().flatten().all(inside));
        assert!(polygons.iter().flatten().all(|ring| ring.first() == ring.last() && ring.len() > 3));
        polygons.iter().map(size).collect()
    }

    #[test]
    fn the_inside_stays() {
        let across = square([-5.0, 5.0, 2.0, 4.0]);
        assert_eq!(parts(&[ring(&across, 8.0)]), [(10.0, 1)]);
        assert_eq!(parts(&[ring(&across.map(|[x, y]| [x + 5.0, y]), 8.0)]), [(20.0, 1)]);
        assert_eq!(parts(&[ring(&across.map(|[x, y]| [x - 6.0, y]), 8.0)]), []);
        // The box's corner is inside, and with an island.
        let corner = ring(&square([5.0, 20.0, 5.0, 20.0]), 3.0);
        assert_eq!(parts(std::slice::from_ref(&corner)), [(25.0, 1)]);
        assert_eq!(parts(&[corner, ring(&square([7.0, 8.0, 6.0, 8.0]), 3.0)]), [(23.0, 2)]);
        // An island that reaches over the border is no hole any more.
        let lake = ring(&square([-5.0, 6.0, 1.0, 9.0]), 3.0);
        assert_eq!(parts(&[lake, ring(&square([-3.0, 4.0, 3.0, 5.0]), 3.0)]), [(40.0, 1)]);
    }

    #[test]
    fn nothing_runs_along_dry_sides() {
        // Two arms of a lake come in, and its rest is outside.
        let arms = [
            [3.0, 2.0],
            [14.0, 2.0],
            [14.0, 8.0],
            [3.0, 8.0],
            [3.0, 7.0],
            [12.0, 7.0],
            [12.0, 3.0],
            [3.0, 3.0],
        ];
        assert_eq!(parts(&[ring(&arms, 1.0)]), [(7.0, 1), (7.0, 1)]);
        // A lake around a corner of the box, which stays dry.
        let around = [
            [8.0, 12.0],
            [8.0, 9.0],
            [2.0, 9.0],
            [2.0, 14.0],
            [14.0, 14.0],
            [14.0, 2.0],
            [9.0, 2.0],
            [9.0, 8.0],
            [12.0, 8.0],
            [12.0, 12.0],
        ];
        assert_eq!(parts(&[ring(&around, 1.0)]), [(6.0, 1), (6.0, 1)]);
        // The box is an island.
        let sea =
            [ring(&square([-9.0, 19.0, -9.0, 19.0]), 1.0), ring(&square([-1.0, 11.0, -1.0, 11.0]), 1.0)];
        assert_eq!(parts(&sea), []);
        // A spike bounds nothing.
        let spike = [[1.0, 1.0], [4.0, 4.0], [6.0, 4.0], [6.0, 6.0], [4.0, 6.0], [4.0, 4.0]];
        assert_eq!(parts(&[ring(&spike, 1.0)]), [(4.0, 1)]);
    }

    #[test]
    fn elevations_are_interpolated() {
        let rising =
            [[5.0, 1.0, 10.0], [15.0, 1.0, 20.0], [15.0, 3.0, 20.0], [5.0, 3.0, 10.0], [5.0, 1.0, 10.0]];
        let inside = cut(&[rising.to_vec()], &BOX, &GRID).concat().concat();
        assert!(inside.contains(&[10.0, 1.0, 15.0]) && inside.contains(&[10.0, 3.0, 15.0]), "{inside:?}");
    }
}
