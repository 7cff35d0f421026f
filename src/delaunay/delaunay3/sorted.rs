//! Tetrahedra in an order that depends on nothing but themselves.

use super::tetrahedralization::{NONE, Tetrahedralization, Tetrahedron, WORDS};
use crate::order::sizes_to_starts;
use std::sync::OnceLock;

/// The twelve even permutations of four corners, by the corner that comes first, then by the one after it.
const TURNS: [[usize; 4]; 12] = [
    [0, 1, 2, 3],
    [0, 2, 3, 1],
    [0, 3, 1, 2],
    [1, 0, 3, 2],
    [1, 2, 0, 3],
    [1, 3, 2, 0],
    [2, 0, 1, 3],
    [2, 1, 3, 0],
    [2, 3, 0, 1],
    [3, 0, 2, 1],
    [3, 1, 0, 2],
    [3, 2, 1, 0],
];

impl Tetrahedralization {
    /// Puts the tetrahedra in order: by their vertices as the curve orders them, the least first in each.
    /// Before, the order depends on the number of threads. They stay positively oriented.
    ///
    /// Cost: O(n). Memory: for a second array of tetrahedra, while it works.
    pub fn sort(&mut self) {
        let turns: Vec<u8> = self.tetrahedra.iter().map(turn_of).collect();
        for (tetrahedron, &turn) in self.tetrahedra.iter_mut().zip(&turns) {
            let turn = TURNS[turn as usize];
            *tetrahedron = Tetrahedron {
                vertices: turn.map(|corner| tetrahedron.vertices[corner]),
                neighbours: turn.map(|corner| tetrahedron.neighbours[corner]),
            };
        }
        let places = self.places();
        let blank = Tetrahedron { vertices: [0; 4], neighbours: [NONE; 4] };
        let mut sorted = vec![blank; self.tetrahedra.len()];
        for (tetrahedron, &place) in self.tetrahedra.iter().zip(&places) {
            let neighbours = tetrahedron.neighbours.map(|facet| {
                if facet == NONE {
                    return NONE;
                }
                let (number, corner) = (facet as usize / WORDS, facet as usize % WORDS);
                let turn = TURNS[turns[number] as usize];
                let corner = turn.iter().position(|&from| from == corner).unwrap_or_default();
                (places[number] as usize * WORDS + corner) as u32
            });
            sorted[place as usize] = Tetrahedron { vertices: tetrahedron.vertices, neighbours };
        }
        self.tetrahedra = sorted;
        self.starts = OnceLock::new();
    }

    /// For each tetrahedron its place in the order, given that its least vertex comes first.
    fn places(&self) -> Vec<u32> {
        // Where the tetrahedra of each first vertex start; after they are put there, where they end.
        let mut ends = vec![0u32; self.vertices.len()];
        self.tetrahedra.iter().for_each(|tetrahedron| ends[tetrahedron.vertices[0] as usize] += 1);
        sizes_to_starts(&mut ends);
        let mut order = vec![0; self.tetrahedra.len()];
        for (number, tetrahedron) in (0u32..).zip(&self.tetrahedra) {
            let end = &mut ends[tetrahedron.vertices[0] as usize];
            order[*end as usize] = number;
            *end += 1;
        }
        let mut start = 0;
        for &end in &ends {
            let group = &mut order[start as usize..end as usize];
            group.sort_unstable_by_key(|&number| self.tetrahedra[number as usize].vertices);
            start = end;
        }
        let mut places = vec![0; order.len()];
        (0..).zip(order).for_each(|(place, number)| places[number as usize] = place);
        places
    }
}

/// The number of the turn that brings the least vertex to the front, and then the least of the others.
fn turn_of(tetrahedron: &Tetrahedron) -> u8 {
    let vertices = tetrahedron.vertices;
    let least = |turns: &mut dyn Iterator<Item = usize>, at: usize| {
        turns.min_by_key(|&turn| vertices[TURNS[turn][at]]).unwrap_or_default()
    };
    let first = least(&mut (0..12).step_by(3), 0);
    least(&mut (first..first + 3), 1) as u8
}
