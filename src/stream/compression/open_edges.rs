//! The edges at the border of the triangles so far, as far as vertices remember them.

/// Stands for no vertex.
pub(super) const NONE: u32 = u32::MAX;

/// The open edges that a vertex remembers, newest first: two that leave it, and two that reach it, as the
/// vertices at their other ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct OpenEdges {
    pub(super) to: [u32; 2],
    pub(super) from: [u32; 2],
}

/// The open edges of all vertices.
///
/// An edge is open from the triangle that has it until one comes that has it in the other direction. A vertex
/// forgets the oldest where it would have to remember more than two.
pub(super) struct Border(Vec<OpenEdges>);

impl Border {
    pub(super) fn new(vertices: usize) -> Self {
        Border(vec![OpenEdges { to: [NONE; 2], from: [NONE; 2] }; vertices])
    }

    #[inline(always)]
    pub(super) fn at(&self, vertex: u32) -> OpenEdges {
        self.0[vertex as usize]
    }

    /// Takes in the three edges of a triangle, in this order.
    #[inline(always)]
    pub(super) fn triangle(&mut self, [a, b, c]: [u32; 3]) {
        self.edge(a, b);
        self.edge(b, c);
        self.edge(c, a);
    }

    /// Closes the edge from `b` to `a` if either end remembers it; opens that from `a` to `b` otherwise.
    #[inline(always)]
    fn edge(&mut self, a: u32, b: u32) {
        let (reach_a, leave_b) = (self.0[a as usize].from, self.0[b as usize].to);
        if reach_a.contains(&b) || leave_b.contains(&a) {
            self.0[a as usize].from = without(reach_a, b);
            self.0[b as usize].to = without(leave_b, a);
        } else {
            let leave_a = &mut self.0[a as usize].to;
            *leave_a = [b, leave_a[0]];
            let reach_b = &mut self.0[b as usize].from;
            *reach_b = [a, reach_b[0]];
        }
    }
}

/// A list of two without `vertex`; the newest one, if it is there twice.
#[inline(always)]
fn without([newest, oldest]: [u32; 2], vertex: u32) -> [u32; 2] {
    if newest == vertex {
        [oldest, NONE]
    } else if oldest == vertex {
        [newest, NONE]
    } else {
        [newest, oldest]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shared_edge_closes() {
        let mut border = Border::new(4);
        border.triangle([0, 1, 2]);
        assert_eq!((border.at(1).to, border.at(1).from), ([2, NONE], [0, NONE]));
        border.triangle([2, 1, 3]);
        assert_eq!((border.at(1).to, border.at(1).from), ([3, NONE], [0, NONE]));
        assert_eq!((border.at(2).to, border.at(2).from), ([0, NONE], [3, NONE]));
    }

    #[test]
    fn the_oldest_of_three_is_forgotten() {
        let mut border = Border::new(7);
        for corner in [1, 3, 5] {
            border.triangle([0, corner, corner + 1]);
        }
        assert_eq!((border.at(0).to, border.at(0).from), ([5, 3], [6, 4]));
    }
}
