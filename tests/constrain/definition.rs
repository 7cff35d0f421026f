//! Small scenes, ties included, against the definition of the constrained Delaunay triangulation.

use super::scene::{Constrained, LINE, Scene, elevation, run};
use spmesh_reference::as_set;
use spmesh_reference::constrained::Scene as Reference;
use spmesh_reference::segments::{in_square, without_copies};
use spmesh_reference::sets::{Random, distinct, uniform};

/// Compares a mesh with the definition.
fn check(scene: &Scene, found: &Constrained) {
    let number = |place: [i64; 2]| scene.points.iter().position(|&other| other == place).unwrap() as u32;
    let set = as_set(found.triangles.iter().map(|corners| corners.map(number)));
    let reference = Reference::new(&scene.points, &scene.segments);
    assert_eq!(set, reference.triangles(), "points {:?}, segments {:?}", scene.points, scene.segments);
    assert_eq!(found.stats.outside, 0);
    assert_eq!(found.stats.open_segments, 0);
}

#[test]
fn segments_between_points_of_the_mesh() {
    for seed in 0..400 {
        let mut random = Random::new(seed);
        let count = random.integer(3, 12) as usize;
        let points = uniform(&mut random, count, [2, 3, 5, 9, 1000][seed as usize % 5]);
        let scene = Scene::random(&mut random, points, 4);
        let stream = scene.stream(&mut random);
        let found = run(&stream, &scene.network(|_| true));
        if !found.triangles.is_empty() {
            check(&scene, &found);
        }
    }
}

#[test]
fn segments_with_new_vertices() {
    for seed in 0..600 {
        let mut random = Random::new(seed + 10_000);
        // The corners of a square come first, so that no later point is outside.
        let side = [2, 4, 6, 20, 1000][seed as usize % 5];
        let unique = in_square(&mut random, side);
        let first = 4 + random.integer(0, unique.len() as i64 - 4) as usize;
        let scene = Scene::random(&mut random, unique, 4).with_first(first);
        let network = scene.network(|point| point % 3 == 0 && seed % 2 == 0);
        let found = run(&scene.stream(&mut random), &network);
        check(&scene, &found);
        for (number, &place) in (0..).zip(&scene.points) {
            let in_network = network.vertices.iter().find(|vertex| vertex.place.map(|c| c as i64) == place);
            let is_hard = in_network.is_some_and(|vertex| vertex.z.is_some());
            if is_hard || (in_network.is_none() && scene.is_amid_hard(place, &network)) {
                assert_eq!(found.elevations[&place], LINE);
            } else if number < scene.first || seed % 2 == 1 {
                assert_eq!(found.elevations[&place], elevation(place), "{place:?} of seed {seed}");
            }
        }
    }
}

#[test]
fn every_order_of_triangles_gives_the_same_mesh() {
    for seed in 0..20 {
        let mut random = Random::new(seed + 20_000);
        let grid = (0..40).flat_map(|x| (0..25).map(move |y| [4 * x, 4 * y])).collect();
        let mut points = distinct(&mut random, grid);
        let first = points.len();
        points.extend((0..60).map(|_| [4 * random.integer(0, 38) + 1, 4 * random.integer(0, 23) + 2]));
        let points = without_copies(points);
        let scene = Scene::random(&mut random, points, 80).with_first(first);
        let network = scene.network(|point| point % 2 == 0);
        let sorted = |found: Constrained| {
            let mut triangles: Vec<[[i64; 2]; 3]> = found.triangles;
            triangles.iter_mut().for_each(|corners| corners.sort_unstable());
            triangles.sort_unstable();
            (triangles, found.elevations)
        };
        let all: Vec<_> = (0..3).map(|_| sorted(run(&scene.stream(&mut random), &network))).collect();
        assert!(all[0] == all[1] && all[1] == all[2], "seed {seed}");
    }
}
