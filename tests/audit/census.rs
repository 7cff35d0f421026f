//! Faults of tetrahedral meshes are counted: the counts are compared with counts by hand and with the verdict
//! of the audit.

use num_bigint::BigInt;
use serde_json::Value;
use spmesh_audit::{Census, Counts, Faults, Standard};
use spmesh_stream::StreamReader;

use super::reference::Random;
use super::solid::{Solid, cubic, position};
use super::tetrahedra_mutations::{distinct, has_repeated_vertex, mutate, positive_tetrahedra};
use spmesh_reference::exact3::{insphere, orientation};
use spmesh_reference::tetrahedra::exact_points;

const SEED: u64 = 31;

fn census(mesh: &Solid) -> Counts {
    let stream = mesh.stream();
    let mut reader = StreamReader::new(&stream[..], "test").unwrap();
    let mut census = Census::new();
    while let Some(event) = reader.next_event().unwrap() {
        census.event(&event).unwrap();
    }
    *census.counts()
}

/// Whether the counts call the mesh correct, without Euler's relation, which follows from the other counts.
fn is_clean_but_for_euler(counts: &Counts) -> bool {
    Counts { euler: 1, ..*counts }.is_clean(Standard::Canonical)
}

#[test]
fn correct_meshes_are_clean() {
    for side in [2, 3] {
        let mesh = Solid::canonical(&cubic(side));
        let counts = census(&mesh);
        assert!(counts.is_clean(Standard::Canonical));
        assert_eq!(counts.vertices, (side * side * side) as u64);
        assert_eq!(counts.tetrahedra, mesh.tetrahedra.len() as u64);
        assert_eq!(counts.boundary_facets, 12 * ((side - 1) * (side - 1)) as u64);
        assert_eq!(2 * counts.interior_facets + counts.boundary_facets, 4 * counts.tetrahedra);
        assert_eq!((counts.euler, counts.exact), (1, counts.float));
        let on = counts.tetrahedra;
        assert_eq!(counts.exact, Faults { on, ..Faults::default() }, "all of it is ties");
    }
    assert!(census(&Solid::new(&[], &[])).is_clean(Standard::Canonical));
    assert!(census(&Solid::new(&[[0; 3], [1; 3], [5; 3], [0, 1, 7]], &[])).is_clean(Standard::Canonical));
    assert!(!census(&Solid::new(&cubic(2), &[])).is_clean(Standard::Canonical));
}

#[test]
fn each_fault_is_counted() {
    let tent = [[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9], [5, 5, 5], [4, 4, 0]];
    let counts = |tetrahedra: &[[usize; 4]]| census(&Solid::new(&tent, tetrahedra));
    let inverted = counts(&[[0, 1, 3, 2]]);
    assert_eq!((inverted.exact.inverted, inverted.exact.flat, inverted.unused), (1, 0, 2));
    assert_eq!(inverted.exact.concave, 6);
    let flat = counts(&[[0, 1, 2, 5]]);
    assert_eq!((flat.exact.inverted, flat.exact.flat, flat.exact.inside), (0, 1, 0));
    assert!(!flat.is_hull_proved);
    // A second, a third and a fourth tetrahedron use the facet 1, 2, 3 on its right side.
    let crowded = counts(&[[0, 1, 2, 3], [1, 2, 3, 4], [0, 1, 2, 3], [5, 1, 2, 3]]);
    assert_eq!(crowded.crowded_facets, 3 + 1 + 1);
    let torn = counts(&[[0, 1, 2, 3], [0, 1, 5, 3]]);
    assert_eq!((torn.crowded_facets, torn.torn_edges), (1, 3), "both are on one side of the facet 0, 1, 3");
    assert!(!torn.is_clean(Standard::Delaunay));
}

#[test]
fn wrong_ties_are_a_matter_of_the_standard() {
    let mirrored: Vec<[usize; 4]> = Solid::canonical(&cubic(2))
        .tetrahedra
        .iter()
        .map(|&[a, b, c, d]| [a ^ 1, c ^ 1, b ^ 1, d ^ 1])
        .collect();
    let counts = census(&Solid::new(&cubic(2), &mirrored));
    assert!(counts.not_canonical > 0);
    assert!(counts.is_clean(Standard::Delaunay) && !counts.is_clean(Standard::Canonical));
}

/// For any mesh: the census does not panic, its counts are those found by trying all pairs of tetrahedra, and
/// a mesh is clean if and only if the audit passes it. The census does not check links of vertices; the
/// agreement shows that its other counts imply them.
#[test]
fn counts_agree_with_all_pairs_and_with_the_audit() {
    let (mut clean, mut wrong) = (0, 0);
    for round in 0..150 {
        let mut random = Random::new(SEED + round);
        let (len, side) = (5 + random.below(7), [2, 3, 50][random.below(3)]);
        let points = distinct(&mut random, len.min(side * side * side), side);
        let correct = Solid::canonical(&points);
        for _ in 0..20 {
            let mut mesh = correct.clone();
            for _ in 0..random.below(4) {
                mutate(&mut mesh, &mut random);
            }
            if has_repeated_vertex(&mesh) {
                continue;
            }
            let counts = census(&mesh);
            let passes = mesh.audit(Standard::Canonical).is_ok();
            assert_eq!(is_clean_but_for_euler(&counts), passes, "seed {SEED}, round {round}: {mesh:?}");
            assert_eq!(counts.is_clean(Standard::Canonical), passes);
            if counts.crowded_facets == 0 {
                let expected = faults_of(&mesh);
                let concave = counts.exact.concave;
                assert_eq!(
                    counts.exact,
                    Faults { concave, ..expected },
                    "seed {SEED}, round {round}: {mesh:?}"
                );
                assert_eq!(counts.float, counts.exact, "small integers are not rounded");
            }
            *(if passes { &mut clean } else { &mut wrong }) += 1;
        }
    }
    assert!(clean > 300 && wrong > 1_500, "{clean} clean, {wrong} wrong");
}

