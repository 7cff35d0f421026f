//! Correct tetrahedral meshes changed at random: every change of the set of tetrahedra is refused.

use spmesh_audit::{Check, Standard};

use super::Verdict;
use super::reference::Random;
use super::solid::Solid;

const SEED: u64 = 20_260_202;

#[test]
fn every_mutation_of_the_set_is_refused() {
    let (mut refused, mut by_check) = (0, [0; Check::ALL.len()]);
    for round in 0..150 {
        let mut random = Random::new(SEED + round);
        let (len, side) = (5 + random.below(9), [2, 3, 4, 100][random.below(4)]);
        let points = distinct(&mut random, len.min(side * side * side), side);
        let correct = Solid::canonical(&points);
        correct.audit_with(&points).unwrap_or_else(|e| panic!("seed {SEED}, round {round}: {e:?}"));
        for _ in 0..40 {
            let mut mesh = correct.clone();
            for _ in 0..=random.below(3) {
                mutate(&mut mesh, &mut random);
            }
            if has_repeated_vertex(&mesh) {
                continue;
            }
            let is_same = set_of(&mesh) == set_of(&correct) && mesh.points.len() == points.len();
            match mesh.audit_with(&points) {
                Ok(_) => assert!(is_same, "seed {SEED}, round {round}: {mesh:?}"),
                Err(Verdict::Violation(violation)) => {
                    assert!(!is_same, "seed {SEED}, round {round}: {violation:?} of {mesh:?}");
                    by_check[violation.check as usize] += 1;
                    refused += 1;
                }
                Err(Verdict::Malformed(message)) => panic!("seed {SEED}, round {round}: {message}"),
            }
        }
    }
    assert!(refused > 4_000, "only {refused} mutations changed anything");
    for check in
        [Check::Orientation, Check::Facets, Check::Delaunay, Check::Canonical, Check::Vertices, Check::Hull]
    {
        assert!(by_check[check as usize] > 0, "{check:?} found nothing");
    }
}

/// Without given points, a mesh passes only if it is the tetrahedralization of its own vertices.
#[test]
fn what_passes_is_the_tetrahedralization_of_its_vertices() {
    let mut passed = 0;
    for round in 0..200 {
        let mut random = Random::new(SEED ^ round);
        let points = distinct(&mut random, 9, 3);
        let mut mesh = Solid::canonical(&points);
        for _ in 0..=random.below(2) {
            mutate(&mut mesh, &mut random);
        }
        if !has_repeated_vertex(&mesh) && mesh.audit(Standard::Canonical).is_ok() {
            let expected = Solid::canonical(&mesh.points);
            assert_eq!(set_of(&mesh), set_of(&expected), "seed {SEED}, round {round}");
            passed += 1;
        }
    }
    assert!(passed > 10);
}

/// Every set of positive tetrahedra over five or six points: only the canonical one passes. Points may
/// coincide; then no set may pass.
#[test]
fn one_of_all_sets_of_tetrahedra_passes() {
    let mut random = Random::new(SEED);
    for round in 0..40 {
        let (len, side) = (4 + round % 3, 2 + random.below(3));
        let points: Vec<[i32; 3]> = (0..len).map(|_| [0; 3].map(|_| random.below(side) as i32)).collect();
        let positive = positive_tetrahedra(&points);
        let is_distinct = (0..len).all(|i| !points[..i].contains(&points[i]));
        let expected = is_distinct.then(|| set_of(&Solid::canonical(&points)));
        let mut passed = Vec::new();
        for set in 0..1u32 << positive.len() {
            let subset = positive.iter().enumerate().filter(|(i, _)| set >> i & 1 == 1);
            let mesh = Solid::new(&points, &subset.map(|(_, t)| *t).collect::<Vec<_>>());
            if mesh.audit(Standard::Canonical).is_ok() {
                passed.push(set_of(&mesh));
            }
        }
        assert_eq!(passed, Vec::from_iter(expected), "seed {SEED}, round {round}: {points:?}");
    }
}

pub fn distinct(random: &mut Random, len: usize, side: usize) -> Vec<[i32; 3]> {
    let mut points: Vec<[i32; 3]> = Vec::new();
    while points.len() < len {
        let point = [0; 3].map(|_| random.below(side) as i32);
        if !points.contains(&point) {
            points.push(point);
        }
    }
    points
}

