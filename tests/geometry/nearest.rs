//! Nearest vertices, stars, centres and Voronoi cells against searches of all points in integers.

use num_bigint::BigInt;
use spmesh_delaunay::{delaunay2, delaunay3};
use spmesh_reference::clouds::{FAMILIES, of};
use spmesh_reference::exact::times_2_1074;
use spmesh_reference::sets::{DEGENERATE_FAMILIES, Random, as_floats, degenerate, uniform};
use std::collections::BTreeSet;

/// The least indices of distinct points, by distance from the target, then by index.
fn by_distance<const D: usize>(points: &[[f64; D]], target: [f64; D]) -> Vec<u32> {
    let square = |point: [f64; D]| -> BigInt {
        let difference = |axis: usize| times_2_1074(point[axis]) - times_2_1074(target[axis]);
        (0..D).map(|axis| difference(axis) * difference(axis)).sum()
    };
    let firsts = (0..points.len()).filter(|&i| !points[..i].contains(&points[i]));
    let mut all: Vec<(BigInt, u32)> = firsts.map(|i| (square(points[i]), i as u32)).collect();
    all.sort();
    all.into_iter().map(|(_, index)| index).collect()
}

/// Targets with ties and without: at vertices, midway between two, at random, and outside.
fn targets<const D: usize>(random: &mut Random, points: &[[f64; D]]) -> Vec<[f64; D]> {
    let Some(last) = points.len().checked_sub(1) else { return vec![[0.0; D]] };
    let mut pick = || points[random.integer(0, last as i64) as usize];
    let (a, b) = (pick(), pick());
    let middle = std::array::from_fn(|axis| a[axis].midpoint(b[axis]));
    let beyond = std::array::from_fn(|axis| 3.0 * a[axis] - 2.0 * b[axis]);
    let corner = std::array::from_fn(|axis| if axis == 0 { a[axis] } else { b[axis] });
    vec![a, middle, beyond, corner]
}

fn planar_set(random: &mut Random, round: usize) -> Vec<[f64; 2]> {
    let count = round % 40;
    let integers = match round % 12 {
        family if family < DEGENERATE_FAMILIES => degenerate(random, family, count),
        10 => uniform(random, count, 7),
        _ => uniform(random, count, 1 << 40),
    };
    let mut points = as_floats(&integers);
    points.truncate(120);
    if let Some(&first) = points.first() {
        points.push(first);
    }
    let scale = [1.0, 0.1, 2f64.powi(960), 2f64.powi(-1060)][round % 4];
    points.iter().map(|point| point.map(|c| c * scale)).collect()
}

#[test]
fn nearest_vertices_of_the_plane_are_those_of_a_search() {
    let mut random = Random::new(41);
    for round in 0..400 {
        let points = planar_set(&mut random, round);
        let mesh = delaunay2::triangulate(&points).expect("finite points");
        let starts = mesh.starts();
        for target in targets(&mut random, &points) {
            let expected = by_distance(&points, target);
            assert_eq!(mesh.nearest(target), expected.first().copied(), "{points:?} {target:?}");
            let start = random.integer(0, 60) as u32;
            assert_eq!(mesh.nearest_from(target, start), expected.first().copied());
            assert_eq!(mesh.nearest_from(target, starts.near(target)), expected.first().copied());
            for count in [0, 1, 7, points.len() + 1] {
                let expected = &expected[..count.min(expected.len())];
                assert_eq!(mesh.k_nearest(target, count), expected, "{points:?} {target:?}");
            }
        }
    }
}

#[test]
fn nearest_vertices_of_space_are_those_of_a_search() {
    let mut random = Random::new(42);
    for round in 0..180 {
        let mut points = of(&mut random, FAMILIES[round % FAMILIES.len()], round % 40 + 1);
        points.truncate(90);
        if let Some(&first) = points.first() {
            points.push(first);
        }
        let mesh = delaunay3::triangulate(&points).expect("finite points");
        let starts = mesh.starts();
        for target in targets(&mut random, &points) {
            let expected = by_distance(&points, target);
            assert_eq!(mesh.nearest(target), expected.first().copied(), "{points:?} {target:?}");
            let start = random.integer(0, 60) as u32;
            assert_eq!(mesh.nearest_from(target, start), expected.first().copied());
            assert_eq!(mesh.nearest_from(target, starts.near(target)), expected.first().copied());
            for count in [0, 1, 7, points.len() + 1] {
                let expected = &expected[..count.min(expected.len())];
                assert_eq!(mesh.k_nearest(target, count), expected, "{points:?} {target:?}");
            }
        }
    }
}

#[test]
fn nothing_is_near_to_targets_that_are_not_finite() {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for count in 0..=4 {
        let space = delaunay3::triangulate(&corners[..count]).expect("finite points");
        let flat = corners.map(|[x, y, _]| [x, y]);
        let plane = delaunay2::triangulate(&flat[..count]).expect("finite points");
        for bad in [f64::NAN, f64::INFINITY] {
            assert_eq!((space.nearest([bad, 0.0, 0.0]), plane.nearest([0.0, bad])), (None, None));
            assert!(
                space.k_nearest([0.0, bad, 0.0], 3).is_empty() && plane.k_nearest([bad; 2], 3).is_empty()
            );
        }
    }
}

#[test]
fn stars_have_the_edges() {
    let mut random = Random::new(43);
    for round in 0..60 {
        let plane = delaunay2::triangulate(&planar_set(&mut random, round)).expect("finite points");
        let edges = plane.edges().into_iter().flat_map(|[a, b]| [[a, b], [b, a]]);
        let stars = (0..plane.points().len() as u32).flat_map(|v| plane.star(v).map(move |w| [v, w]));
        let stars: Vec<[u32; 2]> = stars.collect();
        assert_eq!(stars.len(), 2 * plane.edges().len());
        assert_eq!(stars.iter().copied().collect::<BTreeSet<_>>(), edges.collect());
        for [v, w] in stars {
            // Counterclockwise: the next neighbour makes a triangle with both, or v and w are on the hull.
            let mut star = plane.star(v).skip_while(|&u| u != w).skip(1).chain(plane.star(v).take(1));
            let triangle = [v, w, star.next().expect("a neighbour")];
            let turned = |[a, b, c]: [u32; 3]| [[a, b, c], [b, c, a], [c, a, b]];
            let is_there = plane.simplices().any(|simplex| turned(simplex).contains(&triangle));
            assert!(is_there || plane.hull().any(|edge| edge == [w, v]));
        }
        let points = of(&mut random, FAMILIES[round % FAMILIES.len()], round % 30 + 1);
        let space = delaunay3::triangulate(&points).expect("finite points");
        let mut stars = delaunay3::Stars::new(&space);
        let edges: BTreeSet<_> = space.edges().into_iter().flat_map(|[a, b]| [[a, b], [b, a]]).collect();
        for v in 0..points.len() as u32 {
            let expected: Vec<u32> = edges.iter().filter(|edge| edge[0] == v).map(|edge| edge[1]).collect();
            assert_eq!(stars.of(v), expected);
        }
    }
}
