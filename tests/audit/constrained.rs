//! The audit passes constrained meshes that were made by brute force, and refuses every fault that is
//! planted.

use std::collections::{BTreeMap, BTreeSet};

use super::constrained_mesh::{ConstrainedMesh, Place, are_apart, turn};
use super::reference::Random;

/// Random points and segments between them, some of them through other points or out of the hull.
fn random_mesh(random: &mut Random) -> ConstrainedMesh {
    let side = [4, 6, 30][random.below(3)];
    let count = 4 + random.below(9);
    let points = random.distinct_points(count, side);
    let mut segments: Vec<[Place; 2]> = Vec::new();
    let is_hull = |p: Place, q: Place| points.iter().all(|&r| turn(p, q, r) >= 0);
    for _ in 0..random.below(8) {
        let (i, j) = (random.below(points.len()), random.below(points.len()));
        let [p, mut q] = [points[i], points[j]];
        let is_corner = points.iter().any(|&r| r != q && is_hull(q, r));
        if p == q
            || is_corner && random.below(3) == 0 && {
                // Beyond a corner of the hull, if that leaves the hull.
                let beyond = [2 * q[0] - p[0], 2 * q[1] - p[1]];
                let leaves = points.iter().any(|&r| r != q && is_hull(q, r) && turn(q, r, beyond) < 0)
                    || points.iter().any(|&r| r != q && is_hull(r, q) && turn(r, q, beyond) < 0);
                q = if leaves { beyond } else { q };
                false
            }
        {
            continue;
        }
        if segments.iter().all(|&other| are_apart(&points, [p, q], other)) {
            segments.push([p, q]);
        }
    }
    ConstrainedMesh::new(points, segments)
}

#[test]
fn constrained_meshes_pass() {
    let (mut segments, mut open, mut cut) = (0, 0, 0);
    for seed in 0..600 {
        let mut random = Random::new(seed);
        let mesh = random_mesh(&mut random);
        if mesh.triangles.is_empty() {
            continue;
        }
        (segments, open) = (segments + mesh.segments.len(), open + mesh.open.len());
        let patch_len = 1 + random.below(4);
        mesh.verdict(patch_len).unwrap_or_else(|e| panic!("seed {seed}: {e}\n{mesh:?}"));
        let kill = 1.0 + random.below(8) as f64;
        for kill in [Some(kill), None] {
            let less = mesh.clone().cut(kill);
            if !less.triangles.is_empty() {
                cut += usize::from(less.triangles.len() < mesh.triangles.len());
                less.verdict(patch_len)
                    .unwrap_or_else(|e| panic!("seed {seed}, cut {kill:?}: {e}\n{less:?}"));
            }
        }
    }
    assert!(segments > 1000 && open > 30 && cut > 100, "{segments} segments, {open} open, {cut} cut");
}

#[test]
fn what_passes_is_the_constrained_triangulation() {
    let (mut refused, mut passed) = (0, 0);
    for seed in 0..500 {
        let mut random = Random::new(seed);
        let right = random_mesh(&mut random);
        if right.triangles.len() < 2 {
            continue;
        }
        for _ in 0..20 {
            let mut mesh = right.clone();
            (0..=random.below(2)).for_each(|_| mutate(&mut mesh, &mut random));
            let same = |m: &ConstrainedMesh| {
                let mut sides: Vec<_> = m
                    .sides
                    .iter()
                    .map(|(&[t, place], &s)| ([1, 2].map(|k| m.triangles[t][(place + k) % 3]), s))
                    .collect();
                sides.sort_unstable();
                let mut triangles: Vec<_> = m
                    .triangles
                    .iter()
                    .map(|t| {
                        let mut t = *t;
                        t.sort_unstable();
                        t
                    })
                    .collect();
                triangles.sort_unstable();
                (triangles, sides, m.open.clone())
            };
            match mesh.verdict(1 + random.below(3)) {
                // The audit does not prove what becomes of segments that leave the mesh.
                Ok(()) if !right.open.is_empty() => (),
                Ok(()) => {
                    assert_eq!(same(&mesh), same(&right), "seed {seed}");
                    passed += 1;
                }
                Err(message) => {
                    assert_ne!(same(&mesh), same(&right), "seed {seed}: {message}");
                    refused += 1;
                }
            }
        }
    }
    assert!(refused > 3000 && passed > 20, "{refused} refused, {passed} passed");
}

