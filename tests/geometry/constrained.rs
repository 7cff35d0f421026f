//! The constrained Delaunay triangulation of a region against its definition.

use spmesh_delaunay::constrained2::Region;
use spmesh_delaunay::delaunay2::triangulate;
use spmesh_delaunay::predicates::FiniteFloatPredicates;
use spmesh_reference::as_set;
use spmesh_reference::constrained::Scene;
use spmesh_reference::segments::{in_square, is_in, is_on, random_segments};
use spmesh_reference::sets::{Random, as_floats, distinct, uniform};

/// Points, segments between them that do not cross, and how many of the points are in the mesh at first.
struct Case {
    points: Vec<[i64; 2]>,
    segments: Vec<[u32; 2]>,
    first: usize,
}

impl Case {
    /// Up to `most` segments between random points, of which no two collide or touch but at points.
    fn random(random: &mut Random, points: Vec<[i64; 2]>, most: usize) -> Case {
        let segments = random_segments(random, &points, most, true);
        Case { first: points.len(), points, segments }
    }

    /// The constrained triangulation, with the segments of the sides of each triangle.
    fn run(&self) -> Vec<([u32; 3], [Option<u32>; 3])> {
        let mut predicates = FiniteFloatPredicates::default();
        let places = as_floats(&self.points);
        let mesh = triangulate(&places[..self.first]).unwrap();
        let triangles: Vec<[u32; 3]> = mesh.simplices().collect();
        let mut region = Region::new(&places, &triangles);
        for (number, &place) in places.iter().enumerate().skip(self.first) {
            let holds =
                |triangle: &[u32; 3]| is_in(triangle.map(|v| self.points[v as usize]), self.points[number]);
            if let Some(triangle) = triangles.iter().position(holds) {
                region.insert(number as u32, place, triangle as u32, &mut predicates);
            }
        }
        for (segment, &ends) in (0..).zip(&self.segments) {
            let at = ends.map(|end| self.points[end as usize]);
            let on: Vec<u32> =
                (0..).zip(&self.points).filter(|&(_, &x)| is_on(at, x)).map(|(i, _)| i).collect();
            let to = places[ends[1] as usize];
            assert!(!region.constrain(segment, to, &on, &mut predicates).unwrap());
        }
        region.pieces().map(|piece| (piece.points, piece.segments)).collect()
    }

    /// Compares with the definition, and the sides on segments with the segments.
    fn check(&self) {
        let found = self.run();
        let scene = Scene::new(&self.points, &self.segments);
        let set = as_set(found.iter().map(|piece| piece.0));
        assert_eq!(set, scene.triangles(), "points {:?}, segments {:?}", self.points, self.segments);
        for (corners, segments) in found {
            for place in 0..3 {
                let ends = [1, 2].map(|turn| corners[(place + turn) % 3] as usize);
                let on = self.segments.iter().position(|s| scene.is_on(s.map(|end| end as usize), ends));
                assert_eq!(segments[place].map(|s| s as usize), on, "{ends:?} in {:?}", self.points);
            }
        }
    }
}

#[test]
fn few_points_follow_the_definition() {
    for seed in 0..600 {
        let mut random = Random::new(seed);
        let count = random.integer(3, 12) as usize;
        let side = [2, 3, 5, 9, 1000][seed as usize % 5];
        let points = uniform(&mut random, count, side);
        Case::random(&mut random, points, 4).check();
    }
}

#[test]
fn inserted_points_follow_the_definition() {
    for seed in 0..600 {
        let mut random = Random::new(seed + 10_000);
        // The corners of a square come first, so that no later point is outside.
        let side = [2, 4, 6, 20, 1000][seed as usize % 5];
        let points = in_square(&mut random, side);
        let mut case = Case::random(&mut random, points, 4);
        case.first = 4 + random.integer(0, case.points.len() as i64 - 4) as usize;
        case.check();
    }
}

#[test]
fn long_segments_through_grids_follow_the_definition() {
    for seed in 0..60 {
        let mut random = Random::new(seed + 20_000);
        let [columns, rows] = [random.integer(2, 6), random.integer(2, 4)];
        let grid = (0..columns).flat_map(|x| (0..rows).map(move |y| [x, y])).collect();
        let points = distinct(&mut random, grid);
        Case::random(&mut random, points, 6).check();
    }
}
