//! Points on the nodes of grids, which the kernel covers without insertion, against plain insertion.

use super::kernel::{checked, triangulate};
use spmesh_delaunay::delaunay2::{Kernel, Triangles};
use spmesh_reference::sets::Random;
use spmesh_reference::{as_set, exact, incremental};
use std::collections::HashMap;

type Node = [i64; 2];

/// The nodes of a grid, some of them left out.
fn nodes(random: &mut Random, [columns, rows]: [i64; 2]) -> Vec<Node> {
    let all = (0..columns * rows).map(|k| [k % columns, k / columns]);
    let share = [0.0, 0.02, 0.1, 0.3][random.integer(0, 3) as usize];
    let kind = random.integer(0, 6);
    let corner = [random.integer(0, columns - 1), random.integer(0, rows - 1)];
    let side = random.integer(2, 6);
    let is_inside = |[i, j]: Node| {
        let [u, v] = [i - corner[0], j - corner[1]];
        match kind {
            // A gap, which may be at the border.
            0 => !(0..side).contains(&u) || !(0..side).contains(&v),
            // A gap with an island.
            1 => !(0..side).contains(&u) || !(0..side).contains(&v) || [u, v] == [side / 2; 2],
            // Half a grid, with a border of steps.
            2 => i * rows >= j * columns,
            // A disk, with tips of single points.
            3 => (2 * i + 1 - columns).pow(2) + (2 * j + 1 - rows).pow(2) <= columns.min(rows).pow(2),
            // Two parts that touch at a point, or not.
            4 => (u <= 0 && v <= 0) || (u >= side % 3 && v >= side % 3),
            // Without a column and a row.
            5 => u != 0 && v != 0,
            _ => true,
        }
    };
    all.filter(|&node| is_inside(node)).filter(|_| random.unit() >= share).collect()
}

/// Where columns or rows are: at equal distances, or at any.
fn places(random: &mut Random, count: i64) -> Vec<i64> {
    let step_max = [1, 1, 2, 9, 1000][random.integer(0, 4) as usize];
    let mut place = random.integer(-100, 100);
    (0..count)
        .map(|_| {
            place += if step_max == 1 { 3 } else { random.integer(1, step_max) };
            place
        })
        .collect()
}

/// Points on a grid that may be turned, sheared or mirrored, with a few equal ones, in any order.
fn grid(random: &mut Random) -> Vec<Node> {
    let size = [random.integer(2, 24), random.integer(4, 24)];
    let [x, y] = size.map(|count| places(random, count));
    let frame = random.integer(0, 4);
    let mut points: Vec<Node> = nodes(random, size)
        .into_iter()
        .map(|[i, j]| [x[i as usize], y[j as usize]])
        .map(|[x, y]| match frame {
            0 => [x + y, x - y],
            1 => [x + y, y - x],
            2 => [2 * x + y, y],
            3 => [-y, x],
            _ => [x, y],
        })
        .collect();
    if random.integer(0, 3) == 0 {
        // A second grid beside the first, with other steps.
        let right = points.iter().map(|point| point[0]).max().unwrap_or(0) + random.integer(1, 5);
        let step = random.integer(1, 7);
        points.extend((0..36).map(|k| [right + k % 6 * step, k / 6 * step]));
    }
    for _ in 0..points.len() / 20 {
        let copied = points[random.integer(0, points.len() as i64 - 1) as usize];
        points.push(copied);
    }
    random.shuffle(&mut points);
    points
}

/// Triangulates points of an affine image of integer points, whose triangles are the same, and compares.
fn assert_canonical(kernel: &mut Kernel, points: &[Node], image: impl Fn(i64) -> f64) {
    let mut firsts: HashMap<Node, u32> = HashMap::new();
    let mut indices = Vec::new();
    let mut different = Vec::new();
    for (index, &point) in (0..).zip(points) {
        firsts.entry(point).or_insert_with(|| {
            indices.push(index);
            different.push(point);
            index
        });
    }
    let expected = incremental::triangles(&different);
    let expected = as_set(expected.into_iter().map(|triangle| triangle.map(|v| indices[v as usize])));
    let floats: Vec<[f64; 2]> = points.iter().map(|point| point.map(&image)).collect();
    let mut mesh = Triangles::default();
    kernel.triangulate(&floats, &mut mesh).expect("finite points");
    let mut duplicates = mesh.duplicates.clone();
    duplicates.sort_unstable();
    let copies = (0..).zip(points).map(|(index, point)| [index, firsts[point]]);
    assert_eq!(duplicates, copies.filter(|[index, first]| index != first).collect::<Vec<_>>());
    assert_eq!(checked(&floats, &mesh), expected, "let points = vec!{points:?};");
}

#[test]
fn grids_with_gaps_steps_turns_and_copies() {
    let mut kernel = Kernel::new();
    for seed in 0..400 {
        let points = grid(&mut Random::new(20_000 + seed));
        assert_canonical(&mut kernel, &points, |c| c as f64);
    }
}