/// Changes the mesh, not its points and segments.
fn mutate(mesh: &mut ConstrainedMesh, random: &mut Random) {
    let (t, place) = (random.below(mesh.triangles.len()), random.below(3));
    let some_side = mesh.sides.keys().nth(random.below(mesh.sides.len().max(1))).copied();
    match (random.below(8), some_side) {
        (0, _) => flip(mesh, t, place),
        (1, Some([t, place])) => flip(mesh, t, place),
        (2, Some(side)) => {
            mesh.sides.remove(&side);
        }
        (3, Some(side)) => {
            let other = random.below(mesh.segments.len()) as u32;
            mesh.sides.insert(side, other);
        }
        (4, Some(_)) => drop(mesh.sides.insert([t, place], random.below(mesh.segments.len()) as u32)),
        (5, Some([t, place])) => {
            // On both sides.
            let [a, b] = [1, 2].map(|k| mesh.triangles[t][(place + k) % 3]);
            let triangles = mesh.triangles.clone();
            mesh.sides.retain(|&[t, place], _| {
                let ends = [1, 2].map(|k| triangles[t][(place + k) % 3]);
                ends != [a, b] && ends != [b, a]
            });
        }
        (6, _) if !mesh.segments.is_empty() => {
            let number = random.below(mesh.segments.len()) as u32;
            if !mesh.open.remove(&number) {
                mesh.open.insert(number);
            }
        }
        (_, Some(side)) => {
            let segment = mesh.sides[&side];
            mesh.sides.retain(|_, other| *other != segment);
        }
        _ => flip(mesh, t, place),
    }
}

/// Flips the edge opposite to a corner, if that leaves counterclockwise triangles.
fn flip(mesh: &mut ConstrainedMesh, t: usize, place: usize) {
    let [c, a, b] = [0, 1, 2].map(|k| mesh.triangles[t][(place + k) % 3]);
    let has_twin = |other: &[usize; 3]| (0..3).any(|k| other[k] == b && other[(k + 1) % 3] == a);
    let Some(other) = mesh.triangles.iter().position(has_twin) else { return };
    let d = *mesh.triangles[other].iter().find(|v| ![a, b].contains(v)).unwrap();
    let [pa, pb, pc, pd] = [a, b, c, d].map(|v| mesh.points[v]);
    if turn(pa, pd, pc) <= 0 || turn(pd, pb, pc) <= 0 {
        return;
    }
    let stated: BTreeMap<[usize; 2], u32> = [t, other]
        .iter()
        .flat_map(|&t| (0..3).map(move |place| [t, place]))
        .filter_map(|side| {
            let ends = [1, 2].map(|k| mesh.triangles[side[0]][(side[1] + k) % 3]);
            Some((ends, mesh.sides.remove(&side)?))
        })
        .collect();
    (mesh.triangles[t], mesh.triangles[other]) = ([a, d, c], [d, b, c]);
    for t in [t, other] {
        for place in 0..3 {
            let ends = [1, 2].map(|k| mesh.triangles[t][(place + k) % 3]);
            if let Some(&segment) = stated.get(&ends) {
                mesh.sides.insert([t, place], segment);
            }
        }
    }
}

/// A square of two triangles whose diagonal is on a segment, although it is not the canonical one.
fn square() -> ConstrainedMesh {
    let points = vec![[0, 0], [4, 0], [0, 4], [4, 4], [2, 9]];
    let segments = vec![[[0, 0], [4, 4]], [[4, 4], [0, 4]]];
    ConstrainedMesh::new(points, segments)
}

fn refusal(change: impl FnOnce(&mut ConstrainedMesh)) -> String {
    let mut mesh = square();
    mesh.verdict(1).unwrap();
    change(&mut mesh);
    mesh.verdict(1).expect_err("a fault")
}

#[test]
fn faults_are_named() {
    let mesh = square();
    let side = *mesh.sides.iter().find(|&(_, &segment)| segment == 0).unwrap().0;
    let message = refusal(|mesh| {
        mesh.sides.remove(&side);
    });
    assert!(message.contains("is on") && message.contains("for one of its triangles"), "{message}");
    let message = refusal(|mesh| mesh.segments[0][1] = [4, 3]);
    assert!(message.contains("is not on segment 0"), "{message}");
    let message = refusal(|mesh| mesh.segments[0][0] = [-1, -1]);
    assert!(message.contains("edges do not cover segment 0: a chain of them ends at vertex"), "{message}");
    let message = refusal(|mesh| {
        mesh.open.insert(0);
    });
    assert!(message.contains("segment 0 is open, but edges cover it"), "{message}");
    let message = refusal(|mesh| mesh.segments.push([[4, 0], [0, 4]]));
    assert!(message.contains("edges do not cover segment 2"), "{message}");
    let message = refusal(|mesh| {
        mesh.segments.push([[4, 0], [0, 4]]);
        mesh.open.insert(2);
    });
    assert!(message.contains("segment 2 is open, but does not leave the convex hull"), "{message}");
    let message = refusal(|mesh| flip(mesh, side[0], side[1]));
    assert!(message.contains("edges do not cover segment 0"), "{message}");
}

