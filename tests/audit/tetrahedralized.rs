//! The kernel's tetrahedralizations of every kind of point set pass the audit, and the verdict does not
//! depend on the order of the patches.

use std::borrow::Cow;

use spmesh_audit::Standard;
use spmesh_delaunay::delaunay3::{Kernel, Tetrahedralization};

use super::reference::Random;
use super::solid::{Solid, cubic, position};
use super::tetrahedra_mutations::distinct;

const SEED: u64 = 77;

fn tetrahedralized(points: &[[i32; 3]]) -> Solid {
    let mut mesh = Tetrahedralization::default();
    let given = points.iter().map(position).collect();
    Kernel::new().triangulate(Cow::Owned(given), &mut mesh).unwrap();
    let vertices: Vec<[i32; 3]> = mesh.vertices().iter().map(|v| points[v.index as usize]).collect();
    let tetrahedra: Vec<[usize; 4]> =
        mesh.tetrahedra().iter().map(|t| t.vertices.map(|v| v as usize)).collect();
    Solid { patch_len: 100, merged: mesh.duplicates.len() as u64, ..Solid::new(&vertices, &tetrahedra) }
}

fn sets() -> Vec<(&'static str, Vec<[i32; 3]>)> {
    let mut random = Random::new(SEED);
    let mut any = |len: usize, side: usize| distinct(&mut random, len, side);
    let face_centred =
        (0..512).map(|i| [i % 8, i / 8 % 8, i / 64]).filter(|p| p.iter().sum::<i32>() % 2 == 0);
    let near_a_plane = any(400, 50_000).into_iter().map(|[x, y, z]| [x, y, z / 30_000]);
    let two_lines = (0..60).map(|t| if t % 2 == 0 { [t * t, 0, 0] } else { [7, 3000 - 40 * t, 900] });
    let sphere =
        any(3_000, 19).into_iter().filter(|p| p.iter().map(|c| (c - 9) * (c - 9)).sum::<i32>() == 81);
    let twice = any(200, 12).into_iter().flat_map(|p| [p, p]);
    vec![
        ("uniform", any(1_500, 1 << 30)),
        ("small integers", any(1_000, 16)),
        ("cubic lattice", cubic(9)),
        ("face-centred lattice", face_centred.collect()),
        ("near a plane", near_a_plane.collect()),
        ("two lines", two_lines.collect()),
        ("sphere", sphere.collect()),
        ("duplicates", twice.collect()),
        ("plane", any(300, 40).into_iter().map(|[x, y, _]| [x, y, x + y]).collect()),
        ("line", (0..50).map(|t| [3 * t, -t, 2 * t]).collect()),
        (
            "tip over a plane",
            cubic(8)
                .into_iter()
                .map(|[x, y, z]| [x, y, z / 7])
                .filter(|p| p[2] == 0 || p[0] == p[1])
                .collect(),
        ),
    ]
}

#[test]
fn what_the_kernel_makes_passes() {
    for (name, points) in sets() {
        let mesh = tetrahedralized(&points);
        mesh.audit_with(&points).unwrap_or_else(|verdict| panic!("{name}: {verdict:?}"));
    }
}

#[test]
fn the_order_of_tetrahedra_does_not_matter() {
    let mut random = Random::new(SEED);
    for (name, points) in sets() {
        let mut mesh = tetrahedralized(&points);
        for i in (1..mesh.tetrahedra.len()).rev() {
            mesh.tetrahedra.swap(i, random.below(i + 1));
        }
        mesh.audit(Standard::Canonical).unwrap_or_else(|verdict| panic!("{name}: {verdict:?}"));
        if let Some(lost) = mesh.tetrahedra.pop() {
            assert!(mesh.audit(Standard::Delaunay).is_err(), "{name} without {lost:?}");
        }
    }
}
