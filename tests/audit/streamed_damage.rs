//! Damaged streams, in the plane and in space: the audit refuses a stream if and only if its mesh is not the
//! canonical triangulation of distinct points, which is found by trying all simplices.

use spmesh_audit::{Check, Report};
use spmesh_stream::Patch;

use super::reference::Random;
use super::solid::cubic;
use super::streamed::{Flat, Solid, Streamed, audit_patches};
use super::tetrahedra_mutations::distinct;
use super::{Mesh, Verdict};

const SEED: u64 = 20_261_122;

/// A way to damage a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Damage {
    LeftOut,
    Doubled,
    Reversed,
    OtherCorner,
    Flipped,
    Moved,
    Coincident,
    Split,
    Glued,
    Stray,
    StarLeftOut,
    TwoSheets,
    TwoSheetsAtOneVertex,
    OtherOrder,
}

const DAMAGES: [Damage; 14] = [
    Damage::LeftOut,
    Damage::Doubled,
    Damage::Reversed,
    Damage::OtherCorner,
    Damage::Flipped,
    Damage::Moved,
    Damage::Coincident,
    Damage::Split,
    Damage::Glued,
    Damage::Stray,
    Damage::StarLeftOut,
    Damage::TwoSheets,
    Damage::TwoSheetsAtOneVertex,
    Damage::OtherOrder,
];

#[test]
fn damage_to_triangles_is_found() {
    refuses_what_is_wrong::<2, 3>(120, |random| {
        let (len, side) = (4 + random.below(9), [3, 4, 6, 100][random.below(4)]);
        random.distinct_points(len.min(side * side), side)
    });
}

#[test]
fn damage_to_tetrahedra_is_found() {
    refuses_what_is_wrong::<3, 4>(50, |random| {
        let (len, side) = (5 + random.below(6), [2, 3, 5, 100][random.below(4)]);
        distinct(random, len.min(side * side * side), side)
    });
}

/// Applies every kind of damage, sometimes followed by a second one, to sets of points from `choose`.
fn refuses_what_is_wrong<const D: usize, const N: usize>(
    rounds: u64,
    choose: impl Fn(&mut Random) -> Vec<[i32; D]>,
) {
    let mut refused = [0; DAMAGES.len()];
    for round in 0..rounds {
        let mut random = Random::new(SEED + round);
        let mut correct = Streamed::<D, N>::canonical(&choose(&mut random));
        correct.patch_len = 1 + random.below(4);
        correct.audit().unwrap_or_else(|e| panic!("seed {SEED}, round {round}: {e:?} of {correct:?}"));
        for (i, &first) in DAMAGES.iter().enumerate() {
            let mut mesh = correct.clone();
            damage(&mut mesh, first, &mut random);
            for _ in 0..random.below(2) {
                damage(&mut mesh, DAMAGES[random.below(DAMAGES.len())], &mut random);
            }
            if has_repeated_corner(&mesh) {
                continue;
            }
            let verdict = mesh.audit();
            assert!(!matches!(verdict, Err(Verdict::Malformed(_))), "{verdict:?}");
            assert_eq!(
                verdict.is_ok(),
                is_canonical(&mesh),
                "seed {SEED}, round {round}: {verdict:?} of {mesh:?}"
            );
            refused[i] += u64::from(verdict.is_err());
        }
    }
    for (found, kind) in refused.into_iter().zip(DAMAGES) {
        assert!(found > rounds / 10, "{kind:?} was refused {found} times only");
    }
}

fn is_canonical<const D: usize, const N: usize>(mesh: &Streamed<D, N>) -> bool {
    let points = &mesh.points;
    let is_distinct = (0..points.len()).all(|i| !points[..i].contains(&points[i]));
    is_distinct && mesh.set() == Streamed::<D, N>::canonical(points).set()
}

/// Whether a simplex repeats a corner; neither the writer nor the reader accepts one.
fn has_repeated_corner<const D: usize, const N: usize>(mesh: &Streamed<D, N>) -> bool {
    mesh.simplices.iter().any(|simplex| (1..N).any(|i| simplex[..i].contains(&simplex[i])))
}