/// Every set of tetrahedra over a few points is clean if and only if the audit passes it.
#[test]
fn one_of_all_sets_of_tetrahedra_is_clean() {
    let mut random = Random::new(SEED);
    for round in 0..20 {
        let (len, side) = (4 + round % 3, 2 + random.below(2));
        let points: Vec<[i32; 3]> = (0..len).map(|_| [0; 3].map(|_| random.below(side) as i32)).collect();
        let positive = positive_tetrahedra(&points);
        for set in 0..1u32 << positive.len() {
            let subset = positive.iter().enumerate().filter(|(i, _)| set >> i & 1 == 1);
            let mesh = Solid::new(&points, &subset.map(|(_, t)| *t).collect::<Vec<_>>());
            let counts = census(&mesh);
            let passes = mesh.audit(Standard::Canonical).is_ok();
            assert_eq!(is_clean_but_for_euler(&counts), passes, "seed {SEED}, round {round}: {mesh:?}");
        }
    }
}

/// The faults found by trying all pairs of tetrahedra.
fn faults_of(mesh: &Solid) -> Faults {
    let exact = exact_points(&mesh.points.iter().map(position).collect::<Vec<_>>());
    let at = |v: usize| &exact[v];
    let turn = |t: &[usize; 4]| orientation(t.map(at));
    let mut faults = Faults::default();
    for one in &mesh.tetrahedra {
        let side = turn(one);
        faults.inverted += u64::from(side < 0);
        faults.flat += u64::from(side == 0);
        if side == 0 {
            continue;
        }
        let [a, b, c, d] = if side > 0 { *one } else { [one[1], one[0], one[2], one[3]] };
        let places = mesh.tetrahedra.iter().filter_map(|other| {
            let apex = beyond(one, other)?;
            Some(insphere([at(a), at(b), at(c), at(d), at(apex)]))
        });
        let nearest = places.max().unwrap_or(-1);
        faults.inside += u64::from(nearest > 0);
        faults.on += u64::from(nearest == 0);
    }
    faults
}

/// The apex of `other`, if both tetrahedra have a facet in opposite directions: if replacing the apex of
/// `one` by a new vertex, and ordering the result like `other` with its apex replaced, takes an odd
/// permutation.
fn beyond(one: &[usize; 4], other: &[usize; 4]) -> Option<usize> {
    let shared: Vec<usize> = one.iter().copied().filter(|v| other.contains(v)).collect();
    let [p, q, r] = shared[..] else {
        return (shared.len() == 4 && one != other && parity(one) != parity(other)).then(|| other[0]);
    };
    let apex = other.iter().copied().find(|v| !shared.contains(v))?;
    let place = |t: &[usize; 4], v: usize| t.iter().position(|&w| w == v).unwrap();
    let order = |t: &[usize; 4], top: usize| [p, q, r, top].map(|v| place(t, v));
    let here = one.iter().copied().find(|v| !shared.contains(v))?;
    (parity(&order(one, here)) != parity(&order(other, apex))).then_some(apex)
}

fn parity(order: &[usize; 4]) -> bool {
    let pairs = (0..4).flat_map(|i| (0..i).map(move |j| (j, i)));
    pairs.filter(|&(j, i)| order[j] > order[i]).count() % 2 == 1
}

/// Coordinates of 27 bits: floating-point arithmetic rounds where the exact determinant is zero.
#[test]
fn plain_arithmetic_errs() {
    let side = 100_000_007;
    let cube: Vec<[i32; 3]> = cubic(2).iter().map(|p| p.map(|c| c * side)).collect();
    let mut mesh = Solid::new(&cube, &Solid::canonical(&cubic(2)).tetrahedra);
    let exact = exact_points(&cube.iter().map(position).collect::<Vec<_>>());
    assert!(exact[7].iter().all(|c| *c == BigInt::from(1) || *c == BigInt::from(side)));
    for nudge in [0, 1, -1] {
        mesh.points[7][2] = side + nudge;
        let counts = census(&mesh);
        assert_eq!((counts.exact.inverted, counts.exact.flat), (0, 0));
        assert_eq!(counts.exact.inside > 0, nudge < 0, "{counts:?}");
        assert_eq!(counts.exact.on == 6, nudge == 0, "{counts:?}");
    }
}

#[test]
fn the_command_counts() {
    let spinfo = |arguments: &[&str], mesh: &Solid| crate::programs::run("spinfo", arguments, &mesh.stream());
    let right = Solid::canonical(&cubic(2));
    let output = spinfo(&["--audit", "--count-violations", "--json"], &right);
    assert!(output.status.success());
    let object: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(object["counts"]["tetrahedra"], 6);
    assert_eq!(object["census"]["exact"]["share_not_delaunay"], 1.0);
    assert_eq!(object["census"]["float"]["inside"], 0);
    assert_eq!(object["census"]["hull_proved"], true);
    assert_eq!(object["audit"], Value::Null);

    let mut wrong = right;
    wrong.tetrahedra[0].swap(0, 1);
    let output = spinfo(&["--audit", "--count-violations"], &wrong);
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(4), "{text}");
    assert!(text.contains("inverted "), "{text}");

    let flat = super::Mesh::new(&[[0, 0], [1, 0], [0, 1]], &[[0, 1, 2]]).stream();
    let status = crate::programs::run("spinfo", &["--audit", "--count-violations"], &flat).status;
    assert_eq!(status.code(), Some(2), "a triangle mesh");
    assert_eq!(spinfo(&["--count-violations"], &wrong).status.code(), Some(2));
}