#[test]
fn borders_are_those_that_cutting_leaves() {
    // A long thin triangle at the bottom of a square.
    let points = vec![[0, 0], [100, 0], [50, 1], [0, 100], [100, 100]];
    let mesh = ConstrainedMesh::new(points, vec![[[0, 0], [0, 100]]]);
    let cut = mesh.clone().cut(Some(60.0));
    assert!(cut.triangles.is_empty() || cut.verdict(2).is_ok());
    let too_long = ConstrainedMesh { is_cut: true, kill: 60.0, ..mesh.clone() };
    assert!(too_long.verdict(2).unwrap_err().contains("longer than 60"));
    // A notch in the hull, without a segment or a kill length.
    let mut notched = ConstrainedMesh { is_cut: true, ..mesh.clone() };
    notched.verdict(1).unwrap();
    notched.triangles.retain(|triangle| !(triangle.contains(&0) && triangle.contains(&1)));
    notched.state();
    assert!(notched.verdict(1).unwrap_err().contains("neither on a segment nor on the hull"));
    notched.kill = 200.0;
    notched.verdict(1).unwrap();
    notched.is_cut = false;
    notched.kill = 0.0;
    assert!(notched.verdict(1).unwrap_err().starts_with("hull"));
}

/// Where a ring leaves the mesh, triangles that it divides stay, and others go.
#[test]
fn borders_at_open_segments_are_those_of_triangles_that_they_divide() {
    let points = vec![[0, 0], [100, 0], [50, 1], [0, 100], [100, 100]];
    let of = |segment: [Place; 2], gone: [usize; 2]| {
        let mut mesh = ConstrainedMesh::new(points.clone(), vec![segment]);
        assert_eq!(mesh.open, BTreeSet::from([0]));
        mesh.is_cut = true;
        mesh.triangles.retain(|triangle| !gone.iter().all(|corner| triangle.contains(corner)));
        assert_eq!(mesh.triangles.len(), 3);
        mesh.state();
        mesh.verdict(1)
    };
    // Through all but the triangle at the bottom, at its apex, and beside it; through the apex alone.
    of([[-10, 2], [110, 2]], [0, 1]).unwrap();
    assert!(of([[-10, 50], [110, 60]], [0, 1]).is_ok());
    for segment in [[[-10, 90], [60, 200]], [[20, -5], [30, -1]], [[-10, 30], [20, 60]]] {
        let message = of(segment, [0, 1]).unwrap_err();
        assert!(message.contains("neither on a segment nor on the hull"), "{message}");
    }
}

/// Two triangles that overlap although every edge is used once.
#[test]
fn overlapping_parts_of_a_cut_mesh_are_found() {
    let mesh = |points: Vec<Place>| ConstrainedMesh {
        triangles: vec![[0, 1, 2], [3, 4, 5]],
        points,
        segments: Vec::new(),
        sides: BTreeMap::new(),
        open: BTreeSet::new(),
        is_cut: true,
        kill: 100.0,
    };
    let first = [[0, 0], [9, 0], [0, 9]];
    mesh([first, [[10, 0], [10, 9], [1, 9]]].concat()).verdict(1).unwrap();
    for second in [[[1, 1], [3, 1], [1, 3]], [[4, 1], [12, 9], [3, 9]], [[-3, -3], [30, -3], [-3, 30]]] {
        let message = mesh([first, second].concat()).verdict(1).unwrap_err();
        assert!(message.starts_with("border"), "{message}");
    }
    for (second, fault) in [
        ([[0, 9], [9, 0], [9, 9]], "coincide"),
        ([[4, 5], [9, 9], [1, 9]], "is on the edge"),
        ([[9, 0], [12, 3], [9, 3]], "coincide"),
    ] {
        let message = mesh([first, second].concat()).verdict(1).unwrap_err();
        assert!(message.contains(fault), "{message}");
    }
}