fn damage<const D: usize, const N: usize>(mesh: &mut Streamed<D, N>, damage: Damage, random: &mut Random) {
    if mesh.simplices.is_empty() {
        return;
    }
    let (simplex, corner) = (random.below(mesh.simplices.len()), random.below(N));
    let (one, other) = (random.below(mesh.points.len()), random.below(mesh.points.len()));
    let replace = |mesh: &mut Streamed<D, N>, from: usize, old: usize, new: usize| {
        mesh.simplices[from..].as_flattened_mut().iter_mut().filter(|v| **v == old).for_each(|v| *v = new);
    };
    match damage {
        Damage::LeftOut => drop(mesh.simplices.remove(simplex)),
        Damage::Doubled => mesh.simplices.insert(random.below(simplex + 1), mesh.simplices[simplex]),
        Damage::Reversed => mesh.simplices[simplex].swap(0, 1),
        Damage::OtherCorner => mesh.simplices[simplex][corner] = one,
        Damage::Flipped => flip(mesh, simplex),
        Damage::Moved => mesh.points[one][corner % D] += [-2, -1, 1, 2][random.below(4)],
        Damage::Coincident => mesh.points[one] = mesh.points[other],
        Damage::Split => {
            mesh.points.push(mesh.points[one]);
            let new = mesh.points.len() - 1;
            replace(mesh, simplex, one, new);
        }
        Damage::Glued => replace(mesh, 0, one, other),
        Damage::Stray => mesh.points.push([0; D].map(|_| random.below(8) as i32)),
        Damage::StarLeftOut => mesh.simplices.retain(|simplex| !simplex.contains(&one)),
        Damage::TwoSheets | Damage::TwoSheetsAtOneVertex => {
            let len = mesh.points.len();
            mesh.points.extend_from_within(..);
            let sheet: Vec<[usize; N]> =
                mesh.simplices.iter().map(|s| s.map(|vertex| vertex + len)).collect();
            mesh.simplices.extend(sheet);
            if damage == Damage::TwoSheetsAtOneVertex {
                replace(mesh, 0, one + len, one);
                replace(mesh, 0, 2 * len - 1, one + len);
                mesh.points.swap_remove(one + len);
            }
        }
        Damage::OtherOrder => {
            mesh.simplices.rotate_left(simplex);
            mesh.simplices[0].rotate_left(2 * (N % 2));
        }
    }
}

/// Replaces two simplices with a common facet by the simplices around the edge between their apexes: flips an
/// edge, or makes three tetrahedra of two.
fn flip<const D: usize, const N: usize>(mesh: &mut Streamed<D, N>, i: usize) {
    let one = mesh.simplices[i];
    let is_next = |other: &[usize; N]| other.iter().filter(|vertex| one.contains(vertex)).count() == D;
    let Some(j) = mesh.simplices.iter().position(is_next) else { return };
    let apex = mesh.simplices[j].into_iter().find(|vertex| !one.contains(vertex)).unwrap();
    let shared = one.into_iter().filter(|vertex| mesh.simplices[j].contains(vertex));
    let flipped: Vec<[usize; N]> =
        shared.map(|old| one.map(|vertex| if vertex == old { apex } else { vertex })).collect();
    mesh.simplices.remove(i.max(j));
    mesh.simplices.remove(i.min(j));
    mesh.simplices.extend(flipped);
}

#[test]
fn sets_that_are_degenerate_pass() {
    let grid = |side: i32| (0..side * side).map(|i| [i % side, i / side]).collect::<Vec<_>>();
    let circle = [[5, 0], [4, 3], [3, 4], [0, 5], [-3, 4], [-4, 3], [-5, 0], [-4, -3], [0, -5], [3, -4]];
    let mut sets = vec![grid(2), grid(5), circle.to_vec()];
    sets.extend((0..=5).map(|len| (0..len).map(|i| [i * 3, -2 * i]).collect()));
    sets.extend((3..=5).map(|len| circle[..len].to_vec()));
    for points in sets {
        for patch_len in [1, 3] {
            Flat { patch_len, ..Streamed::canonical(&points) }.audit().unwrap();
        }
    }
    let is_on_sphere = |point: &[i32; 3]| point.iter().map(|c| c * c).sum::<i32>() == 9;
    let sphere: Vec<[i32; 3]> = cubic(7).iter().map(|p| p.map(|c| c - 3)).filter(is_on_sphere).collect();
    let plane: Vec<[i32; 3]> = grid(3).iter().map(|&[x, y]| [x, y, x + 2 * y]).collect();
    let tent = [&plane[..], &[[1, 1, 9]]].concat();
    let mut sets = vec![cubic(2), cubic(3), sphere, tent, plane.clone()];
    sets.extend((0..=5).map(|len| (0..len).map(|i| [i, 2 * i, -i]).collect()));
    sets.extend((3..=5).map(|len| plane[..len].to_vec()));
    for points in sets {
        for patch_len in [1, 4] {
            Solid { patch_len, ..Streamed::canonical(&points) }.audit().unwrap();
        }
    }
}

