//! The triangles whose circles contain a target: those that would go if it was inserted.

use crate::delaunay2::Triangulation;
use crate::delaunay2::triangles::{Corner, Triangle};
use crate::predicates::{FiniteFloatPredicates, Point2, Predicates2, Sign};
use std::ops::Range;

/// A cavity, with buffers that are reused.
///
/// No vertex lies inside of it, so that its triangles form a tree, each joined to those across its edges. A
/// walk around the tree meets the edges of the border counterclockwise, and between two of them the triangles
/// at the vertex that they share, clockwise about that vertex.
#[derive(Debug, Default)]
pub(super) struct Cavity {
    /// The vertices of its triangles.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The edges of its border, counterclockwise. The end of the first one is the least of all vertices, so
    /// that nothing depends on the triangle where the walk began.
    pub(super) border: Vec<BorderEdge>,
    /// Places of triangles in `triangles`.
    fans: Vec<u32>,
    steps: Vec<Step>,
}

/// An edge of the border.
#[derive(Debug)]
pub(super) struct BorderEdge {
    /// Its ends, the cavity to the left.
    pub(super) ends: [u32; 2],
    /// The triangles of the cavity at its second end, in the list of fans.
    fan: Range<usize>,
}

/// What is left to do on the walk.
#[derive(Debug)]
enum Step {
    /// To look across the edge opposite to a corner of a triangle of the cavity, whose place is given.
    Across(Corner, u32),
    /// To come back to the triangle of this place.
    Back(u32),
}

impl Cavity {
    /// Finds the triangles in conflict with a target. Triangle `first` contains it, not at a corner or on the
    /// hull, so the circle of that triangle does too.
    ///
    /// A triangle whose circle the target lies on is left out: whether it is in or out changes no area.
    ///
    /// Cost: O(1) for each triangle.
    pub(super) fn find(
        &mut self,
        mesh: &Triangulation,
        first: u32,
        target: Point2,
        predicates: &mut FiniteFloatPredicates,
    ) {
        let triangles = mesh.triangles.triangles();
        let is_in_conflict = |triangle: &Triangle, predicates: &mut FiniteFloatPredicates| {
            let [a, b, c] = mesh.places(triangle);
            predicates.incircle(a, b, c, target) == Sign::Positive
        };
        self.triangles.clear();
        self.border.clear();
        self.fans.clear();
        self.steps.clear();
        self.enter(&triangles[first as usize]);
        self.steps.extend([2, 1, 0].map(|corner| Step::Across(Corner { triangle: first, corner }, 0)));
        while let Some(step) = self.steps.pop() {
            let (Corner { triangle, corner }, place) = match step {
                Step::Back(place) => {
                    self.fans.push(place);
                    continue;
                }
                Step::Across(corner, place) => (corner, place),
            };
            let side = corner as usize;
            let inner = &triangles[triangle as usize];
            let across =
                inner.neighbour(side).map(|entered| (entered, &triangles[entered.triangle as usize]));
            match across {
                Some((entered, outer)) if is_in_conflict(outer, predicates) => {
                    self.steps.push(Step::Back(place));
                    let place = self.enter(outer);
                    self.steps.extend([2, 1].map(|turn| {
                        let corner = (entered.corner + turn) % 3;
                        Step::Across(Corner { corner, ..entered }, place)
                    }));
                }
                _ => {
                    let ends = [1, 2].map(|turn| inner.vertices[(side + turn) % 3]);
                    self.close(ends, place);
                }
            }
        }
        self.finish();
    }

    /// The triangles at the second end of an edge of the border, by their places, clockwise about it.
    pub(super) fn fan(&self, edge: &BorderEdge) -> &[u32] {
        &self.fans[edge.fan.clone()]
    }

    /// The edge of the border that follows the edge of this place.
    pub(super) fn next(&self, place: usize) -> usize {
        if place + 1 == self.border.len() { 0 } else { place + 1 }
    }

    /// Adds a triangle; its place.
    fn enter(&mut self, triangle: &Triangle) -> u32 {
        let place = self.triangles.len() as u32;
        self.triangles.push(triangle.vertices);
        self.fans.push(place);
        place
    }

    /// Ends the fan at the first end of an edge of the border, and begins that at the other one.
    fn close(&mut self, ends: [u32; 2], place: u32) {
        let start = self.fans.len();
        if let Some(last) = self.border.last_mut() {
            last.fan.end = start;
        }
        self.border.push(BorderEdge { ends, fan: start..start });
        self.fans.push(place);
    }

    /// The fan that is open at the end goes on with what came before the first edge. Both have the first
    /// triangle.
    fn finish(&mut self) {
        let before = self.border[0].fan.start;
        self.fans.extend_from_within(1..before);
        let end = self.fans.len();
        self.border.last_mut().expect("an edge").fan.end = end;
        let least = (0..self.border.len()).min_by_key(|&place| self.border[place].ends[1]);
        self.border.rotate_left(least.expect("an edge"));
    }
}
