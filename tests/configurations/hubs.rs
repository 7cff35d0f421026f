//! Links with many vertices, against the definition: a knot near all others, places with many copies.

use super::{check_circles, check_facets, delaunay, knots, listed};
use spmesh_configurations as configurations;
use spmesh_reference::configurations::by_definition;

/// Compares degrees up to 2, and returns the number of vertices of the largest link.
fn assert_definition(points: &[[f64; 2]]) -> usize {
    let (knots, all) = (knots(points), delaunay(points, 2));
    let expected = by_definition(points, 2);
    for (k, configurations) in all.iter().enumerate() {
        assert!(listed(configurations) == expected[k], "degree {k}; let points = vec!{points:?};");
    }
    let links = all[..2].iter().map(|lower| configurations::links(&knots, lower).expect("links"));
    links.map(|links| links.iter().map(|link| link.polygon.len()).max().unwrap_or(0)).max().unwrap_or(0)
}

/// The integer points of a circle: 32 points with the squared radius 1105.
fn whole_circle() -> Vec<[f64; 2]> {
    let places = (-34..35).flat_map(|x| (-34..35).map(move |y| [x, y]));
    places.filter(|[x, y]| x * x + y * y == 1105).map(|place| place.map(f64::from)).collect()
}

#[test]
fn knots_amid_a_circle_agree() {
    let circle = whole_circle();
    assert_eq!(circle.len(), 32);
    for inside in [vec![[0.0, 0.0]], vec![[3.0, 1.0]], vec![[1.0, 0.0], [1.0, 0.0]]] {
        assert!(assert_definition(&[inside, circle.clone()].concat()) >= 30);
    }
}

#[test]
fn knots_on_a_parabola_agree() {
    let points: Vec<[f64; 2]> = (0..30).map(|i| [f64::from(i), f64::from(i * i)]).collect();
    assert!(assert_definition(&points) >= 29);
}

#[test]
fn knots_on_lines_around_one_agree() {
    let side = (-3..=3).map(f64::from);
    let lines = side.flat_map(|c| [[c, -8.0], [8.0, c], [c, 8.0], [-8.0, c]]);
    assert!(assert_definition(&lines.chain([[0.0, 0.0]]).collect::<Vec<_>>()) >= 28);
}

#[test]
fn many_copies_at_few_places_agree() {
    let places = [[0.0, 0.0], [10.0, 0.0], [3.0, 7.0], [10.0, 10.0]];
    let points: Vec<[f64; 2]> = (0..26).map(|i| places[i * i % 7 % 4]).collect();
    assert!(assert_definition(&points) >= 12);
}

/// Compares a square around many copies of one knot.
fn copies_of_one_place_agree(copies: usize) {
    let mut points = vec![[5.0, 4.0]; copies];
    points.extend([[0.0, 0.0], [10.0, 0.0], [0.0, 10.0], [10.0, 10.0]]);
    assert!(assert_definition(&points) >= copies);
}

#[test]
fn some_copies_of_one_place_agree() {
    copies_of_one_place_agree(12);
}

#[test]
#[ignore = "long: run with -- --ignored"]
fn many_copies_of_one_place_agree() {
    copies_of_one_place_agree(24);
}

#[test]
fn large_hubs_pass_the_audit() {
    let mut points: Vec<[f64; 2]> =
        (0..1500).map(|i| (f64::from(i) * 0.004).sin_cos()).map(|(y, x)| [x * 1e6, y * 1e6]).collect();
    points.push([0.0, 0.0]);
    let all = delaunay(&points, 1);
    check_facets(&all[0], &all[1]).expect("facets");
    check_circles(&knots(&points), &all[1]).expect("circles");
}
