//! Sets of points in four dimensions, and reference diagrams in the library's types.

use spmesh_stream::model::cells4::{Cell4, Cells4, Point4};

use crate::diagram4::{Cell, Point, sorted};
use crate::sets::Random;

/// Converts cells to the library's type.
pub fn cells4(cells: &[Cell]) -> Cells4 {
    let mut all = Cells4::default();
    for (is_infinite, vertices, neighbours) in cells {
        all.push(Cell4 { is_infinite: *is_infinite, vertices, neighbours });
    }
    all
}

/// Converts points to f64.
pub fn floats(points: &[Point]) -> Vec<Point4> {
    points.iter().map(|point| point.map(|x| x as f64)).collect()
}

/// Points of a grid with so many points along each axis.
pub fn grid(counts: [i64; 4]) -> Vec<Point> {
    let mut points = vec![[0; 4]];
    for (axis, &count) in counts.iter().enumerate() {
        let at = |point: &Point, x: i64| {
            let mut point = *point;
            point[axis] = x;
            point
        };
        points =
            points.iter().flat_map(|point| (0..count).map(|x| at(point, x)).collect::<Vec<_>>()).collect();
    }
    points
}

/// Up to `count` random points of a grid with this side.
pub fn random_points(random: &mut Random, count: usize, side: i64) -> Vec<Point> {
    sorted((0..count).map(|_| [(); 4].map(|()| random.integer(0, side - 1))).collect())
}

/// Sets of every kind, small enough for brute force.
pub fn families(random: &mut Random) -> Vec<Vec<Point>> {
    let cube = grid([2; 4]);
    let doubled: Vec<Point> = cube.iter().map(|point| point.map(|x| 2 * x)).collect();
    let some = |random: &mut Random, points: &[Point], count: usize| {
        let mut points = points.to_vec();
        random.shuffle(&mut points);
        points.truncate(count);
        sorted(points)
    };
    let crosspolytope =
        (0..8).map(|i| [0, 1, 2, 3].map(|axis| if axis == i / 2 { 2 * (i % 2) - 1 } else { 0 }));
    let line = (0..4).map(|i| [2 * i, i, -i, 0]).chain([[0, 5, 1, 1], [1, 1, 7, 2], [3, 0, 0, 9]]);
    let flat: Vec<Point> = random_points(random, 9, 3).iter().map(|&[x, y, z, _]| [x, y, z, 0]).collect();
    let mut sets = vec![
        cube.clone(),
        sorted([doubled, vec![[1; 4]]].concat()),
        crosspolytope.collect(),
        line.collect(),
        [flat.clone(), vec![[1, 1, 1, 2]]].concat(),
        [flat, vec![[1, 1, 1, 2], [0, 1, 0, -1]]].concat(),
        grid([3, 2, 2, 1]).iter().map(|&[x, y, z, t]| [x, y, z, t]).chain([[0, 0, 0, 1]]).collect(),
    ];
    sets.extend((0..3).map(|_| some(random, &cube, 11)));
    sets.extend((0..4).map(|_| some(random, &grid([3, 3, 2, 2]), 12)));
    for side in [2, 3, 3, 4, 5, 40, 900] {
        sets.push(random_points(random, 12, side));
    }
    sets.into_iter().map(sorted).collect()
}
