//! The middle of a flat area, and elevations along it.
//!
//! Its nodes are the middles of the sides between flat triangles and at exits, the centroids of triangles
//! with three such sides, and the corners of triangles with one, which are the tips. The way from an exit to
//! a tip falls or rises evenly, from the elevation of the corner beyond the exit to that of the line at the
//! farthest tip; where ways part, each goes on evenly to its own farthest tip.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use super::{Flat, Side};
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::Point;

/// A flat area.
pub(super) struct Area<'a> {
    pub(super) triangles: &'a [Flat],
    pub(super) exits: Vec<Exit>,
}

/// A side at which an area ends.
pub(super) struct Exit {
    pub(super) side: Side,
    pub(super) ends: [Point; 2],
    /// The corner beyond.
    pub(super) beyond: Point,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Name {
    Side(Side),
    /// Of a triangle: its centroid or its tip.
    Triangle(usize),
}

struct Node {
    at: Point,
    /// Whether it is a tip, where there is a vertex already.
    is_tip: bool,
    /// Distances to other nodes.
    links: Vec<(usize, f64)>,
}

/// The nodes of an area off the line, with their elevations; `None` if the exits do not lead to one
/// elevation.
///
/// Nodes that `coordinates` would round to the elevation of the line are left out: they make flat triangles.
pub(super) fn elevations(area: &Area, coordinates: &Coordinates) -> Option<Vec<Point>> {
    let beyond = area.exits.first()?.beyond[2];
    if area.exits.iter().any(|exit| exit.beyond[2] != beyond) {
        return None;
    }
    let (mut nodes, numbers) = nodes(area);
    let level = area.triangles[0].corners[0][2];
    let ways = Ways::of(&nodes, area, &numbers);
    // From the exits inward.
    for &number in &ways.order {
        let tip = ways.tip[number];
        let (from, length) = match ways.before[number] {
            Before::Exit(length) => (beyond, length),
            Before::Node(before, length) => (nodes[before].at[2], length),
        };
        nodes[number].at[2] = level + (from - level) * (tip / (tip + length));
    }
    let is_inside = |node: &Node| !node.is_tip && coordinates.rounded(node.at[2]) != level;
    Some(nodes.into_iter().filter(is_inside).map(|node| node.at).collect())
}

fn middle(places: &[Point]) -> Point {
    std::array::from_fn(|axis| places.iter().map(|place| place[axis]).sum::<f64>() / places.len() as f64)
}

fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The nodes of an area, and their numbers by their names.
fn nodes(area: &Area) -> (Vec<Node>, BTreeMap<Name, usize>) {
    let (mut nodes, mut numbers): (Vec<Node>, BTreeMap<Name, usize>) = (Vec::new(), BTreeMap::new());
    for (number, triangle) in area.triangles.iter().enumerate() {
        let mut enter = |name: Name, at: Point, is_tip: bool| {
            *numbers.entry(name).or_insert_with(|| {
                nodes.push(Node { at, is_tip, links: Vec::new() });
                nodes.len() - 1
            })
        };
        let corners = triangle.corners;
        let of_side = |(opposite, side): (usize, &Option<Side>)| {
            side.map(|side| {
                (side, middle(&[corners[(opposite + 1) % 3], corners[(opposite + 2) % 3]]), opposite)
            })
        };
        let sides: Vec<(Side, Point, usize)> =
            triangle.sides.iter().enumerate().filter_map(of_side).collect();
        let mut all: Vec<usize> =
            sides.iter().map(|&(side, at, _)| enter(Name::Side(side), at, false)).collect();
        match sides[..] {
            [(.., opposite)] => all.push(enter(Name::Triangle(number), corners[opposite], true)),
            [_, _, _] => all.insert(0, enter(Name::Triangle(number), middle(&corners), false)),
            _ => {}
        }
        for &other in all.get(1..).unwrap_or_default() {
            let length = distance(nodes[all[0]].at, nodes[other].at);
            nodes[all[0]].links.push((other, length));
            nodes[other].links.push((all[0], length));
        }
    }
    (nodes, numbers)
}

/// What is before a node on the way from an exit, and how far away.
#[derive(Debug, Clone, Copy)]
enum Before {
    /// The corner beyond the exit.
    Exit(f64),
    Node(usize, f64),
}

/// The shortest ways from the corners beyond exits to all nodes.
struct Ways {
    /// Nodes by their distances.
    order: Vec<usize>,
    before: Vec<Before>,
    /// The length of the way from each node to the farthest end.
    tip: Vec<f64>,
}

impl Ways {
    fn of(nodes: &[Node], area: &Area, numbers: &BTreeMap<Name, usize>) -> Ways {
        let mut before = vec![Before::Exit(0.0); nodes.len()];
        let mut distances = vec![f64::INFINITY; nodes.len()];
        let mut heap = BinaryHeap::new();
        for exit in &area.exits {
            let Some(&number) = numbers.get(&Name::Side(exit.side)) else { continue };
            let length = distance(middle(&exit.ends), exit.beyond);
            if length < distances[number] {
                (distances[number], before[number]) = (length, Before::Exit(length));
                heap.push(Reverse((length.to_bits(), number)));
            }
        }
        let (mut order, mut is_done) = (Vec::new(), vec![false; nodes.len()]);
        // Bits of lengths, which are not negative, sort as the lengths do.
        while let Some(Reverse((_, number))) = heap.pop() {
            if std::mem::replace(&mut is_done[number], true) {
                continue;
            }
            order.push(number);
            for &(other, length) in &nodes[number].links {
                let far = distances[number] + length;
                if far < distances[other] {
                    (distances[other], before[other]) = (far, Before::Node(number, length));
                    heap.push(Reverse((far.to_bits(), other)));
                }
            }
        }
        let mut tip = vec![0.0; nodes.len()];
        for &number in order.iter().rev() {
            if let Before::Node(before, length) = before[number] {
                tip[before] = f64::max(tip[before], tip[number] + length);
            }
        }
        Ways { order, before, tip }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of squares from x = 0 to 4 at elevation 10, open at the left, with the next line at 20, two
    /// units before it.
    #[test]
    fn a_strip_falls_evenly_to_its_end() {
        let at = |i: u64| [(i / 2) as f64, (i % 2) as f64, 10.0];
        let triangle = |a: u64, is_last: bool| {
            let corners = [a, a + 1, a + 2].map(at);
            // The sides opposite to the first and the last corner cross the strip.
            let sides = [(!is_last).then_some([a + 1, a + 2]), None, Some([a, a + 1])];
            Flat { corners, sides }
        };
        let triangles: Vec<Flat> = (0..8).map(|a| triangle(a, a == 7)).collect();
        let exit = |beyond: f64| Exit { side: [0, 1], ends: [at(0), at(1)], beyond: [-2.0, 0.5, beyond] };
        let area = Area { triangles: &triangles, exits: vec![exit(20.0)] };
        let places = elevations(&area, &Coordinates::F64).unwrap();
        assert_eq!(places.len(), 8);
        let length = 2.0 + 7.0 * 0.5 + distance([3.5, 0.5, 0.0], at(9));
        for [x, y, z] in places {
            assert_eq!(y, 0.5);
            assert!((z - (20.0 - 10.0 * (2.0 + x) / length)).abs() < 1e-12, "{x}: {z}");
        }
        let two = Area { triangles: &triangles, exits: vec![exit(20.0), exit(0.0)] };
        assert!(elevations(&two, &Coordinates::F64).is_none());
        assert!(elevations(&Area { triangles: &triangles, exits: Vec::new() }, &Coordinates::F64).is_none());
    }
}
