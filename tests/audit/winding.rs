//! Vertices whose simplices go around them twice: the audit finds them when they are finalized, on the
//! boundary and off it.

use spmesh_audit::Check;

use super::assert_violates;
use super::streamed::{Flat, Solid};

/// A closed fan of triangles around the vertex 0.
fn fan(ring: &[usize]) -> impl Iterator<Item = [usize; 3]> {
    (0..ring.len()).map(|i| [0, ring[i], ring[(i + 1) % ring.len()]])
}

const TRIANGLE: [[i32; 2]; 3] = [[10, -6], [0, 11], [-10, -6]];

/// One fan goes around twice before it closes.
#[test]
fn branch_point_in_the_plane() {
    let points = [&[[0, 0]][..], &TRIANGLE, &TRIANGLE].concat();
    let triangles: Vec<[usize; 3]> = fan(&[1, 2, 3, 4, 5, 6]).collect();
    let violation = assert_violates(Flat::new(&points, &triangles).audit(), Check::Vertices, &[0]);
    assert!(violation.message.contains("go around it 2 times"), "{violation:?}");
}

/// Two closed fans share a vertex; each would be right alone.
#[test]
fn two_sheets_at_a_vertex_of_the_plane() {
    let points = [&[[0, 0]][..], &TRIANGLE, &TRIANGLE.map(|p| p.map(|c| -c))].concat();
    let one: Vec<[usize; 3]> = fan(&[1, 2, 3]).collect();
    Flat::new(&points[..4], &one).audit().unwrap();
    let both: Vec<[usize; 3]> = one.into_iter().chain(fan(&[4, 5, 6])).collect();
    let violation = assert_violates(Flat::new(&points, &both).audit(), Check::Vertices, &[0]);
    assert!(violation.message.contains("go around it 2 times"), "{violation:?}");
}

/// A vertex on the boundary with an additional closed fan: it has one incoming and one outgoing open edge,
/// but half of the directions around it are covered twice.
#[test]
fn fan_behind_a_vertex_of_the_hull() {
    let points = [&[[0, 0]][..], &TRIANGLE, &[[9, 9], [-9, 9]]].concat();
    let triangles: Vec<[usize; 3]> = fan(&[1, 2, 3]).chain([[0, 4, 5]]).collect();
    let violation = assert_violates(Flat::new(&points, &triangles).audit(), Check::Vertices, &[0]);
    assert!(violation.message.contains("cover a direction 2 times"), "{violation:?}");
}

/// The tetrahedra between the vertex 0 and the triangles of a closed surface around it.
fn star(surface: &[[usize; 3]]) -> Vec<[usize; 4]> {
    // Seen from the vertex, the triangles are clockwise.
    surface.iter().map(|&[a, b, c]| [a, c, b, 0]).collect()
}

/// The surface of a double pyramid over a ring, counterclockwise seen from outside, with the apexes `bottom`
/// and `top`.
fn pyramids(ring: &[usize], bottom: usize, top: usize) -> Vec<[usize; 3]> {
    let next = |i: usize| ring[(i + 1) % ring.len()];
    (0..ring.len()).flat_map(|i| [[ring[i], next(i), top], [next(i), ring[i], bottom]]).collect()
}

/// The origin, a ring around it (vertices 1 to 3) and a copy of the ring, and vertices 7 and 8 below and
/// above.
fn solid_points() -> Vec<[i32; 3]> {
    let ring = TRIANGLE.map(|[x, y]| [x, y, 0]);
    [&[[0, 0, 0]][..], &ring, &ring, &[[0, 0, -9], [0, 0, 10]]].concat()
}

/// The surface around the vertex 0 is one sphere, which goes around the axis twice.
#[test]
fn branch_line_in_space() {
    let points = solid_points();
    let once = Solid::new(&[&points[..4], &points[7..]].concat(), &star(&pyramids(&[1, 2, 3], 4, 5)));
    once.audit().unwrap();
    let twice = Solid::new(&points, &star(&pyramids(&[1, 2, 3, 4, 5, 6], 7, 8)));
    let violation = assert_violates(twice.audit(), Check::Vertices, &[0]);
    assert!(violation.message.contains("go around it 2 times"), "{violation:?}");
}

/// The surface around the vertex 0 is two spheres; Euler's relation finds them.
#[test]
fn two_sheets_at_a_vertex_of_space() {
    let mut points = solid_points();
    points.extend([[0, 0, -9], [0, 0, 10]]);
    let surfaces = [pyramids(&[1, 2, 3], 7, 8), pyramids(&[4, 5, 6], 9, 10)].concat();
    assert_violates(Solid::new(&points, &star(&surfaces)).audit(), Check::Vertices, &[0]);
}