/// Duplicates of the input are counted as merged; a duplicate that is a vertex of its own is refused.
#[test]
fn duplicates_are_no_vertices() {
    for points in [vec![[0, 0], [9, 3], [3, 1]], vec![[0, 0], [9, 3], [3, 2], [4, 7]]] {
        let mut mesh = Mesh::canonical(&points);
        mesh.merged = 2;
        mesh.audit(spmesh_audit::Standard::Canonical).unwrap();
        mesh.points.push(points[1]);
        assert_eq!(check_of(mesh.audit(spmesh_audit::Standard::Canonical)), Check::Vertices);
    }
}

#[test]
fn a_vertex_that_is_finalized_too_early_or_never_is_found() {
    let flat = Flat::canonical(&Random::new(SEED).distinct_points(14, 9));
    finalizations_are_checked::<2>(&flat.patches());
    let points = distinct(&mut Random::new(SEED), 10, 5);
    finalizations_are_checked::<3>(&Solid::canonical(&points).patches());
}

/// Finalizes each vertex of several patches too early, once for each patch that keeps it; then leaves out
/// each finalization in turn.
fn finalizations_are_checked<const D: usize>(patches: &[Patch]) {
    audit_patches::<D>(patches).unwrap();
    let (mut early, mut never) = (0, 0);
    for (i, patch) in patches.iter().enumerate() {
        let locals = 0..patch.vertices() as u32;
        for local in locals.filter(|local| !patch.finalized.contains(local)) {
            let mut damaged = patches.to_vec();
            let finalized = &mut damaged[i].finalized;
            finalized.push(local);
            finalized.sort_unstable();
            let id = patch.id(local);
            for later in &mut damaged[i + 1..] {
                let ids: Vec<u64> = (0..later.vertices() as u32).map(|local| later.id(local)).collect();
                later.finalized.retain(|&local| ids[local as usize] != id);
            }
            // Either the star of the vertex is incomplete when it is finalized, or it looks like a vertex on
            // the hull and a later patch uses it.
            let check = check_of(audit_patches::<D>(&damaged));
            assert!([Check::Finalization, Check::Vertices].contains(&check), "{check:?}");
            early += 1;
        }
        for k in 0..patch.finalized.len() {
            let mut damaged = patches.to_vec();
            damaged[i].finalized.remove(k);
            assert!(matches!(audit_patches::<D>(&damaged), Err(Verdict::Malformed(_))));
            never += 1;
        }
    }
    assert!(early > 5 && never > 5, "{early} too early, {never} never");
}

/// Keeping all vertices until the end is valid, though it wastes memory.
#[test]
fn vertices_may_be_finalized_late() {
    let mut patches = Solid::canonical(&distinct(&mut Random::new(SEED), 10, 5)).patches();
    patches.iter_mut().for_each(|patch| patch.finalized.clear());
    let first_id: u64 = patches.iter().map(|patch| patch.new.len() as u64).sum();
    let (imported, finalized) = ((0..first_id).collect(), (0..first_id as u32).collect());
    patches.push(Patch { first_id, imported, finalized, ..Patch::default() });
    assert_eq!(audit_patches::<3>(&patches).unwrap().live_max as u64, first_id);
}

fn check_of(verdict: Result<Report, Verdict>) -> Check {
    match verdict {
        Err(Verdict::Violation(violation)) => violation.check,
        other => panic!("expected a violation, found {other:?}"),
    }
}
