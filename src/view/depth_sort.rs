//! The order in which triangles that may hide each other are drawn: those behind first.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use foldhash::{HashMap, HashMapExt};

/// A triangle as the eye sees it.
pub(super) struct Turned {
    /// Its vertices.
    pub(super) ids: [u64; 3],
    /// Where they are in the plan: to the right of the eye, and away from it.
    pub(super) places: [[f64; 2]; 3],
}

/// A triangle that may be drawn next, and its distance from the eye.
struct Ready {
    depth: f64,
    number: usize,
}

impl Ord for Ready {
    fn cmp(&self, other: &Ready) -> Ordering {
        self.depth.total_cmp(&other.depth).then(other.number.cmp(&self.number))
    }
}

impl PartialOrd for Ready {
    fn partial_cmp(&self, other: &Ready) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Ready {
    fn eq(&self, other: &Ready) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Ready {}

/// The indices of triangles in drawing order: each comes after all triangles that it may hide.
///
/// Of two triangles with a common edge, the one behind that edge comes first. In a Delaunay triangulation,
/// this relation has no cycles (Edelsbrunner, "An acyclicity theorem for cell complexes in d dimensions",
/// 1990), so it decides. In other meshes, the farthest triangle of a cycle comes first.
pub(super) fn back_to_front(triangles: &[Turned]) -> Vec<usize> {
    let depth = |number: usize| triangles[number].places.iter().map(|place| place[1]).sum::<f64>();
    // For each triangle, how many must come before it, and which come after it.
    let (mut waits, mut frees) = (vec![0u8; triangles.len()], vec![[usize::MAX; 3]; triangles.len()]);
    let mut open: HashMap<[u64; 2], usize> = HashMap::new();
    for (number, triangle) in triangles.iter().enumerate() {
        for (side, [from, to]) in [[0, 1], [1, 2], [2, 0]].into_iter().enumerate() {
            let [a, b] = [from, to].map(|end| triangle.ids[end]);
            let Some(other) = open.remove(&[b, a]) else {
                open.insert([a, b], 3 * number + side);
                continue;
            };
            // The triangle is on the left of its edge: behind it if the edge leads to the right. An edge
            // straight away from the eye hides nothing; it is treated as if the eye were a little to one
            // side.
            let is_behind = triangle.places[to] > triangle.places[from];
            let [first, second] =
                if is_behind { [3 * number + side, other] } else { [other, 3 * number + side] };
            frees[first / 3][first % 3] = second / 3;
            waits[second / 3] += 1;
        }
    }
    let ready = |number| Ready { depth: depth(number), number };
    let mut heap: BinaryHeap<Ready> =
        (0..triangles.len()).filter(|&number| waits[number] == 0).map(ready).collect();
    let mut farthest: Vec<usize> = (0..triangles.len()).collect();
    farthest.sort_by(|&a, &b| depth(a).total_cmp(&depth(b)));
    let (mut order, mut is_drawn) = (Vec::with_capacity(triangles.len()), vec![false; triangles.len()]);
    while order.len() < triangles.len() {
        let next = heap.pop().map(|Ready { number, .. }| number).or_else(|| farthest.pop());
        let Some(number) = next.filter(|&number| !is_drawn[number]) else { continue };
        is_drawn[number] = true;
        order.push(number);
        for &freed in frees[number].iter().filter(|&&freed| freed != usize::MAX) {
            waits[freed] = waits[freed].saturating_sub(1);
            if waits[freed] == 0 && !is_drawn[freed] {
                heap.push(ready(freed));
            }
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(ids: [u64; 3], places: [[f64; 2]; 3]) -> Turned {
        Turned { ids, places }
    }

    #[test]
    fn a_long_triangle_in_front_comes_after_those_that_it_hides() {
        // Its far end is farther away than the middle of the small one behind it.
        let long = || triangle([0, 1, 2], [[0.0, 0.0], [100.0, 90.0], [20.0, 19.0]]);
        let small = || triangle([0, 2, 3], [[0.0, 0.0], [20.0, 19.0], [1.0, 4.0]]);
        assert_eq!(back_to_front(&[long(), small()]), [1, 0]);
        assert_eq!(back_to_front(&[small(), long()]), [0, 1]);
    }

    #[test]
    fn triangles_behind_each_other_in_turn_are_all_drawn() {
        // Three around a hole, each with an edge that goes on below the next one.
        let (a, b, c) = ([0.0, 0.0], [10.0, 0.0], [5.0, 9.0]);
        let (p, q, r) = ([4.0, 2.0], [6.0, 3.0], [4.5, 4.0]);
        let of = |ids, corners| triangle(ids, corners);
        let turn = [
            of([0, 1, 3], [a, b, p]),
            of([1, 4, 3], [b, q, p]),
            of([1, 2, 4], [b, c, q]),
            of([2, 5, 4], [c, r, q]),
            of([2, 0, 5], [c, a, r]),
            of([0, 3, 5], [a, p, r]),
        ];
        let mut order = back_to_front(&turn);
        order.sort_unstable();
        assert_eq!(order, [0, 1, 2, 3, 4, 5]);
    }
}
