//! The edges on segments of a constrained mesh, each once.

use foldhash::HashSet;

use super::event::Patch;

/// Tells which edges on segments are new, so that consumers take each of them once, although two triangles
/// may state it.
///
/// Memory: the edges on segments whose second triangle has not come: those of the front and of the border.
#[derive(Debug, Default)]
pub struct ConstraintEdges {
    open: HashSet<[u64; 2]>,
}

impl ConstraintEdges {
    /// The edges on segments that a patch states first: the local indices of their ends, counterclockwise in
    /// their triangle, and the numbers of their segments.
    pub fn enter(&mut self, patch: &Patch) -> Vec<([u32; 2], u32)> {
        let mut new = Vec::new();
        for &[triangle, place, segment] in &patch.sides {
            let corner = |place: u32| patch.simplices[(3 * triangle + place % 3) as usize];
            let ends = [corner(place + 1), corner(place + 2)];
            let [a, b] = ends.map(|local| patch.id(local));
            let key = [a.min(b), a.max(b)];
            if !self.open.remove(&key) {
                self.open.insert(key);
                new.push((ends, segment));
            }
        }
        new
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_is_new_once() {
        let mut edges = ConstraintEdges::default();
        let first = Patch {
            new: vec![[0.0; 3]; 3],
            simplices: vec![0, 1, 2],
            sides: vec![[0, 0, 5], [0, 1, 7]],
            ..Patch::default()
        };
        assert_eq!(edges.enter(&first), [([1, 2], 5), ([2, 0], 7)]);
        let second = Patch {
            first_id: 3,
            new: vec![[0.0; 3]],
            imported: vec![1, 2],
            simplices: vec![2, 1, 0],
            sides: vec![[0, 1, 9], [0, 2, 5]],
            ..Patch::default()
        };
        assert_eq!(edges.enter(&second), [([0, 2], 9)]);
    }
}
