//! Centres of circles and spheres, and Voronoi cells.

use num_bigint::BigInt;
use spmesh_delaunay::{delaunay2, delaunay3};
use spmesh_reference::clouds::{FAMILIES, of};
use spmesh_reference::exact::times_2_1074;
use spmesh_reference::sets::{DEGENERATE_FAMILIES, Random, as_floats, degenerate, uniform};

/// Checks that a centre lies where all bisectors of corners do. For corners p and q, the power of the
/// bisector at the centre, (c - m) (q - p) with the point m midway, is at most the error times the distance
/// of p and q.
fn check_centre<const N: usize, const D: usize>(corners: [[f64; D]; N], centre: [f64; D]) {
    let exact = |point: [f64; D]| point.map(times_2_1074);
    let (centre_exact, corners_exact) = (exact(centre), corners.map(exact));
    let length = |p: &[BigInt; D], q: &[BigInt; D]| -> BigInt {
        let square: BigInt = (0..D).map(|axis| (&p[axis] - &q[axis]) * (&p[axis] - &q[axis])).sum();
        square.sqrt() + 1
    };
    let radius = length(&centre_exact, &corners_exact[0]);
    let magnitude = centre_exact.iter().map(|c| BigInt::from(c.magnitude().clone())).max().expect("an axis");
    // 1e-12 of the radius, and a unit in the last place for each coordinate.
    let error = &radius / BigInt::from(10u64.pow(12)) + (magnitude >> 51) + 2;
    for (i, p) in corners_exact.iter().enumerate() {
        for q in &corners_exact[..i] {
            let doubled: BigInt = (0..D)
                .map(|axis| (&centre_exact[axis] * 2 - &p[axis] - &q[axis]) * (&q[axis] - &p[axis]))
                .sum();
            assert!(
                BigInt::from(doubled.magnitude().clone()) <= 2 * &error * length(p, q),
                "{corners:?} {centre:?}"
            );
        }
    }
}

#[test]
fn centres_are_as_far_from_all_corners() {
    let mut random = Random::new(51);
    let mut overflows = 0;
    for round in 0..100 {
        let scale = [1.0, 2f64.powi(400), 2f64.powi(-600), 1e-3][round % 4];
        let integers = match round % 12 {
            family if family < DEGENERATE_FAMILIES => degenerate(&mut random, family, 40),
            _ => uniform(&mut random, 40, 1 << 40),
        };
        let mut points: Vec<[f64; 2]> = as_floats(&integers).iter().map(|p| p.map(|c| c * scale)).collect();
        if round % 12 == 11 {
            // Triangles so flat that rounding leaves little of their areas.
            points.iter_mut().for_each(|p| p[1] = p[0] / 3.0 + 1e-13 * p[1]);
        }
        let mesh = delaunay2::triangulate(&points).expect("finite points");
        for (number, corners) in (0..).zip(mesh.simplices()) {
            let centre = mesh.circumcentre(number).expect("no overflow");
            check_centre(corners.map(|v| points[v as usize]), centre);
        }
        let points = of(&mut random, FAMILIES[round % FAMILIES.len()], 30);
        let mesh = delaunay3::triangulate(&points).expect("finite points");
        for (number, corners) in (0..).zip(mesh.simplices()) {
            match mesh.circumcentre(number) {
                Some(centre) => check_centre(corners.map(|v| points[v as usize]), centre),
                None => overflows += 1,
            }
        }
    }
    println!("{overflows} overflows");
    let flat = delaunay2::triangulate(&[[0.0, 0.0], [1e300, 0.0], [5e299, 1e250]]).expect("finite points");
    assert_eq!(flat.circumcentre(0), None);
}

type Polygon = Vec<[f64; 2]>;

fn area(polygon: &Polygon) -> f64 {
    let Some(&[x, y]) = polygon.first() else { return 0.0 };
    let sides = polygon.windows(2).map(|pair| {
        let [p, q] = [pair[0], pair[1]].map(|[px, py]| [px - x, py - y]);
        p[0] * q[1] - p[1] * q[0]
    });
    0.5 * sides.sum::<f64>()
}

