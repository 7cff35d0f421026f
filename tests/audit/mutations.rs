//! Correct meshes changed at random: every change of the set of triangles is refused.

use super::reference::{Random, canonical_triangulation};
use super::{Mesh, Verdict};

const SEED: u64 = 20_260_101;

#[test]
fn every_mutation_of_the_set_is_refused() {
    let mut refused = 0;
    for round in 0..400 {
        let mut random = Random::new(SEED + round);
        let (len, side) = (5 + random.below(12), [4, 5, 8, 200][random.below(4)]);
        let points = random.distinct_points(len.min(side * side), side);
        let correct = Mesh::canonical(&points);
        correct.audit_with(&points).unwrap_or_else(|e| panic!("seed {SEED}, round {round}: {e:?}"));
        for _ in 0..25 {
            let mut mesh = correct.clone();
            for _ in 0..=random.below(3) {
                mutate(&mut mesh, &mut random);
            }
            if has_repeated_vertex(&mesh) {
                continue;
            }
            let is_same = triangle_set(&mesh) == triangle_set(&correct) && mesh.points.len() == points.len();
            match mesh.audit_with(&points) {
                Ok(_) => assert!(is_same, "seed {SEED}, round {round}: {mesh:?}"),
                Err(Verdict::Violation(violation)) => {
                    assert!(!is_same, "seed {SEED}, round {round}: {violation:?} of {mesh:?}");
                    refused += 1;
                }
                Err(Verdict::Malformed(message)) => panic!("seed {SEED}, round {round}: {message}"),
            }
        }
    }
    assert!(refused > 8_000, "only {refused} mutations changed anything");
}

/// Without given points, a mesh passes only if it is the canonical triangulation of its own vertices.
#[test]
fn what_passes_is_the_triangulation_of_its_vertices() {
    for round in 0..400 {
        let mut random = Random::new(SEED ^ round);
        let points = random.distinct_points(12, 6);
        let mut mesh = Mesh::canonical(&points);
        for _ in 0..=random.below(2) {
            mutate(&mut mesh, &mut random);
        }
        if !has_repeated_vertex(&mesh) && mesh.audit(spmesh_audit::Standard::Canonical).is_ok() {
            let expected = Mesh { triangles: canonical_triangulation(&mesh.points), ..mesh.clone() };
            assert_eq!(triangle_set(&mesh), triangle_set(&expected), "seed {SEED}, round {round}");
        }
    }
}

fn mutate(mesh: &mut Mesh, random: &mut Random) {
    if mesh.triangles.is_empty() {
        return;
    }
    let (i, j) = (random.below(mesh.triangles.len()), random.below(mesh.triangles.len()));
    let (vertex, corner) = (random.below(mesh.points.len()), random.below(3));
    match random.below(10) {
        0 => drop(mesh.triangles.remove(i)),
        1 => mesh.triangles.push(mesh.triangles[i]),
        2 => mesh.triangles[i].swap(0, 1),
        3 => mesh.triangles[i][corner] = vertex,
        4 => flip(mesh, i, j),
        5 => mesh.points[vertex][corner % 2] += random.below(3) as i32 - 1,
        6 => mesh.triangles.retain(|triangle| !triangle.contains(&vertex)),
        7 => {
            mesh.points.push(mesh.points[vertex]);
            mesh.triangles[i][corner] = mesh.points.len() - 1;
        }
        8 => {
            let twin = mesh.points.len();
            mesh.points.push(mesh.points[vertex]);
            for triangle in mesh.triangles.iter_mut().skip(i) {
                triangle.iter_mut().filter(|v| **v == vertex).for_each(|v| *v = twin);
            }
        }
        _ => mesh.triangles.rotate_left(i),
    }
}

/// Flips the edge that two triangles share, if they share one.
fn flip(mesh: &mut Mesh, i: usize, j: usize) {
    let (one, other) = (mesh.triangles[i], mesh.triangles[j]);
    for side in 0..3 {
        let [a, b, c] = [0, 1, 2].map(|k| one[(side + k) % 3]);
        let shares = (0..3).any(|k| other[k] == b && other[(k + 1) % 3] == a);
        if let Some(&d) = other.iter().find(|v| ![a, b].contains(v)).filter(|_| shares) {
            mesh.triangles[i] = [a, d, c];
            mesh.triangles[j] = [d, b, c];
            return;
        }
    }
}

/// Positions of the corners of every triangle, the smallest first; the triangles are sorted.
fn triangle_set(mesh: &Mesh) -> Vec<[[i32; 2]; 3]> {
    let mut set: Vec<[[i32; 2]; 3]> = mesh
        .triangles
        .iter()
        .map(|triangle| {
            let mut corners = triangle.map(|v| mesh.points[v]);
            let smallest = (0..3).min_by_key(|&k| corners[k]).unwrap();
            corners.rotate_left(smallest);
            corners
        })
        .collect();
    set.sort_unstable();
    set
}

/// Whether a triangle repeats a vertex; neither the writer nor the reader accepts one.
fn has_repeated_vertex(mesh: &Mesh) -> bool {
    mesh.triangles.iter().any(|&[a, b, c]| a == b || b == c || c == a)
}
