//! The recursion: where the points are cut, and what is small enough not to be.

use super::edges::{Edges, NIL};
use super::merge::{Hull, Stitch};
use crate::predicates::{Point2, Predicates2, Sign, WithPredicates2, lexicographic};
use std::cmp::Ordering;
use std::ops::Range;

/// Which way two sets of points are separated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Cut {
    /// Every point of the first set is lexicographically below every point of the second.
    Vertical,
    /// Every point of the first set has a lesser y than every point of the second.
    Horizontal,
}

impl Cut {
    /// Order of two points across the cut. The order for a horizontal cut is that for a vertical one after a quarter
    /// turn that takes (x, y) to (y, -x), so that ties are broken alike.
    #[inline(always)]
    pub(super) fn compare(self, p: Point2, q: Point2) -> Ordering {
        match self {
            Cut::Vertical => lexicographic(p, q),
            Cut::Horizontal => lexicographic([p[1], -p[0]], [q[1], -q[0]]),
        }
    }
}

/// Triangulates distinct points in Morton order.
///
/// A range of points is cut where the highest bit changes in which its keys differ: at an axis-parallel line.
/// Points with equal keys are in lexicographic order and are cut in the middle. The depth is at most 64 cuts of the
/// first kind and 32 of the second.
pub(super) struct Division<'a, 'e> {
    pub(super) points: &'a [Point2],
    pub(super) keys: &'a [u64],
    pub(super) edges: &'a mut Edges<'e>,
}

impl WithPredicates2 for Division<'_, '_> {
    type Output = Hull;

    fn with(self, predicates: &mut impl Predicates2) -> Hull {
        let mut stitch = Stitch { points: self.points, edges: self.edges, predicates };
        match self.points.len() {
            0 => Hull::of_point(NIL),
            count => conquer(&mut stitch, self.keys, 0..count),
        }
    }
}

fn conquer<P: Predicates2>(stitch: &mut Stitch<P>, keys: &[u64], range: Range<usize>) -> Hull {
    let first = range.start as u32;
    match range.len() {
        1 => return Hull::of_point(first),
        2 => return pair(stitch.edges, first, first + 1),
        3 => return triple(stitch, first),
        _ => {}
    }
    let (middle, cut) = cut_of(keys, range.clone());
    let left = conquer(stitch, keys, range.start..middle);
    let right = conquer(stitch, keys, middle..range.end);
    stitch.merge(left, right, cut)
}

/// Where to cut a range of at least two points.
fn cut_of(keys: &[u64], range: Range<usize>) -> (usize, Cut) {
    let differing = keys[range.start] ^ keys[range.end - 1];
    if differing == 0 {
        return (range.start + range.len() / 2, Cut::Vertical);
    }
    let bit = differing.ilog2();
    let middle = range.start + keys[range].partition_point(|key| key >> bit & 1 == 0);
    // Bits of x have odd numbers.
    (middle, if bit % 2 == 1 { Cut::Vertical } else { Cut::Horizontal })
}

fn pair(edges: &mut Edges, u: u32, v: u32) -> Hull {
    let e = edges.connect(u, NIL, v, NIL);
    Hull { vertex: u, start: e, end: e ^ 1 }
}

/// Triangle, or chain if they are collinear, of the three points from `first` on.
fn triple<P: Predicates2>(stitch: &mut Stitch<P>, first: u32) -> Hull {
    let point = |v: u32| stitch.points[v as usize];
    let mut vertices = [first, first + 1, first + 2];
    vertices.sort_unstable_by(|&u, &v| lexicographic(point(u), point(v)));
    let [u, v, w] = vertices;
    let turn = stitch.predicates.orient2d(point(u), point(v), point(w));
    let edges = &mut *stitch.edges;
    let uv = edges.connect(u, NIL, v, NIL);
    let vw = edges.connect(v, uv ^ 1, w, NIL);
    match turn {
        Sign::Zero => Hull { vertex: u, start: uv, end: vw ^ 1 },
        Sign::Positive => {
            let wu = edges.connect(w, vw ^ 1, u, uv);
            Hull { vertex: u, start: uv, end: wu }
        }
        Sign::Negative => {
            let uw = edges.connect(u, uv, w, vw ^ 1);
            Hull { vertex: u, start: uw, end: vw ^ 1 }
        }
    }
}