/// The corners of the cell by definition: the places where two of all borders meet that are nearest to the
/// point. Relative to the point.
fn corners_of_cell(points: &[[f64; 2]], v: usize, bounds: [[f64; 2]; 2], tolerance: f64) -> Polygon {
    let at = points[v];
    let mut planes: Vec<[f64; 3]> = (0..2)
        .flat_map(|axis| {
            let normal = |sign: f64| [0, 1].map(|i| if i == axis { sign } else { 0.0 });
            let [low, high] = bounds.map(|corner| corner[axis] - at[axis]);
            [(normal(-1.0), -low), (normal(1.0), high)].map(|([a, b], c)| [a, b, c])
        })
        .collect();
    for point in points.iter().filter(|&&point| point != at) {
        let [x, y] = [point[0] - at[0], point[1] - at[1]];
        let length = x.hypot(y);
        planes.push([x / length, y / length, 0.5 * length]);
    }
    let mut corners = Vec::new();
    for (i, [a, b, c]) in planes.iter().enumerate() {
        for [d, e, f] in &planes[..i] {
            let determinant = a * e - b * d;
            let corner = [(c * e - b * f) / determinant, (a * f - c * d) / determinant];
            let is_inside = |[a, b, c]: &[f64; 3]| a * corner[0] + b * corner[1] <= c + tolerance;
            if determinant != 0.0 && planes.iter().all(is_inside) {
                corners.push(corner);
            }
        }
    }
    corners.into_iter().map(|[x, y]| [x + at[0], y + at[1]]).collect()
}

/// The distance of a point from the nearest of some.
fn gap(point: [f64; 2], others: &Polygon) -> f64 {
    let distance = |other: &[f64; 2]| (point[0] - other[0]).hypot(point[1] - other[1]);
    others.iter().map(distance).fold(f64::INFINITY, f64::min)
}

#[test]
fn cells_are_those_of_all_half_planes_and_cover_the_box() {
    let mut random = Random::new(52);
    for round in 0..150 {
        let count = round % 25 + 1;
        let integers = match round % 12 {
            // Whose coordinates are of the size of their differences.
            family @ (0 | 1 | 3 | 4 | 5 | 6 | 7 | 9) => degenerate(&mut random, family, count.max(6)),
            _ => uniform(&mut random, count, 12),
        };
        let mut points = as_floats(&integers);
        points.truncate(count.max(1));
        let side = points.iter().flatten().fold(1.0, |most: f64, c| most.max(c.abs()));
        let bounds = [[-1.5 * side, -side], [1.25 * side, 1.5 * side]];
        let distinct = points.len() as u32;
        points.push(points[0]);
        let mesh = delaunay2::triangulate(&points).expect("finite points");
        let cells: Vec<Polygon> = (0..distinct).map(|v| mesh.voronoi_cell(v, bounds)).collect();
        assert_eq!(mesh.voronoi_cell(distinct, bounds), cells[0]);
        let total: f64 = cells.iter().map(area).sum();
        let expected = 2.75 * side * 2.5 * side;
        assert!((total - expected).abs() < 1e-12 * expected, "{points:?}: {total}, {expected}");
        for (v, cell) in cells.iter().enumerate() {
            let tolerance = 1e-12 * side;
            // Borders that are nearly parallel meet nearly anywhere.
            let corners = corners_of_cell(&points, v, bounds, tolerance);
            assert!(cell.iter().all(|&corner| gap(corner, &corners) < 1e-9 * side), "{points:?} {v}");
            assert!(corners.iter().all(|&corner| gap(corner, cell) < 1e-9 * side), "{points:?} {v}");
        }
    }
}

#[test]
fn cells_of_few_points_are_known() {
    let bounds = [[0.0, 0.0], [4.0, 2.0]];
    let cell =
        |points: &[[f64; 2]], v| delaunay2::triangulate(points).expect("finite").voronoi_cell(v, bounds);
    assert_eq!(cell(&[[1.0, 1.0]], 0), [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]]);
    assert_eq!(cell(&[[1.0, 1.0], [3.0, 1.0]], 1), [[2.0, 0.0], [4.0, 0.0], [4.0, 2.0], [2.0, 2.0]]);
    assert_eq!(cell(&[[9.0, 1.0], [3.0, 1.0]], 0), [[0.0; 2]; 0]);
    assert_eq!(cell(&[[-1.0, 0.0], [0.5, 0.0], [1.5, 0.0]], 2).len(), 4);
}
