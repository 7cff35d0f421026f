//! The vertices of the result: distinct places, and the parts of lines between them.

use super::exact::{COORDINATE_MAX, Place};
use super::{LineVertex, NodingChange};

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

/// The distinct places of vertices.
pub(super) struct Places {
    /// In lexicographic order.
    pub(super) places: Vec<Place>,
    /// Lowest elevation that a line states at each place; NaN if none does. Empty if no line states any.
    pub(super) elevations: Vec<f64>,
    /// Places for which different elevations are stated, each with the number of a vertex.
    pub(super) conflicts: Vec<[u32; 2]>,
    /// Place of each vertex.
    ids: Vec<u32>,
}

/// A part of a line between two consecutive vertices.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    /// Numbers of places, the lesser one first.
    pub(super) ends: [u32; 2],
    pub(super) line: u32,
    /// Whether the line states elevations at both ends.
    pub(super) is_hard: bool,
}

/// The parts of all lines.
pub(super) struct Parts(pub(super) Vec<Part>);

const COORDINATE_BITS: u32 = 44;

/// Place and number of a vertex in one integer, which sorts by place.
fn key(place: Place, number: usize) -> u128 {
    let [x, y] = place.map(|value| (value + COORDINATE_MAX) as u128);
    ((x << COORDINATE_BITS | y) << 32) | number as u128
}

impl Places {
    pub(super) fn of(vertices: &[LineVertex]) -> Places {
        let numbered = vertices.iter().enumerate();
        let mut keys: Vec<u128> = numbered.map(|(number, vertex)| key(vertex.place, number)).collect();
        keys.sort_unstable();
        let has_elevations = vertices.iter().any(|vertex| vertex.z.is_some());
        let mut found = Places {
            places: Vec::new(),
            elevations: Vec::new(),
            conflicts: Vec::new(),
            ids: vec![0; vertices.len()],
        };
        for at_place in keys.chunk_by(|a, b| a >> 32 == b >> 32) {
            let numbers = || at_place.iter().map(|&key| key as u32 as usize);
            let id = found.places.len() as u32;
            numbers().for_each(|number| found.ids[number] = id);
            found.places.extend(numbers().next().map(|number| vertices[number].place));
            if has_elevations {
                let mut stated = numbers().filter_map(|number| vertices[number].z);
                let first = stated.next();
                let (mut lowest, mut is_conflict) = (first.unwrap_or(f64::NAN), false);
                for z in stated {
                    is_conflict |= Some(z) != first;
                    lowest = lowest.min(z);
                }
                found.elevations.push(lowest);
                if is_conflict {
                    found.conflicts.push([id, at_place[0] as u32]);
                }
            }
        }
        found
    }
}

impl Parts {
    /// Leaves out parts without length, and parts that go back along the part before them.
    pub(super) fn of(
        places: &Places,
        vertices: &[LineVertex],
        starts: &[u32],
        note: &mut dyn FnMut(NodingChange, u32, Place),
    ) -> Parts {
        let mut parts = Vec::with_capacity(vertices.len());
        for (line, &start) in starts.iter().enumerate() {
            let (start, line) = (start as usize, line as u32);
            let end = starts.get(line as usize + 1).map_or(vertices.len(), |&next| next as usize);
            let first_part = parts.len();
            for number in start + 1..end {
                let ends = [places.ids[number - 1], places.ids[number]];
                let place = vertices[number].place;
                if ends[0] == ends[1] {
                    note(NodingChange::ZeroLength, line, place);
                    continue;
                }
                let ends = [ends[0].min(ends[1]), ends[0].max(ends[1])];
                let is_hard = vertices[number - 1].z.is_some() && vertices[number].z.is_some();
                let part = Part { ends, line, is_hard };
                match parts[first_part..].last_mut() {
                    Some(Part { ends: last, is_hard: was_hard, .. }) if *last == ends => {
                        *was_hard |= is_hard;
                        note(NodingChange::Spike, line, vertices[number - 1].place);
                    }
                    _ => parts.push(part),
                }
            }
            if first_part == parts.len() && start < end {
                note(NodingChange::SingleVertex, line, vertices[start].place);
            }
        }
        Parts(parts)
    }
}
