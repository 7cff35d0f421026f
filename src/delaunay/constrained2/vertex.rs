//! Vertices that are inserted.

use super::mesh::{Mesh, NONE, Side, Vertex};
use super::walk::{End, walk};
use crate::predicates::{Point2, Predicates2, lexicographic};

/// Where a place lies, by the numbers of points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Host {
    /// At a point.
    Point(u32),
    /// On an edge.
    Edge([u32; 2]),
    /// Inside of a triangle.
    Triangle([u32; 3]),
}

const IN_REGION: &str = "the place is in a triangle of the region";

/// Where a place lies in the mesh.
pub(super) enum At {
    Vertex(u32),
    On(Side),
    Inside(u32),
}

/// Where a place lies to which a straight walk from a vertex stays in the region.
pub(super) fn host(mesh: &Mesh, from: u32, place: Point2, predicates: &mut impl Predicates2) -> Host {
    let point = |vertex: u32| mesh.vertices[vertex as usize].point;
    match locate(mesh, from, place, predicates).expect(IN_REGION) {
        At::Vertex(vertex) => Host::Point(point(vertex)),
        At::Inside(triangle) => Host::Triangle(mesh.triangle(triangle).vertices.map(point)),
        At::On(side) => {
            let vertices = mesh.triangle(side.triangle).vertices;
            Host::Edge([1, 2].map(|turn| point(vertices[(side.place + turn) % 3])))
        }
    }
}

/// Inserts a point at a place to which a straight walk from vertex `from` stays in the region. Returns its
/// vertex; `None` if the place has one already.
pub(super) fn insert(
    mesh: &mut Mesh,
    from: u32,
    point: u32,
    place: Point2,
    predicates: &mut impl Predicates2,
) -> Option<u32> {
    let at = locate(mesh, from, place, predicates).expect(IN_REGION);
    if matches!(at, At::Vertex(_)) {
        return None;
    }
    let vertex = mesh.vertices.len() as u32;
    mesh.vertices.push(Vertex { place, point, triangle: NONE });
    let position = mesh.points.partition_point(|&[other, _]| other < point);
    mesh.points.insert(position, [point, vertex]);
    match at {
        At::Vertex(_) => (),
        At::Inside(triangle) => split_triangle(mesh, triangle, vertex),
        At::On(side) => split_edge(mesh, side, vertex),
    }
    mesh.restore(predicates);
    Some(vertex)
}

/// Finds a place by a straight walk from vertex `from`; `None` if the walk leaves the region.
pub(super) fn locate(
    mesh: &Mesh,
    mut from: u32,
    place: Point2,
    predicates: &mut impl Predicates2,
) -> Option<At> {
    loop {
        if mesh.place(from) == place {
            return Some(At::Vertex(from));
        }
        match walk(mesh, from, place, predicates).1 {
            End::Inside(triangle) => return Some(At::Inside(triangle)),
            End::On(side) => return Some(At::On(side)),
            End::Vertex(vertex) => {
                // The walk went along an edge, or met a vertex. The place may be before it, on the edge.
                let passed =
                    lexicographic(mesh.place(from), place) == lexicographic(place, mesh.place(vertex));
                if passed && mesh.place(vertex) != place {
                    return edge(mesh, from, vertex).map(At::On);
                }
                from = vertex;
            }
            End::Border(_) => return None,
        }
    }
}

/// The side between two vertices.
pub(super) fn edge(mesh: &Mesh, from: u32, to: u32) -> Option<Side> {
    mesh.find_around(from, |Side { triangle, place }| {
        let vertices = mesh.triangle(triangle).vertices;
        let other = [1, 2].into_iter().find(|other| vertices[(place + other) % 3] == to)?;
        Some(Side { triangle, place: (place + 3 - other) % 3 })
    })
}

/// Divides a triangle in three.
fn split_triangle(mesh: &mut Mesh, number: u32, vertex: u32) {
    let triangle = *mesh.triangle(number);
    let across = [0, 1, 2].map(|place| mesh.across(Side { triangle: number, place }));
    let [a, b, c] = triangle.vertices;
    let first = mesh.triangles.len() as u32;
    mesh.triangles.extend([triangle; 2]);
    let numbers = [number, first, first + 1];
    for (place, ends) in [[b, c], [c, a], [a, b]].into_iter().enumerate() {
        let [from, to] = ends;
        let outer = [across[place], None, None];
        mesh.set(numbers[place], [vertex, from, to], outer, [triangle.segments[place], NONE, NONE]);
        mesh.doubtful.push(Side { triangle: numbers[place], place: 0 });
    }
    for place in 0..3 {
        // Across the side opposite to `from` is the triangle of the next side, which starts at `to`.
        let [next, last] = [1, 2].map(|turn| numbers[(place + turn) % 3]);
        let neighbours = &mut mesh.triangles[numbers[place] as usize].neighbours;
        [neighbours[1], neighbours[2]] = [next, last];
    }
}

/// Divides an edge, and the triangles on both sides of it, in two.
fn split_edge(mesh: &mut Mesh, side: Side, vertex: u32) {
    let other = mesh.across(side);
    let near = split_at(mesh, side, vertex);
    if let Some(other) = other {
        let far = split_at(mesh, other, vertex);
        // The halves are in opposite order on both sides.
        for [a, b] in [[near[0], far[1]], [near[1], far[0]]] {
            mesh.triangles[a.triangle as usize].neighbours[a.place] = b.triangle;
            mesh.triangles[b.triangle as usize].neighbours[b.place] = a.triangle;
        }
    }
}

/// Divides the triangle of a side by a vertex on the side. Returns both halves of the side, whose neighbours
/// are to be set.
fn split_at(mesh: &mut Mesh, side: Side, vertex: u32) -> [Side; 2] {
    let triangle = *mesh.triangle(side.triangle);
    let [apex, from, to] = [0, 1, 2].map(|turn| triangle.vertices[(side.place + turn) % 3]);
    let outer = [1, 2].map(|turn| {
        let place = (side.place + turn) % 3;
        (mesh.across(Side { triangle: side.triangle, place }), triangle.segments[place])
    });
    let on = triangle.segments[side.place];
    let [halves, second] = [side.triangle, mesh.triangles.len() as u32];
    mesh.triangles.push(triangle);
    mesh.set(halves, [apex, from, vertex], [None, None, outer[1].0], [on, NONE, outer[1].1]);
    mesh.set(second, [apex, vertex, to], [None, outer[0].0, None], [on, outer[0].1, NONE]);
    mesh.triangles[halves as usize].neighbours[1] = second;
    mesh.triangles[second as usize].neighbours[2] = halves;
    mesh.doubtful.push(Side { triangle: halves, place: 2 });
    mesh.doubtful.push(Side { triangle: second, place: 1 });
    [halves, second].map(|triangle| Side { triangle, place: 0 })
}
