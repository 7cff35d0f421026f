//! Sets of up to 300 points, degenerate ones included, against the crate `spade`.

use super::scene::{Scene, run};
use spmesh_reference::segments::without_copies;
use spmesh_reference::sets::{DEGENERATE_FAMILIES, Random, degenerate, distinct, uniform};

/// Streams a mesh of the first points, checks the mesh with lines, and returns whether it is the only one.
fn is_unique(random: &mut Random, points: Vec<[i64; 2]>, first: usize) -> bool {
    let most = random.integer(3, 30) as usize;
    let scene = Scene::random(random, points, most).with_first(first);
    let is_hard = random.integer(0, 1) == 1;
    let found = run(&scene.stream(random), &scene.network(|_| is_hard));
    assert!(found.stats.open_segments == 0 || found.triangles.is_empty());
    scene.peer().check(&found.triangles)
}

/// The corners of a box around points, then the points: all different.
fn with_box(points: Vec<[i64; 2]>) -> Vec<[i64; 2]> {
    let range = |axis: usize| {
        let values = || points.iter().map(|point| point[axis]);
        [values().min().unwrap() - 1, values().max().unwrap() + 1]
    };
    let [[left, right], [bottom, top]] = [range(0), range(1)];
    let corners = [[left, bottom], [right, bottom], [right, top], [left, top]];
    without_copies(corners.into_iter().chain(points))
}

#[test]
fn random_sets() {
    let mut unique = 0;
    for seed in 0..200 {
        let mut random = Random::new(seed + 30_000);
        let count = random.integer(20, 300) as usize;
        let points = uniform(&mut random, count, [1000, 100_000, 1 << 28][seed as usize % 3]);
        let (points, first) = match seed % 2 {
            0 => (points.clone(), points.len()),
            _ => (with_box(points), 4 + random.integer(0, 20) as usize),
        };
        unique += usize::from(is_unique(&mut random, points, first));
    }
    assert!(unique > 180, "{unique} sets of 200 have one triangulation only");
}

#[test]
fn degenerate_sets() {
    for seed in 0..100 {
        let mut random = Random::new(seed + 40_000);
        let count = random.integer(20, 300) as usize;
        let mut points = degenerate(&mut random, seed as usize % DEGENERATE_FAMILIES, count);
        points.retain(|point| point.iter().all(|value| value.abs() < 700_000_000));
        let is_flat = [4, 5].contains(&(seed as usize % DEGENERATE_FAMILIES));
        let has_box = is_flat || seed as usize / DEGENERATE_FAMILIES % 2 == 1;
        let points = if has_box { with_box(points) } else { points };
        let count = points.len();
        let first = if has_box { 4 + random.integer(0, count as i64 - 4) as usize } else { count };
        is_unique(&mut random, points, first);
    }
}

#[test]
fn segments_through_points_of_a_grid() {
    for seed in 0..20 {
        let mut random = Random::new(seed + 50_000);
        let side = random.integer(4, 16);
        let grid = (0..side).flat_map(|x| (0..side).map(move |y| [3 * x, 5 * y])).collect();
        let points = distinct(&mut random, grid);
        let first = points.len();
        is_unique(&mut random, points, first);
    }
}

#[test]
fn many_segments_at_one_vertex() {
    for seed in 0..4 {
        let mut random = Random::new(seed + 80_000);
        let points = with_box(uniform(&mut random, 300, 1 << 28));
        // From the first point in the box to all others, which lie in different directions.
        let segments = (5..points.len() as u32).map(|end| [4, end]).collect();
        let scene = Scene { first: 5 + 60 * seed as usize, points, segments };
        let found = run(&scene.stream(&mut random), &scene.network(|_| seed % 2 == 0));
        assert_eq!(found.stats.open_segments, 0);
        assert!(scene.peer().check(&found.triangles));
    }
}
