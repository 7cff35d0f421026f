//! Copies of knots, inserted one by one into the triangulation of the first knots of all places (Bowyer, 1981; Watson, 1981).

use super::knots::Knots;
use super::plane::Plane;
use super::surface::{Corner, Start};
use crate::predicates::TotalPredicates;
use foldhash::{HashMap, HashMapExt};

impl Start {
    /// Inserts all knots of a rank above 0, those of lesser id first.
    ///
    /// The nearest knot of P(e) is one at the same place, and the edge to it will be there, so a triangle around that one is
    /// in conflict. Cost: that of the stars of all copies at a place, for each.
    pub(super) fn insert_copies(&mut self, knots: &Knots) {
        let mut predicates = TotalPredicates::default();
        let mut plane = Plane::new(knots, None, &mut predicates);
        let mut corner_at = vec![Corner::MAX; knots.len()];
        for (t, triangle) in (0..).zip(&self.triangles) {
            for (i, &v) in (0..).zip(triangle) {
                if let Some(corner) = corner_at.get_mut(v as usize) {
                    *corner = 3 * t + i;
                }
            }
        }
        let place = |id: u32| knots.at(id).map(|c| if c == 0.0 { 0 } else { c.to_bits() });
        let mut inserted: HashMap<[u64; 2], Vec<u32>> = HashMap::new();
        for id in (0..knots.len() as u32).filter(|&id| knots.rank(id) > 0) {
            inserted.insert(place(id), Vec::new());
        }
        for id in 0..knots.len() as u32 {
            let Some(present) = inserted.get_mut(&place(id)) else { continue };
            if knots.rank(id) > 0 {
                let around = present.iter().rev().flat_map(|&copy| self.star(corner_at[copy as usize]));
                let first = around.map(|corner| corner / 3).find(|&t| {
                    let triangle = self.triangles[t as usize];
                    plane.is_in_conflict(triangle, id)
                });
                debug_assert!(first.is_some(), "the edge to the nearest knot is in the triangulation");
                if let Some(first) = first {
                    self.insert(&mut plane, id, first, &mut corner_at);
                }
            }
            present.push(id);
        }
    }

    /// The corners at the vertex of a corner, counterclockwise.
    pub(super) fn star(&self, first: Corner) -> impl Iterator<Item = Corner> + '_ {
        let mut next = Some(first);
        std::iter::from_fn(move || {
            let corner = next?;
            let (t, i) = (corner as usize / 3, corner as usize % 3);
            // The edge opposite to the following vertex ends at this one; beyond it, this is the vertex after.
            let beyond = self.across[t][(i + 1) % 3];
            let after = beyond - beyond % 3 + (beyond % 3 + 1) % 3;
            next = (after != first).then_some(after);
            Some(corner)
        })
    }

    /// Replaces the triangles in conflict with a knot, which are connected, by a star around it.
    fn insert(&mut self, plane: &mut Plane<TotalPredicates>, id: u32, first: u32, corner_at: &mut [Corner]) {
        let mut cavity = vec![first];
        let mut border: Vec<(u32, u32, Corner)> = Vec::new();
        let mut place = 0;
        while place < cavity.len() {
            let t = cavity[place] as usize;
            place += 1;
            for i in 0..3 {
                let beyond = self.across[t][i];
                if cavity.contains(&(beyond / 3)) {
                    continue;
                }
                if plane.is_in_conflict(self.triangles[beyond as usize / 3], id) {
                    cavity.push(beyond / 3);
                } else {
                    border.push((self.triangles[t][(i + 1) % 3], self.triangles[t][(i + 2) % 3], beyond));
                }
            }
        }
        self.fill(id, &cavity, &border, corner_at);
    }

    fn fill(&mut self, id: u32, cavity: &[u32], border: &[(u32, u32, Corner)], corner_at: &mut [Corner]) {
        let count = self.triangles.len() as u32;
        let fresh = count..count + 2;
        let slots: Vec<u32> = cavity.iter().copied().chain(fresh).collect();
        self.triangles.resize(count as usize + 2, [0; 3]);
        self.across.resize(count as usize + 2, [0; 3]);
        let mut starting_at: HashMap<u32, u32> = HashMap::with_capacity(border.len());
        for (&t, &(a, b, beyond)) in slots.iter().zip(border) {
            self.triangles[t as usize] = [id, a, b];
            self.set_across(3 * t, beyond);
            starting_at.insert(a, t);
            for (i, v) in [(0, id), (1, a), (2, b)] {
                if let Some(corner) = corner_at.get_mut(v as usize) {
                    *corner = 3 * t + i;
                }
            }
        }
        for (&t, &(_, b, _)) in slots.iter().zip(border) {
            if let Some(&next) = starting_at.get(&b) {
                self.set_across(3 * t + 1, 3 * next + 2);
            }
        }
    }
}
