//! Vectors of space, for the checks of balls.

use spmesh_reference::sets::Random;

pub(super) type Point = [f64; 3];

pub(super) fn along(p: Point, by: f64, direction: Point) -> Point {
    [0, 1, 2].map(|i| p[i] + by * direction[i])
}

pub(super) fn minus(p: Point, q: Point) -> Point {
    [0, 1, 2].map(|i| p[i] - q[i])
}

pub(super) fn dot(p: Point, q: Point) -> f64 {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
}

pub(super) fn cross(p: Point, q: Point) -> Point {
    [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
}

pub(super) fn square(p: Point) -> f64 {
    dot(p, p)
}

pub(super) fn length(p: Point) -> f64 {
    square(p).sqrt()
}

pub(super) fn unit_vector(random: &mut Random) -> Point {
    loop {
        let v = [(); 3].map(|()| 2.0 * random.unit() - 1.0);
        if (0.01..1.0).contains(&square(v)) {
            return v.map(|c| c / length(v));
        }
    }
}
