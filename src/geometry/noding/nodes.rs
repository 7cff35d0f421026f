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
    /// Of places of lines, with the elevations that lines state or none, and crossings.
    pub(super) fn of(places: Vec<Place>, elevations: Vec<f64>, crossings: &[Place]) -> Nodes {
        if crossings.is_empty() {
            return Nodes { places, numbers: Vec::new(), stated: elevations, is_crossing: Vec::new() };
        }
        let mut order: Vec<u32> = (0..crossings.len() as u32).collect();
        order.sort_unstable_by_key(|&crossing| crossings[crossing as usize]);
        let (old, total) = (places.len(), places.len() + crossings.len());
        let mut nodes = Nodes {
            places: Vec::with_capacity(total),
            numbers: vec![0; total],
            stated: Vec::with_capacity(if elevations.is_empty() { 0 } else { total }),
            is_crossing: Vec::with_capacity(total),
        };
        let (mut place, mut crossing) = (0, 0);
        while nodes.places.len() < total {
            let next = order.get(crossing).map(|&crossing| crossings[crossing as usize]);
            let is_crossing = place == old || next.is_some_and(|next| next < places[place]);
            let number = if is_crossing { old + order[crossing] as usize } else { place };
            nodes.numbers[number] = nodes.places.len() as u32;
            nodes.is_crossing.push(is_crossing);
            if !elevations.is_empty() {
                nodes.stated.push(if is_crossing { f64::NAN } else { elevations[place] });
            }
            nodes.places.extend(if is_crossing { next } else { Some(places[place]) });
            (place, crossing) = (place + usize::from(!is_crossing), crossing + usize::from(is_crossing));
        }
        nodes
    }

    /// The node of a place of lines, or beyond these, of a crossing.
    pub(super) fn of_place(&self, number: u32) -> u32 {
        self.numbers.get(number as usize).copied().unwrap_or(number)
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
