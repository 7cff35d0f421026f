//! Proofs of all promises of the 3D kernel, by code that shares nothing with it.

use spmesh_delaunay::delaunay3::Tetrahedralization;
use spmesh_reference::space::{Claim, Point, Space, distinct};
use spmesh_reference::tetrahedra::as_set;

/// Proves that `mesh` is the canonical tetrahedralization of `points` and keeps all other promises, or says
/// what is wrong.
pub fn prove(points: &[Point], mesh: &Tetrahedralization) -> Result<(), String> {
    let vertices = prove_vertices(points, mesh)?;
    let claims: Vec<Claim> = mesh
        .tetrahedra()
        .iter()
        .map(|tetrahedron| {
            let across = |side| {
                Some(tetrahedron.neighbour(side)?).map(|c| (c.tetrahedron as usize, c.corner as usize))
            };
            (tetrahedron.vertices.map(|v| v as usize), [0, 1, 2, 3].map(across))
        })
        .collect();
    let open = claims.iter().flat_map(|claim| claim.1).filter(Option::is_none).count();
    if open != mesh.hull_facets {
        return Err(format!("{open} facets are open, and hull_facets is {}", mesh.hull_facets));
    }
    Space::new(&vertices).prove(&claims)
}

/// Proves that the vertices are the distinct points, each the first of its equals, and the duplicates all
/// others.
fn prove_vertices(points: &[Point], mesh: &Tetrahedralization) -> Result<Vec<Point>, String> {
    let (_, first) = distinct(points);
    let mut is_vertex = vec![false; points.len()];
    for vertex in mesh.vertices() {
        let index = vertex.index as usize;
        if first.get(index) != Some(&index) || points[index] != vertex.at {
            return Err(format!("vertex {vertex:?} is not the first of its equals"));
        }
        if std::mem::replace(&mut is_vertex[index], true) {
            return Err(format!("point {index} is a vertex twice"));
        }
    }
    let mut duplicates: Vec<[u32; 2]> = mesh.duplicates.clone();
    duplicates.sort_unstable();
    let later = |i: &usize| first[*i] != *i;
    let expected: Vec<[u32; 2]> =
        (0..points.len()).filter(later).map(|i| [i as u32, first[i] as u32]).collect();
    if duplicates != expected {
        return Err(format!("duplicates are {duplicates:?}, not {expected:?}"));
    }
    match (0..points.len()).find(|&i| first[i] == i && !is_vertex[i]) {
        Some(i) => Err(format!("point {i} is no vertex")),
        None => Ok(mesh.vertices().iter().map(|vertex| vertex.at).collect()),
    }
}

/// The tetrahedra with indices of points, as a sorted set.
pub fn tetrahedra(mesh: &Tetrahedralization) -> Vec<[u32; 4]> {
    as_set(mesh.tetrahedra().iter().map(|t| t.vertices.map(|v| mesh.vertices()[v as usize].index)))
}
