//! The vertices of the result.

use super::exact::Place;

/// The vertices of the result: places of lines, and crossings.
pub(super) struct Nodes {
    /// In lexicographic order.
    pub(super) places: Vec<Place>,
    /// Number of the node of each place of lines, then of each crossing; empty if they are the same.
    numbers: Vec<u32>,
    /// Elevations that lines state; empty if they state none.
    stated: Vec<f64>,
    /// Whether each node is a crossing without a vertex; empty if none is.
    is_crossing: Vec<bool>,
}

impl Nodes {
    /// Of places of lines, with the elevations that lines state or none, and crossings. Needs no second copy
    /// of the places.
    pub(super) fn of(mut places: Vec<Place>, mut stated: Vec<f64>, crossings: &[Place]) -> Nodes {
        if crossings.is_empty() {
            return Nodes { places, numbers: Vec::new(), stated, is_crossing: Vec::new() };
        }
        let mut order: Vec<u32> = (0..crossings.len() as u32).collect();
        order.sort_unstable_by_key(|&crossing| crossings[crossing as usize]);
        let (old, total) = (places.len(), places.len() + crossings.len());
        let has_elevations = !stated.is_empty();
        places.reserve_exact(crossings.len());
        places.resize(total, Place::default());
        if has_elevations {
            stated.reserve_exact(crossings.len());
            stated.resize(total, f64::NAN);
        }
        let (mut numbers, mut is_crossing) = (vec![0; total], vec![false; total]);
        // From the last to the first, each place moves up or stays.
        let mut place = old;
        for node in (0..total).rev() {
            let next = order.last().map(|&crossing| crossings[crossing as usize]);
            is_crossing[node] = next.is_some_and(|next| place == 0 || places[place - 1] < next);
            if is_crossing[node] {
                let crossing = order.pop().map_or(0, |crossing| crossing as usize);
                places[node] = crossings[crossing];
                numbers[old + crossing] = node as u32;
            } else {
                place -= 1;
                places[node] = places[place];
                numbers[place] = node as u32;
            }
            if has_elevations {
                stated[node] = if is_crossing[node] { f64::NAN } else { stated[place] };
            }
        }
        Nodes { places, numbers, stated, is_crossing }
    }

    /// The node of a place of lines, or beyond these, of a crossing.
    pub(super) fn of_place(&self, number: u32) -> u32 {
        self.numbers.get(number as usize).copied().unwrap_or(number)
    }

    /// Places, and the elevations that lines state, or none if they state none. Frees the rest.
    pub(super) fn into_places(self) -> (Vec<Place>, Vec<f64>) {
        (self.places, self.stated)
    }

    /// Whether lines state elevations.
    pub(super) fn has_elevations(&self) -> bool {
        !self.stated.is_empty()
    }

    pub(super) fn stated(&self, node: u32) -> f64 {
        self.stated.get(node as usize).copied().unwrap_or(f64::NAN)
    }

    pub(super) fn is_crossing(&self, node: u32) -> bool {
        self.is_crossing.get(node as usize).copied().unwrap_or(false)
    }

    /// Segments and their nodes, in order.
    pub(super) fn sorted(&self, touches: &[[u32; 2]]) -> Vec<u64> {
        let number =
            |&[segment, place]: &[u32; 2]| u64::from(segment) << 32 | u64::from(self.of_place(place));
        let mut sorted: Vec<u64> = touches.iter().map(number).collect();
        sorted.sort_unstable();
        sorted
    }

    /// Whether y decreases from one node to another, which is not to the left of it.
    pub(super) fn is_falling(&self, from: u32, to: u32) -> bool {
        self.places[to as usize][1] < self.places[from as usize][1]
    }

    /// Sorts nodes along a segment that rises, or falls.
    pub(super) fn key_along(&self, node: u32, is_falling: bool) -> Place {
        let [x, y] = self.places[node as usize];
        [x, if is_falling { -y } else { y }]
    }
}
