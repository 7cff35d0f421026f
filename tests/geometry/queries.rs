//! Queries to triangulations, answered again by a search of all simplices.

use spmesh_delaunay::Location;
use spmesh_delaunay::{delaunay2, delaunay3};
use spmesh_reference::sets::Random;
use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZeroUsize;

/// Coordinates are even integers below this, so that odd targets fall between points.
const SIDE: i64 = 8;

fn points<const D: usize>(random: &mut Random, count: i64, side: i64) -> Vec<[f64; D]> {
    (0..count).map(|_| [(); D].map(|()| 2.0 * random.integer(0, side / 2 - 1) as f64)).collect()
}

fn targets<const D: usize>() -> impl Iterator<Item = [f64; D]> {
    let side = SIDE + 1;
    (0..side.pow(D as u32))
        .map(move |i| std::array::from_fn(|axis| (i / side.pow(axis as u32) % side - 1) as f64))
}

/// Determinant of the differences of the other `N - 1` points to the first one.
fn orientation<const N: usize, const D: usize>(points: [[f64; D]; N]) -> i64 {
    fn determinant(rows: &[Vec<i64>]) -> i64 {
        let Some((first, rest)) = rows.split_first() else { return 1 };
        let minor = |column: usize| -> Vec<Vec<i64>> {
            rest.iter().map(|row| [&row[..column], &row[column + 1..]].concat()).collect()
        };
        (0..first.len()).map(|i| (1 - 2 * (i as i64 & 1)) * first[i] * determinant(&minor(i))).sum()
    }
    let row = |p: &[f64; D]| (0..D).map(|axis| (p[axis] - points[0][axis]) as i64).collect();
    determinant(&points[1..].iter().map(row).collect::<Vec<Vec<i64>>>())
}

/// The smallest face of a simplex that contains the target: the vertices whose replacement by the target
/// leaves a positive volume. `None` if a volume becomes negative: the target is outside.
fn face<const N: usize, const D: usize>(
    points: &[[f64; D]],
    simplex: [u32; N],
    target: [f64; D],
) -> Option<BTreeSet<u32>> {
    let mut face = BTreeSet::new();
    for i in 0..N {
        let mut corners = simplex.map(|v| points[v as usize]);
        corners[i] = target;
        match orientation(corners) {
            0 => {}
            1.. => drop(face.insert(simplex[i])),
            _ => return None,
        }
    }
    Some(face)
}

/// The location found by a search of all simplices.
fn expected<const N: usize, const D: usize>(
    points: &[[f64; D]],
    simplices: &[[u32; N]],
    target: [f64; D],
) -> Location {
    if let Some(vertex) = points.iter().position(|&point| point == target) {
        return Location::Vertex(vertex as u32);
    }
    for (number, &simplex) in (0..).zip(simplices) {
        let face: Option<Vec<u32>> = face(points, simplex, target).map(|face| face.into_iter().collect());
        return match face.as_deref() {
            None => continue,
            Some(&[u, v]) => Location::Edge([u, v]),
            Some(&[u, v, w]) if N == 4 => Location::Facet([u, v, w]),
            Some(_) => Location::Simplex(number),
        };
    }
    Location::Outside
}

/// Checks where many targets at once are found, some of them not finite or just outside: `found` for one and
/// for three threads.
fn check_all<const N: usize, const D: usize>(
    points: &[[f64; D]],
    simplices: &[[u32; N]],
    found: impl Fn(&[[f64; D]], NonZeroUsize) -> Vec<u32>,
) {
    let mut all: Vec<[f64; D]> = targets().collect();
    let mut least: Vec<u32> = all
        .iter()
        .map(|&target| {
            let contains = |&simplex: &[u32; N]| face(points, simplex, target).is_some();
            simplices.iter().position(contains).map_or(u32::MAX, |number| number as u32)
        })
        .collect();
    for (place, beyond) in [f64::NAN, f64::INFINITY, 1e300, -5e-324].into_iter().enumerate() {
        all.insert(7 * place, [beyond; D]);
        least.insert(7 * place, u32::MAX);
    }
    for threads in [1, 3] {
        assert_eq!(found(&all, NonZeroUsize::new(threads).unwrap()), least, "{points:?}");
    }
}

