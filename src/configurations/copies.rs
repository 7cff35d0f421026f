//! Inserts copies of knots one by one into the triangulation of the first knots of all places (Bowyer, 1981;
//! Watson, 1981).

use super::knots::Knots;
use super::plane::Plane;
use super::surface::{Corner, Start};
use foldhash::{HashMap, HashMapExt};
use spmesh_base::random::Random;
use spmesh_delaunay::predicates::FiniteFloatPredicates;
use std::collections::BTreeMap;

/// Knots at one place that are already in the triangulation, by rank.
type Present = BTreeMap<u32, u32>;

impl Start {
    /// Inserts all knots of a rank above 0.
    ///
    /// The edge from a copy to the nearest knot of P(e) will be in the triangulation, so a triangle around
    /// that knot is in conflict. Copies are inserted in random order. Then stars are small on average,
    /// including stars of nearest knots, because a knot is nearest to at most five others. In the order of
    /// ranks, each copy would take over a large part of the star of the copy before.
    ///
    /// Cost: O(n log n) expected for n knots, whatever the number of places.
    pub(super) fn insert_copies(&mut self, knots: &Knots) {
        let mut predicates = FiniteFloatPredicates::default();
        let mut plane = Plane::new(knots, None, &mut predicates);
        let mut corner_at = self.corners_at(knots.len());
        let place = |id: u32| knots.at(id).map(|c| if c == 0.0 { 0 } else { c.to_bits() });
        let mut copies: Vec<u32> = (0..knots.len() as u32).filter(|&id| knots.rank(id) > 0).collect();
        let mut present: HashMap<[u64; 2], Present> = HashMap::with_capacity(copies.len());
        for &id in &copies {
            present.insert(place(id), Present::new());
        }
        for id in (0..knots.len() as u32).filter(|&id| knots.rank(id) == 0) {
            if let Some(present) = present.get_mut(&place(id)) {
                present.insert(0, id);
            }
        }
        Random::new(copies.len() as u64).shuffle(&mut copies);
        for id in copies {
            let Some(present) = present.get_mut(&place(id)) else { continue };
            let conflict = nearest(present, knots.rank(id)).and_then(|near| {
                let mut around = self.star(corner_at[near as usize]).map(|corner| corner / 3);
                around.find(|&t| plane.is_in_conflict(self.triangles[t as usize], id))
            });
            debug_assert!(conflict.is_some(), "the edge to the nearest knot is in the triangulation");
            if let Some(first) = conflict {
                self.insert(&mut plane, id, first, &mut corner_at);
            }
            present.insert(knots.rank(id), id);
        }
    }

    /// For each knot, a corner at it; `Corner::MAX` for knots that are not in the triangulation.
    fn corners_at(&self, count: usize) -> Vec<Corner> {
        let mut corner_at = vec![Corner::MAX; count];
        for (t, triangle) in (0..).zip(&self.triangles) {
            for (i, &v) in (0..).zip(triangle) {
                if let Some(corner) = corner_at.get_mut(v as usize) {
                    *corner = 3 * t + i;
                }
            }
        }
        corner_at
    }

    /// The corners at the vertex of a corner, counterclockwise.
    pub(super) fn star(&self, first: Corner) -> impl Iterator<Item = Corner> + '_ {
        let mut next = Some(first);
        std::iter::from_fn(move || {
            let corner = next?;
            let (t, i) = (corner as usize / 3, corner as usize % 3);
            // The edge opposite to the next vertex ends at this vertex. In the triangle across that edge,
            // this vertex follows it.
            let neighbour = self.neighbours[t][(i + 1) % 3];
            let after = neighbour - neighbour % 3 + (neighbour % 3 + 1) % 3;
            next = (after != first).then_some(after);
            Some(corner)
        })
    }

    /// Replaces the triangles in conflict with a knot by a star around it.
    ///
    /// All knots stay vertices, so the cavity has no inner vertex. Its triangles form a tree, so none is
    /// visited twice.
    fn insert(
        &mut self,
        plane: &mut Plane<FiniteFloatPredicates>,
        id: u32,
        first: u32,
        corner_at: &mut [Corner],
    ) {
        let [a, b, c] = self.triangles[first as usize];
        let [neighbour_a, neighbour_b, neighbour_c] = self.neighbours[first as usize];
        // A stack of edges to look across, with the cavity to the left.
        let mut waiting = vec![(c, a, neighbour_b), (b, c, neighbour_a), (a, b, neighbour_c)];
        let mut free = vec![first];
        let mut ring: Option<[u32; 2]> = None;
        while let Some((from, to, neighbour)) = waiting.pop() {
            let (t, i) = (neighbour as usize / 3, neighbour as usize % 3);
            if plane.is_in_conflict(self.triangles[t], id) {
                let tip = self.triangles[t][i];
                waiting.push((tip, to, self.neighbours[t][(i + 2) % 3]));
                waiting.push((from, tip, self.neighbours[t][(i + 1) % 3]));
                free.push(t as u32);
                continue;
            }
            let fresh = free.pop().unwrap_or_else(|| self.push());
            self.triangles[fresh as usize] = [id, from, to];
            self.set_neighbour(3 * fresh, neighbour);
            for (i, v) in [(0, id), (1, from), (2, to)] {
                if let Some(corner) = corner_at.get_mut(v as usize) {
                    *corner = 3 * fresh + i;
                }
            }
            if let Some([_, last]) = ring {
                self.set_neighbour(3 * last + 1, 3 * fresh + 2);
            }
            ring = Some([ring.map_or(fresh, |[start, _]| start), fresh]);
        }
        debug_assert!(free.is_empty(), "a vertex brings two triangles");
        if let Some([start, last]) = ring {
            self.set_neighbour(3 * last + 1, 3 * start + 2);
        }
    }

    /// Adds a triangle and returns its number.
    fn push(&mut self) -> u32 {
        self.triangles.push([0; 3]);
        self.neighbours.push([0; 3]);
        self.triangles.len() as u32 - 1
    }
}

/// Of the present knots at one place, the nearest to the knot of this rank. The knot of rank j lies at (j,
/// j²), so the nearest one has the next lesser or the next greater rank.
fn nearest(present: &Present, rank: u32) -> Option<u32> {
    let square = |other: u32| {
        let (difference, sum) = (u128::from(rank.abs_diff(other)), u128::from(rank) + u128::from(other));
        difference * difference * (1 + sum * sum)
    };
    let neighbours = [present.range(..rank).next_back(), present.range(rank..).next()];
    neighbours.into_iter().flatten().min_by_key(|&(&other, _)| square(other)).map(|(_, &id)| id)
}
