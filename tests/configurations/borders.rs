//! Repeated knots on the border, checked by their purpose: the splines sum to one.

use super::knots;
use super::spline::{b_spline, sum_at};
use spmesh_configurations::{self as configurations, Knots, Rule, Start};
use spmesh_reference::sets::Random;
use std::collections::HashSet;

/// The greatest deviation from one, in the unit square.
fn deviation(knots: &Knots, degree: usize, rule: &Rule) -> f64 {
    let start = configurations::delaunay(knots).expect("triangles");
    let all = configurations::generate(knots, start, rule, degree).expect("degrees");
    let mut random = Random::new(77);
    let samples = (0..40).map(|_| [random.unit(), random.unit()]);
    samples.map(|x| (sum_at(knots, &all[degree], x) - 1.0).abs()).fold(0.0, f64::max)
}

/// A square with knots along its edges and inside.
fn square() -> Vec<[f64; 2]> {
    let mut random = Random::new(8);
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let along = [[0.3, 0.0], [0.7, 0.0], [1.0, 0.45], [0.0, 0.6], [0.5, 1.0]];
    corners.into_iter().chain(along).chain((0..8).map(|_| [random.unit(), random.unit()])).collect()
}

#[test]
fn clamped_splines_sum_to_one_on_the_whole_hull() {
    for degree in 1..=3 {
        let clamped = knots(&square()).clamped(degree).expect("a hull");
        assert_eq!(clamped.len(), 17 + 4 * degree);
        for rule in [Rule::Delaunay, Rule::Random(3)] {
            let found = deviation(&clamped, degree, &rule);
            assert!(found < 1e-9, "degree {degree}, {rule:?}: {found}");
        }
        let less = knots(&square()).clamped(degree - 1).expect("a hull");
        assert!(deviation(&less, degree, &Rule::Delaunay) > 1e-3, "degree {degree} with less multiplicity");
    }
}

#[test]
fn pulled_apart_splines_sum_to_one_and_interpolate() {
    let apart = knots(&square()).pulled_apart().expect("a hull");
    assert_eq!(apart.len(), 17 + 9);
    assert!(deviation(&apart, 1, &Rule::Delaunay) < 1e-9);
    let start = configurations::delaunay(&apart).expect("triangles");
    let degree_1 = configurations::link_triangulate(&apart, &start, &Rule::Delaunay).expect("links");
    let links = configurations::links(&apart, &degree_1).expect("links");
    let mut random = Random::new(5);
    for _ in 0..40 {
        let x = [random.unit(), random.unit()];
        let sum: f64 = links.iter().map(|link| b_spline(&apart, link, x)).sum();
        assert!((sum - 1.0).abs() < 1e-9, "{x:?}: {sum}");
    }
    for (knot, copy) in (0..9).zip(17..) {
        let at = apart.at(knot);
        let near = [at[0] + 1e-7 * (0.52 - at[0]), at[1] + 1e-7 * (0.47 - at[1])];
        let tent = links.link(links.find(&[knot, copy]).expect("an edge of copies"));
        let value = b_spline(&apart, tent, near);
        assert!((value - 1.0).abs() < 1e-5, "knot {knot}: {value}");
    }
}

#[test]
fn links_of_pulled_apart_knots_are_fans() {
    let points: Vec<[f64; 2]> = (0..25).map(|i| [f64::from(i % 5), f64::from(i / 5)]).collect();
    let apart = knots(&points).pull_apart(&[12, 6, 12]).expect("known knots");
    assert_eq!(apart.points()[25..], [points[6], points[12]]);
    assert_eq!(
        (apart.copies_of(12), apart.copies_of(26), apart.copies_of(0)),
        (vec![12, 26], vec![12, 26], vec![0])
    );
    let start = Start::delaunay(&apart).expect("triangles").generalised();
    for rule in [Rule::Delaunay, Rule::Ear, Rule::Random(1)] {
        let degree_1 =
            configurations::link_triangulate(&apart, &start.configurations(), &rule).expect("links");
        for [knot, copy] in [[6, 25], [25, 6], [12, 26], [26, 12]] {
            let group = degree_1.groups().find(|group| group.interior == [knot]).expect("its link");
            assert!(group.triangles.iter().all(|triangle| triangle.contains(&copy)), "{rule:?}: {group:?}");
        }
        // A spline of degree 2 at the place: the link of both copies goes around it once.
        let links = configurations::links(&apart, &degree_1).expect("links");
        let both = links.link(links.find(&[12, 26]).expect("an edge"));
        let around: HashSet<[u64; 2]> =
            both.polygon.iter().map(|&id| apart.at(id).map(f64::to_bits)).collect();
        assert!(around.len() >= 4 && !around.contains(&points[12].map(f64::to_bits)));
    }
}

#[test]
fn flips_leave_knots_that_are_pulled_apart_as_they_are() {
    for seed in 0..60 {
        // On a grid, many triangles would be flat but for symbolic displacements.
        let points: Vec<[f64; 2]> = (0..25).map(|i| [f64::from(i % 5), f64::from(i / 5)]).collect();
        let apart = knots(&points).pull_apart(&Vec::from_iter(0..25)).expect("known knots");
        let mut start = Start::delaunay(&apart).expect("triangles").generalised();
        let flips = if seed % 4 == 0 {
            start.flip_aligned(&apart, 20.0 * seed as f64)
        } else {
            start.flip_random(&apart, 25, seed)
        };
        assert!(flips > 10, "seed {seed}: {flips}");
        let rule = if seed % 2 == 0 { Rule::Random(seed) } else { Rule::Delaunay };
        let degree_1 =
            configurations::link_triangulate(&apart, &start.configurations(), &rule).expect("links");
        let links = configurations::links(&apart, &degree_1).expect("links");
        for (knot, copy) in (0..25).zip(25..) {
            let both = links.link(links.find(&[knot, copy]).expect("an edge of copies"));
            let [x, y] = apart.at(knot);
            let near = [x + 1e-7 * (2.03 - x), y + 1e-7 * (1.96 - y)];
            let near = if knot == 12 { [2.0 + 1e-7, 2.0 + 3e-8] } else { near };
            let value = b_spline(&apart, both, near);
            assert!((value - 1.0).abs() < 1e-5, "seed {seed}, knot {knot}: {value}");
            for [one, other] in [[knot, copy], [copy, knot]] {
                let group = degree_1.groups().find(|group| group.interior == [one]).expect("its link");
                let is_inner = group.infinite.is_empty();
                assert!(!is_inner || group.triangles.iter().all(|triangle| triangle.contains(&other)));
            }
        }
    }
}

#[test]
fn unknown_knots_and_lines_are_errors() {
    let few = knots(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]);
    assert_eq!(few.pull_apart(&[1, 7]).expect_err("unknown").to_string(), "unknown knot 7: there are 3");
    assert!(few.clamped(2).is_err() && few.pulled_apart().is_err());
    assert_eq!(few.pull_apart(&[]).expect("nothing to do").len(), 3);
}