/// Checks neighbours, edges, hull and representatives.
fn check<const N: usize, const F: usize, const D: usize>(
    points: &[[f64; D]],
    simplices: &[[u32; N]],
    neighbours: impl Fn(u32) -> [Option<u32>; N],
    edges: &[[u32; 2]],
    hull: Vec<[u32; F]>,
    representatives: &[u32],
) {
    let set = |vertices: &[u32]| vertices.iter().copied().collect::<BTreeSet<u32>>();
    let mut at: BTreeMap<BTreeSet<u32>, Vec<u32>> = BTreeMap::new();
    let mut all_edges = BTreeSet::new();
    for (number, simplex) in (0..).zip(simplices) {
        assert!(orientation(simplex.map(|v| points[v as usize])) > 0);
        for i in 0..N {
            let mut facet = set(simplex);
            facet.remove(&simplex[i]);
            at.entry(facet).or_default().push(number);
            all_edges.extend((0..i).map(|j| [simplex[i].min(simplex[j]), simplex[i].max(simplex[j])]));
        }
    }
    assert_eq!(edges, all_edges.into_iter().collect::<Vec<_>>());
    for (number, simplex) in (0..).zip(simplices) {
        for (i, neighbour) in neighbours(number).into_iter().enumerate() {
            let mut facet = set(simplex);
            facet.remove(&simplex[i]);
            assert_eq!(neighbour, at[&facet].iter().copied().find(|&other| other != number));
        }
    }
    let open: BTreeSet<_> =
        at.iter().filter(|(_, sides)| sides.len() == 1).map(|(facet, _)| facet.clone()).collect();
    assert_eq!(hull.len(), open.len());
    assert_eq!(hull.iter().map(|facet| set(facet)).collect::<BTreeSet<_>>(), open);
    for facet in hull {
        for &point in points {
            let mut corners = [point; N];
            facet.iter().enumerate().for_each(|(i, &v)| corners[i] = points[v as usize]);
            // All points lie on the left of a counterclockwise edge of the hull, or on the inner side of a
            // facet.
            let side = orientation(corners);
            assert!(if D == 2 { side >= 0 } else { side <= 0 }, "{facet:?}");
        }
    }
    for (point, &representative) in points.iter().zip(representatives) {
        assert_eq!(points.iter().position(|other| other == point), Some(representative as usize));
    }
    assert_eq!(representatives.len(), points.len());
}

#[test]
fn triangulations_answer_as_all_their_triangles_do() {
    let mut random = Random::new(21);
    for round in 0..300 {
        // Every fourth set lies on a line.
        let mut points: Vec<[f64; 2]> = points(&mut random, round % 23, SIDE);
        if round % 4 == 0 {
            points.iter_mut().for_each(|point| point[1] = SIDE as f64 - 2.0 - point[0]);
        }
        let mesh = delaunay2::triangulate(&points).expect("finite points");
        let simplices: Vec<[u32; 3]> = mesh.simplices().collect();
        assert_eq!(mesh.points(), points);
        let hull = mesh.hull().collect();
        check_all(&points, &simplices, |targets, threads| mesh.locate_all(targets, threads));
        check(&points, &simplices, |i| mesh.neighbours(i), &mesh.edges(), hull, &mesh.representatives());
        for target in targets() {
            assert_eq!(mesh.locate(target), expected(&points, &simplices, target), "{points:?} {target:?}");
        }
    }
}

#[test]
fn tetrahedralizations_answer_as_all_their_tetrahedra_do() {
    let mut random = Random::new(22);
    for round in 0..60 {
        // Every fourth set lies in a plane.
        let mut points: Vec<[f64; 3]> = points(&mut random, round % 19, SIDE);
        if round % 4 == 0 {
            points.iter_mut().for_each(|point| point[2] = point[0]);
        }
        let mesh = delaunay3::triangulate(&points).expect("finite points");
        let simplices: Vec<[u32; 4]> = mesh.simplices().collect();
        let hull = mesh.hull().collect();
        check_all(&points, &simplices, |targets, threads| mesh.locate_all(targets, threads));
        check(&points, &simplices, |i| mesh.neighbours(i), &mesh.edges(), hull, &mesh.representatives());
        for target in targets() {
            assert_eq!(mesh.locate(target), expected(&points, &simplices, target), "{points:?} {target:?}");
        }
    }
}

#[test]
fn targets_that_are_not_finite_are_outside() {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let space = delaunay3::triangulate(&corners).expect("finite points");
    let plane = delaunay2::triangulate(&corners.map(|[x, y, _]| [x, y])).expect("finite points");
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(space.locate([0.1, 0.1, bad]), Location::Outside);
        assert_eq!(plane.locate([bad, 0.1]), Location::Outside);
    }
    assert!(
        delaunay2::triangulate(&[[f64::NAN, 0.0]]).is_err()
            && delaunay3::triangulate(&[[f64::NAN; 3]]).is_err()
    );
}
