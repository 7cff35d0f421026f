//! Vertices whose simplices go around them twice: found when they are finalized, wherever the boundary is.

use spmesh_audit::Check;

use super::assert_violates;
use super::streamed::{Flat, Solid};

/// A fan of triangles around the vertex 0, that closes.
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

/// Two fans close at the same vertex, each of which would be right alone.
#[test]
fn two_sheets_at_a_vertex_of_the_plane() {
    let points = [&[[0, 0]][..], &TRIANGLE, &TRIANGLE.map(|p| p.map(|c| -c))].concat();
    let one: Vec<[usize; 3]> = fan(&[1, 2, 3]).collect();
    Flat::new(&points[..4], &one).audit().unwrap();
    let both: Vec<[usize; 3]> = one.into_iter().chain(fan(&[4, 5, 6])).collect();
    let violation = assert_violates(Flat::new(&points, &both).audit(), Check::Vertices, &[0]);
    assert!(violation.message.contains("go around it 2 times"), "{violation:?}");
}

/// A vertex on the boundary with a closed fan more: one open edge in, one out, and half of its directions
/// twice.
#[test]
fn fan_behind_a_vertex_of_the_hull() {
    let points = [&[[0, 0]][..], &TRIANGLE, &[[9, 9], [-9, 9]]].concat();
    let triangles: Vec<[usize; 3]> = fan(&[1, 2, 3]).chain([[0, 4, 5]]).collect();
    let violation = assert_violates(Flat::new(&points, &triangles).audit(), Check::Vertices, &[0]);
    assert!(violation.message.contains("cover a direction 2 times"), "{violation:?}");
}

/// Tetrahedra between the vertex 0 and the triangles of a closed surface around it.
fn star(surface: &[[usize; 3]]) -> Vec<[usize; 4]> {
    // Seen from the vertex the triangles are clockwise.
    surface.iter().map(|&[a, b, c]| [a, c, b, 0]).collect()
}

/// A double pyramid over a ring, counterclockwise seen from outside: with the vertices `bottom` and `top`.
fn pyramids(ring: &[usize], bottom: usize, top: usize) -> Vec<[usize; 3]> {
    let next = |i: usize| ring[(i + 1) % ring.len()];
    (0..ring.len()).flat_map(|i| [[ring[i], next(i), top], [next(i), ring[i], bottom]]).collect()
}

/// A ring around the origin, vertices 1 to 3, and twice; below and above it 7 and 8.
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

/// Two spheres around the vertex 0: Euler's relation tells.
#[test]
fn two_sheets_at_a_vertex_of_space() {
    let mut points = solid_points();
    points.extend([[0, 0, -9], [0, 0, 10]]);
    let surfaces = [pyramids(&[1, 2, 3], 7, 8), pyramids(&[4, 5, 6], 9, 10)].concat();
    assert_violates(Solid::new(&points, &star(&surfaces)).audit(), Check::Vertices, &[0]);
}
