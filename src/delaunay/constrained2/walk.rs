//! Walks along straight lines from a vertex, and the triangles that a segment crosses.

use std::cmp::Ordering;

use super::mesh::{Mesh, NONE, Side};
use crate::predicates::{Point2, Predicates2, Sign, lexicographic};

/// How a walk ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    /// In this vertex.
    Vertex(u32),
    /// Inside of this triangle: the target is there.
    Inside(u32),
    /// On the line of this side, which is crossed last or, if none is crossed, opposite to the start: the
    /// target is on it.
    On(Side),
    /// At the border, which the line leaves through this side; or at the start, if the region is not there.
    Border(Option<Side>),
}

/// Sides that a walk crosses, as sides of the triangles that it leaves, and its end.
#[derive(Debug, Default)]
pub(super) struct Walk {
    pub(super) crossed: Vec<Side>,
}

/// The first vertex or side that a line from a vertex meets.
enum Start {
    Vertex(u32),
    Side(Side),
    Nothing,
}

/// Walks from vertex `from` straight towards `to`, which is another place, up to the first vertex on the line
/// or to the target.
pub(super) fn walk(mesh: &Mesh, from: u32, to: Point2, predicates: &mut impl Predicates2) -> (Walk, End) {
    let origin = mesh.place(from);
    let mut walk = Walk::default();
    let mut side = match start(mesh, from, to, predicates) {
        Start::Nothing => return (walk, End::Border(None)),
        Start::Vertex(vertex) => return (walk, End::Vertex(vertex)),
        Start::Side(side) => side,
    };
    loop {
        let vertices = mesh.triangle(side.triangle).vertices;
        let [right, left] = [vertices[(side.place + 1) % 3], vertices[(side.place + 2) % 3]];
        match predicates.orient2d(mesh.place(right), mesh.place(left), to) {
            Sign::Positive => return (walk, End::Inside(side.triangle)),
            Sign::Zero => return (walk, End::On(side)),
            Sign::Negative => (),
        }
        let Some(other) = mesh.across(side) else { return (walk, End::Border(Some(side))) };
        walk.crossed.push(side);
        let apex = mesh.triangle(other.triangle).vertices[other.place];
        // `other` runs from left to right; its next side runs from right to the apex, the one after to left.
        let turn = match predicates.orient2d(origin, to, mesh.place(apex)) {
            Sign::Zero => return (walk, end_at(mesh, other, apex, to, predicates)),
            // The apex is to the left, so the line leaves through the side from right to apex.
            Sign::Positive => 1,
            Sign::Negative => 2,
        };
        side = Side { triangle: other.triangle, place: (other.place + turn) % 3 };
    }
}

/// The end of a walk that enters a triangle through `entry` and meets its apex, unless the target comes
/// before.
fn end_at(mesh: &Mesh, entry: Side, apex: u32, to: Point2, predicates: &mut impl Predicates2) -> End {
    let vertices = mesh.triangle(entry.triangle).vertices;
    let [left, right] = [vertices[(entry.place + 1) % 3], vertices[(entry.place + 2) % 3]];
    // The target is before the apex if it is inside of the triangle.
    let is_before = predicates.orient2d(mesh.place(right), mesh.place(apex), to) == Sign::Positive
        && predicates.orient2d(mesh.place(apex), mesh.place(left), to) == Sign::Positive;
    if is_before { End::Inside(entry.triangle) } else { End::Vertex(apex) }
}

/// The triangle at a vertex that the line to a place enters.
fn start(mesh: &Mesh, from: u32, to: Point2, predicates: &mut impl Predicates2) -> Start {
    let origin = mesh.place(from);
    let entered = mesh.find_around(from, |Side { triangle, place }| {
        let vertices = mesh.triangle(triangle).vertices;
        let ends = [1, 2].map(|turn| vertices[(place + turn) % 3]);
        let sides = ends.map(|end| predicates.orient2d(origin, to, mesh.place(end)));
        for (end, side) in ends.into_iter().zip(sides) {
            if side == Sign::Zero && is_ahead(origin, to, mesh.place(end)) {
                return Some(Start::Vertex(end));
            }
        }
        (sides == [Sign::Negative, Sign::Positive]).then_some(Start::Side(Side { triangle, place }))
    });
    entered.unwrap_or(Start::Nothing)
}

/// Whether a place on the line from `origin` to another place is on the same side of the origin.
pub(super) fn is_ahead(origin: Point2, to: Point2, place: Point2) -> bool {
    let direction = lexicographic(origin, to);
    direction != Ordering::Equal && lexicographic(origin, place) == direction
}

/// The sides on the border of a region, with the places of their ends; triangles are on the left.
pub(super) fn border(mesh: &Mesh) -> impl Iterator<Item = (Side, [Point2; 2])> + '_ {
    (0..mesh.triangles.len() as u32).flat_map(move |triangle| {
        let of = mesh.triangle(triangle);
        let is_open = |&place: &usize| of.neighbours[place] == NONE;
        (0..3).filter(is_open).map(move |place| {
            let ends = [1, 2].map(|turn| mesh.place(of.vertices[(place + turn) % 3]));
            (Side { triangle, place }, ends)
        })
    })
}

/// The triangles that a segment crosses which enters the region through a side of its border, up to the next
/// vertex on it or to the border. `from` is its end that is outside of this side.
pub(super) fn from_border(
    mesh: &Mesh,
    side: Side,
    [from, to]: [Point2; 2],
    predicates: &mut impl Predicates2,
) -> Vec<u32> {
    let (mut crossed, mut side) = (Vec::new(), side);
    loop {
        crossed.push(side.triangle);
        let apex = mesh.triangle(side.triangle).vertices[side.place];
        // The side runs counterclockwise; the next one ends at the apex, and the one after starts there.
        let turn = match predicates.orient2d(from, to, mesh.place(apex)) {
            Sign::Zero => return crossed,
            Sign::Positive => 1,
            Sign::Negative => 2,
        };
        let leaving = Side { triangle: side.triangle, place: (side.place + turn) % 3 };
        let Some(other) = mesh.across(leaving) else { return crossed };
        side = other;
    }
}
