//! The mesh of a region from its triangles.

use super::mesh::{Mesh, NONE, Triangle, Vertex};
use crate::predicates::Point2;
use foldhash::HashMap;

/// The mesh of triangles of `points`, see [`super::Region::new`].
pub(super) fn mesh_of(points: &[Point2], triangles: &[[u32; 3]]) -> Mesh {
    let neighbours = neighbours_of(triangles);
    let unknown = |_: &[u32; 3]| [NONE; 3];
    let mut mesh = Mesh { origins: triangles.iter().map(unknown).collect(), ..Mesh::default() };
    for (number, corners) in (0..).zip(triangles) {
        for (place, &point) in corners.iter().enumerate() {
            if mesh.origins[number as usize][place] == NONE {
                let vertex = mesh.vertices.len() as u32;
                mesh.vertices.push(Vertex { place: points[point as usize], point, triangle: number });
                mesh.points.push([point, vertex]);
                name_fan(&mut mesh.origins, triangles, &neighbours, [number, place as u32], vertex);
            }
        }
    }
    mesh.points.sort_unstable();
    let whole = |(&vertices, &neighbours)| Triangle { vertices, neighbours, segments: [NONE; 3] };
    mesh.triangles = mesh.origins.iter().zip(&neighbours).map(whole).collect();
    mesh
}

/// For each triangle the triangles across its sides.
fn neighbours_of(triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut neighbours = vec![[NONE; 3]; triangles.len()];
    let mut open: HashMap<[u32; 2], (u32, usize)> = HashMap::default();
    for (number, corners) in (0..).zip(triangles) {
        for place in 0..3 {
            let [from, to] = [corners[(place + 1) % 3], corners[(place + 2) % 3]];
            match open.remove(&[to, from]) {
                Some((other, other_place)) => {
                    neighbours[number as usize][place] = other;
                    neighbours[other as usize][other_place] = number;
                }
                None => {
                    open.insert([from, to], (number, place));
                }
            }
        }
    }
    neighbours
}

/// Gives the corner `[triangle, place]`, and all that a turn around its point reaches, the name `vertex`.
fn name_fan(
    names: &mut [[u32; 3]],
    triangles: &[[u32; 3]],
    neighbours: &[[u32; 3]],
    [start, place]: [u32; 2],
    vertex: u32,
) {
    let point = triangles[start as usize][place as usize];
    // Counterclockwise, the next triangle is across the side opposite to the next vertex; clockwise, the
    // other.
    for turn in [1, 2] {
        let mut triangle = start;
        loop {
            let corners = triangles[triangle as usize];
            let place = corners.iter().position(|&corner| corner == point).expect("the fan has the point");
            names[triangle as usize][place] = vertex;
            triangle = neighbours[triangle as usize][(place + turn) % 3];
            if triangle == NONE || triangle == start {
                break;
            }
        }
    }
}