#[test]
fn grids_far_from_the_origin_and_tiny_ones() {
    let mut kernel = Kernel::new();
    for seed in 0..150 {
        let points = grid(&mut Random::new(30_000 + seed));
        let images: [fn(i64) -> f64; 4] = [
            |c| 1e15 + c as f64,
            |c| c as f64 * 2f64.powi(-1074),
            |c| c as f64 * 2f64.powi(990),
            |c| if c == 0 { -0.0 } else { c as f64 * 2f64.powi(-300) },
        ];
        assert_canonical(&mut kernel, &points, images[seed as usize % 4]);
    }
}

/// All subsets of the nodes around a node in the middle of a grid.
#[test]
fn every_gap_of_nine_nodes() {
    let mut kernel = Kernel::new();
    for subset in 0u32..1 << 9 {
        let is_there = |[i, j]: Node| {
            let [u, v] = [i - 4, j - 4];
            !(0..3).contains(&u) || !(0..3).contains(&v) || subset >> (3 * v + u) & 1 == 1
        };
        let all = (0..11 * 11).map(|k| [k % 11, k / 11]).filter(|&node| is_there(node));
        let points: Vec<Node> = match subset % 2 {
            0 => all.collect(),
            _ => all.map(|[x, y]| [x - y, x + y]).collect(),
        };
        assert_canonical(&mut kernel, &points, |c| c as f64);
    }
}

/// Sides of the cells of such grids differ by rounding, but cells are rectangles. If they are turned, cells
/// are only nearly so.
#[test]
fn grids_of_decimals() {
    let cases = [(0.1, 0.0), (0.3, 431_234.7), (1e-3, 5e6), (1.0 / 3.0, 1e15), (0.7, 0.0)];
    for (seed, &(step, offset)) in (0..).zip(cases.iter().cycle().take(20)) {
        let mut random = Random::new(40_000 + seed);
        let mut points: Vec<[f64; 2]> = nodes(&mut random, [24, 18])
            .into_iter()
            .map(|[i, j]| if seed < 10 { [i, j] } else { [i + j, i - j] })
            .map(|node| node.map(|number| offset + number as f64 * step))
            .collect();
        random.shuffle(&mut points);
        assert_locally_canonical(&points);
    }
}

/// The rounded sums of coordinates make a grid at 45 degrees, but the points are on none.
#[test]
fn grids_of_rounded_sums_only() {
    let mut random = Random::new(50_000);
    let points: Vec<[f64; 2]> = (0..12 * 12)
        .map(|k| [k / 12, k % 12])
        .map(|[i, j]| {
            let moved = 0.25 * random.integer(-1, 1) as f64;
            [2f64.powi(52) + (i + j) as f64, (i - j) as f64 + moved]
        })
        .collect();
    assert_locally_canonical(&points);
}

#[test]
fn zeros_of_both_signs_are_one_column_and_one_row() {
    let zero = |number: i64, k: i64| if number == 0 && k % 2 == 0 { -0.0 } else { number as f64 };
    let nodes: Vec<Node> = (0..31 * 31).map(|k| [k % 31 - 15, k / 31 - 15]).collect();
    let points: Vec<[f64; 2]> = (0..).zip(&nodes).map(|(k, &[x, y])| [zero(x, k / 31), zero(y, k)]).collect();
    let mesh = triangulate(&points).expect("finite points");
    assert_eq!(checked(&points, &mesh), incremental::triangles(&nodes));
}

/// Checks that all triangles are counterclockwise, and the test of each edge, in exact arithmetic.
fn assert_locally_canonical(points: &[[f64; 2]]) {
    let mesh = triangulate(points).expect("finite points");
    checked(points, &mesh);
    let exact = exact::exact_points(points);
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.vertices.map(|v| &exact[v as usize]);
        assert_eq!(exact::orientation(a, b, c), 1);
        for beyond in (0..3).filter_map(|side| triangle.neighbour(side)) {
            let d = mesh.triangles()[beyond.triangle as usize].vertices[beyond.corner as usize];
            assert_eq!(exact::incircle_perturbed([a, b, c, &exact[d as usize]]), -1);
        }
    }
}

#[test]
fn a_grid_costs_few_decisions() {
    for turned in [false, true] {
        let points: Vec<[f64; 2]> = (0..40 * 50)
            .map(|k| [f64::from(k % 40) / 8.0, f64::from(k / 40) * 5.0])
            .map(|[x, y]| if turned { [x + y, y - x] } else { [x, y] })
            .filter(|point| (point[0] * point[1]).rem_euclid(1.0) < 0.95)
            .collect();
        let mut kernel = Kernel::new();
        kernel.triangulate(&points, &mut Triangles::default()).expect("finite points");
        assert!(kernel.counts().total() < 3 * points.len() as u64, "{:?}", kernel.counts());
    }
}