pub fn mutate(mesh: &mut Solid, random: &mut Random) {
    if mesh.tetrahedra.is_empty() {
        return;
    }
    let (i, j) = (random.below(mesh.tetrahedra.len()), random.below(mesh.tetrahedra.len()));
    let (vertex, corner) = (random.below(mesh.points.len()), random.below(4));
    match random.below(11) {
        0 => drop(mesh.tetrahedra.remove(i)),
        1 => mesh.tetrahedra.push(mesh.tetrahedra[i]),
        2 => mesh.tetrahedra[i].swap(0, 1),
        3 => mesh.tetrahedra[i][corner] = vertex,
        4 => flip(mesh, i, j),
        5 => mesh.points[vertex][corner % 3] += random.below(3) as i32 - 1,
        6 => mesh.tetrahedra.retain(|tetrahedron| !tetrahedron.contains(&vertex)),
        7 => {
            mesh.points.push(mesh.points[vertex]);
            mesh.tetrahedra[i][corner] = mesh.points.len() - 1;
        }
        8 => {
            let twin = mesh.points.len();
            mesh.points.push(mesh.points[vertex]);
            for tetrahedron in mesh.tetrahedra.iter_mut().skip(i) {
                tetrahedron.iter_mut().filter(|v| **v == vertex).for_each(|v| *v = twin);
            }
        }
        9 => mesh.points.push([0; 3].map(|_| random.below(4) as i32)),
        _ => mesh.tetrahedra.rotate_left(i),
    }
}

/// Replaces two tetrahedra on a facet by three around the edge between their apexes, if they share a facet.
fn flip(mesh: &mut Solid, i: usize, j: usize) {
    let (one, other) = (mesh.tetrahedra[i], mesh.tetrahedra[j]);
    let shared: Vec<usize> = one.into_iter().filter(|v| other.contains(v)).collect();
    if i == j || shared.len() != 3 {
        return;
    }
    let apex = other.into_iter().find(|v| !one.contains(v)).unwrap();
    let replaced: Vec<[usize; 4]> =
        shared.iter().map(|&old| one.map(|v| if v == old { apex } else { v })).collect();
    mesh.tetrahedra = mesh
        .tetrahedra
        .iter()
        .enumerate()
        .filter(|(k, _)| ![i, j].contains(k))
        .map(|(_, t)| *t)
        .chain(replaced)
        .collect();
}

/// Positions of the corners of every tetrahedron, in an order that keeps the orientation, sorted.
fn set_of(mesh: &Solid) -> Vec<[[i32; 3]; 4]> {
    let mut set: Vec<[[i32; 3]; 4]> = mesh
        .tetrahedra
        .iter()
        .map(|tetrahedron| {
            let corners = tetrahedron.map(|v| mesh.points[v]);
            let mut sorted = corners;
            sorted.sort_unstable();
            let is_odd = volume(corners).signum() != volume(sorted).signum();
            if is_odd {
                sorted.swap(2, 3);
            }
            sorted
        })
        .collect();
    set.sort_unstable();
    set
}

pub fn positive_tetrahedra(points: &[[i32; 3]]) -> Vec<[usize; 4]> {
    let mut found = Vec::new();
    for i in 0..points.len().pow(4) {
        let [a, b, c, d] = [0, 1, 2, 3].map(|digit| i / points.len().pow(digit) % points.len());
        let is_first = a < b && b < c.min(d);
        if is_first && volume([a, b, c, d].map(|v| points[v])) > 0 {
            found.push([a, b, c, d]);
        }
    }
    found
}

fn volume([a, b, c, d]: [[i32; 3]; 4]) -> i64 {
    let [u, v, w] = [b, c, d].map(|p| [0, 1, 2].map(|i| i64::from(p[i] - a[i])));
    u[0] * (v[1] * w[2] - v[2] * w[1])
        + u[1] * (v[2] * w[0] - v[0] * w[2])
        + u[2] * (v[0] * w[1] - v[1] * w[0])
}

/// Whether a tetrahedron repeats a vertex; neither the writer nor the reader accepts one.
pub fn has_repeated_vertex(mesh: &Solid) -> bool {
    mesh.tetrahedra.iter().any(|t| (1..4).any(|i| t[..i].contains(&t[i])))
}
