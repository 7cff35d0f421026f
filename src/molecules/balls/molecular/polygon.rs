//! Convex polygons in a plane.

use crate::balls::face::Side;

/// A half-plane: the product with its outward normal, of length 1, is at most `offset`.
#[derive(Debug, Clone, Copy)]
pub(super) struct HalfPlane {
    pub(super) outward: [f64; 2],
    pub(super) offset: f64,
}

/// A convex polygon.
#[derive(Debug, Clone, Default)]
pub(super) struct Polygon {
    /// Counterclockwise.
    corners: Vec<[f64; 2]>,
}

impl Polygon {
    /// The square between -`half` and `half` on both axes.
    pub(super) fn square(half: f64) -> Polygon {
        Polygon { corners: vec![[-half, -half], [half, -half], [half, half], [-half, half]] }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// Cuts off what is outside of a half-plane. `spare` is a buffer.
    pub(super) fn cut(&mut self, half: HalfPlane, spare: &mut Polygon) {
        let depth = |[x, y]: [f64; 2]| half.offset - (half.outward[0] * x + half.outward[1] * y);
        if self.corners.iter().all(|&corner| depth(corner) >= 0.0) {
            return;
        }
        spare.corners.clear();
        for (i, &corner) in self.corners.iter().enumerate() {
            let next = self.corners[(i + 1) % self.corners.len()];
            let [own, other] = [corner, next].map(depth);
            if own >= 0.0 {
                spare.corners.push(corner);
            }
            if (own >= 0.0) != (other >= 0.0) {
                let share = own / (own - other);
                spare.corners.push([0, 1].map(|axis| corner[axis] + share * (next[axis] - corner[axis])));
            }
        }
        std::mem::swap(&mut self.corners, &mut spare.corners);
    }

    /// Becomes a copy of another.
    pub(super) fn copy(&mut self, other: &Polygon) {
        self.corners.clone_from(&other.corners);
    }

    /// The sides, on lines through the corners. They are not those of the half-planes: only so the sides of
    /// polygons without area, where several half-planes begin at one line, cancel.
    pub(super) fn sides(&self) -> impl Iterator<Item = Side> {
        self.corners.iter().enumerate().filter_map(|(i, &[x, y])| {
            let [u, v] = self.corners[(i + 1) % self.corners.len()];
            let size = (u - x).hypot(v - y);
            let [p, q] = [(u - x) / size, (v - y) / size];
            let side = Side { offset: x * q - y * p, from: x * p + y * q, to: u * p + v * q };
            (size > 0.0).then_some(side)
        })
    }
}
