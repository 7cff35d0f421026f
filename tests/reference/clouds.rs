//! Seeded point sets in space, as degenerate as possible.

use super::sets::Random;
use super::space::Point;

/// Families of point sets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// Random floats in a cube.
    Uniform,
    /// Integers in a small cube.
    Integers,
    /// Integers of 10, 20, 23, 26 or 40 bits.
    WideIntegers,
    /// A piece of a cubic lattice.
    Cubic,
    /// A piece of the face-centered cubic lattice.
    FaceCentered,
    /// A piece of the body-centered cubic lattice.
    BodyCentered,
    /// All integer points on a sphere.
    IntegerSphere,
    /// Rounded points on a sphere.
    RoundedSphere,
    /// The images of a point under all symmetries of the cube.
    Orbit,
    /// Integer points in one plane.
    Plane,
    /// Integer points on a line.
    Line,
    /// Points on two skew lines, with one tetrahedron for each pair of segments.
    SkewLines,
    /// Points (t, t^2, t^3), which are all neighbours of each other.
    MomentCurve,
    /// Points on a paraboloid.
    Paraboloid,
    /// Integer points on a circle, repeated along the axis of a cylinder.
    Cylinder,
    /// Steps of a walk on a grid of thousandths, like atoms of a protein.
    Chain,
    /// A cluster far smaller than its distance to the other points.
    Cluster,
    /// Coordinates of any magnitude.
    Wild,
}

/// All families.
pub const FAMILIES: [Family; 18] = [
    Family::Uniform,
    Family::Integers,
    Family::WideIntegers,
    Family::Cubic,
    Family::FaceCentered,
    Family::BodyCentered,
    Family::IntegerSphere,
    Family::RoundedSphere,
    Family::Orbit,
    Family::Plane,
    Family::Line,
    Family::SkewLines,
    Family::MomentCurve,
    Family::Paraboloid,
    Family::Cylinder,
    Family::Chain,
    Family::Cluster,
    Family::Wild,
];

/// Squares of radii of spheres with many integer points.
const SPHERES: [i64; 10] = [1, 2, 3, 9, 14, 26, 41, 89, 146, 314];

fn pick<T: Copy>(random: &mut Random, items: &[T]) -> T {
    items[(random.bits() % items.len() as u64) as usize]
}

/// Uniform in [-1, 1).
fn signed_unit(random: &mut Random) -> f64 {
    2.0 * random.unit() - 1.0
}

fn integers(random: &mut Random, side: i64) -> [i64; 3] {
    [(); 3].map(|()| random.integer(-side, side))
}

fn floats(point: [i64; 3]) -> Point {
    point.map(|c| c as f64)
}

/// Points of a cubic lattice of spacing `step`, with these counts along the axes.
fn lattice(counts: [i64; 3], step: i64) -> impl Iterator<Item = [i64; 3]> {
    let [l, m, n] = counts;
    (0..l * m * n).map(move |i| [i % l * step, i / l % m * step, i / (l * m) * step])
}

/// Counts along the axes of a box of any shape with about `count` lattice points.
fn box_of(random: &mut Random, count: usize) -> [i64; 3] {
    let side = (count as f64).cbrt().ceil() as i64;
    let mut counts = [side, (side * random.integer(1, 2)).max(1), 1];
    counts[2] = (count as i64 / (counts[0] * counts[1])).max(1);
    random.shuffle(&mut counts);
    counts
}

/// Integer points on the sphere of squared radius `square`.
fn sphere(square: i64) -> Vec<[i64; 3]> {
    let side = (square as f64).sqrt() as i64;
    lattice([2 * side + 1; 3], 1)
        .map(|p| p.map(|c| c - side))
        .filter(|p| p.iter().map(|c| c * c).sum::<i64>() == square)
        .collect()
}

/// A point on the unit sphere, up to rounding.
fn direction(random: &mut Random) -> Point {
    loop {
        let p = [(); 3].map(|()| signed_unit(random));
        let square: f64 = p.iter().map(|c| c * c).sum();
        if (0.01..1.0).contains(&square) {
            return p.map(|c| c / square.sqrt());
        }
    }
}

/// About `count` points of a family.
pub fn of(random: &mut Random, family: Family, count: usize) -> Vec<Point> {
    let n = count as i64;
    match family {
        Family::Uniform => (0..n).map(|_| [(); 3].map(|()| random.unit())).collect(),
        Family::Integers => {
            let side = random.integer(1, 6);
            (0..n).map(|_| floats(integers(random, side))).collect()
        }
        Family::WideIntegers => {
            let side = 1 << pick(random, &[9, 19, 22, 25, 39, 51]);
            (0..n).map(|_| floats(integers(random, side))).collect()
        }
        Family::Cubic => lattice(box_of(random, count), 1).map(floats).collect(),
        Family::FaceCentered => {
            let counts = box_of(random, 2 * count);
            lattice(counts, 1).filter(|p| p.iter().sum::<i64>() % 2 == 0).map(floats).collect()
        }
        Family::BodyCentered => {
            let corners: Vec<[i64; 3]> = lattice(box_of(random, count.div_ceil(2)), 2).collect();
            let centers = corners.iter().map(|p| p.map(|c| c + 1));
            corners.iter().copied().chain(centers).map(floats).collect()
        }
        Family::IntegerSphere => {
            let mut points = sphere(pick(random, &SPHERES));
            random.shuffle(&mut points);
            points.truncate(count);
            points.into_iter().map(floats).collect()
        }
        Family::RoundedSphere => {
            let radius = pick(random, &[1.0, 100.0, 1000.0]);
            let round = |c: f64| if radius > 500.0 { c.round() } else { c };
            (0..n).map(|_| direction(random).map(|c| round(c * radius))).collect()
        }
        Family::Orbit => (0..count.div_ceil(48)).flat_map(|_| orbit(random)).take(count.max(8)).collect(),
        Family::Plane => {
            let [u, v] = [(); 2].map(|()| integers(random, 2));
            let side = random.integer(1, 5);
            (0..n)
                .map(|_| (random.integer(-side, side), random.integer(-side, side)))
                .map(|(i, j)| floats([0, 1, 2].map(|axis| i * u[axis] + j * v[axis])))
                .collect()
        }
        Family::Line => {
            let u = integers(random, 3);
            (0..n).map(|_| random.integer(-n, n)).map(|t| floats(u.map(|c| t * c))).collect()
        }
        Family::SkewLines => (0..n)
            .map(|i| (i, random.integer(0, n)))
            .map(|(i, t)| if i % 2 == 0 { floats([t, 0, 0]) } else { floats([n / 2, t - n / 2, 3]) })
            .collect(),
        Family::MomentCurve => (0..n).map(|t| floats([t, t * t, t * t * t])).collect(),
        Family::Paraboloid => {
            let side = (count as f64).sqrt() as i64 + 1;
            (0..n).map(|i| [i % side, i / side]).map(|[x, y]| floats([x, y, x * x + y * y])).collect()
        }
        Family::Cylinder => {
            let circle: Vec<[i64; 3]> =
                sphere(pick(random, &[50, 65, 325])).into_iter().filter(|p| p[2] == 0).collect();
            let step = random.integer(1, 9);
            (0..n)
                .map(|i| (circle[i as usize % circle.len()], i / circle.len() as i64))
                .map(|([x, y, _], layer)| floats([x, y, step * layer]))
                .collect()
        }
        Family::Chain => {
            let mut at = integers(random, 50_000);
            (0..n)
                .map(|_| {
                    let step = direction(random);
                    at = [0, 1, 2].map(|axis| at[axis] + (1450.0 * step[axis]) as i64);
                    at.map(|c| c as f64 / 1000.0)
                })
                .collect()
        }
        Family::Cluster => {
            let center = [(); 3].map(|()| signed_unit(random));
            let size = 2f64.powi(random.integer(-60, -5) as i32);
            (0..n).map(|_| center.map(|c| c + size * random.integer(-8, 8) as f64)).collect()
        }
        Family::Wild => {
            let range = pick(random, &[20, 100, 300]);
            (0..n)
                .map(|_| {
                    [(); 3]
                        .map(|()| signed_unit(random) * 10f64.powi(random.integer(-range - 15, range) as i32))
                })
                .collect()
        }
    }
}

/// All images of an integer point under the symmetries of the cube.
fn orbit(random: &mut Random) -> Vec<Point> {
    let [x, y, z] = integers(random, 4);
    let rows = [[x, y, z], [x, z, y], [y, x, z], [y, z, x], [z, x, y], [z, y, x]];
    let signs = |i: usize| [i & 1, i >> 1 & 1, i >> 2 & 1].map(|bit| 1 - 2 * bit as i64);
    rows.iter().flat_map(|row| (0..8).map(move |i| floats([0, 1, 2].map(|k| row[k] * signs(i)[k])))).collect()
}

/// A random mixture of about `count` points: families that are moved and scaled, points constructed from
/// other points, and copies. All are finite.
pub fn mixture(random: &mut Random, count: usize) -> Vec<Point> {
    let mut points = Vec::new();
    let parts = pick(random, &[1, 1, 1, 2, 2, 3, 5]);
    for _ in 0..parts {
        let family = pick(random, &FAMILIES);
        // In these families all pairs of points, or about half of them, are neighbours.
        let is_dense = matches!(family, Family::SkewLines | Family::MomentCurve);
        let size = if is_dense { (count / parts).min(150) } else { count / parts };
        let mut part = of(random, family, size.max(1));
        if parts > 1 || random.integer(0, 3) == 0 {
            place(random, &mut part);
        }
        points.extend(part);
    }
    let mutations = pick(random, &[0, 0, 1, 3, count / 4, count / 2]);
    for _ in 0..mutations.min(points.len()) {
        let mutant = mutant(random, &points);
        points.push(mutant);
    }
    if random.integer(0, 1) == 0 {
        transform(random, &mut points);
    }
    points.retain(|p| p.iter().all(|c| c.is_finite()));
    random.shuffle(&mut points);
    points
}

/// Moves a part of a set, by integers or not, and scales it.
fn place(random: &mut Random, part: &mut [Point]) {
    let scale = pick(random, &[1.0, 1.0, 1.0, 2.0, 3.0, 0.5, 0.001, 1e-9, 1e6]);
    let offset = match random.integer(0, 3) {
        0 => [0.0; 3],
        1 => floats(integers(random, 10)),
        2 => floats(integers(random, 100_000)),
        _ => [(); 3].map(|()| signed_unit(random)),
    };
    part.iter_mut().for_each(|p| *p = [0, 1, 2].map(|axis| p[axis] * scale + offset[axis]));
}

/// A point constructed from other points.
fn mutant(random: &mut Random, points: &[Point]) -> Point {
    let [p, q, r, s] = [(); 4].map(|()| pick(random, points));
    let axis = random.integer(0, 2) as usize;
    let mut mutant = p;
    match random.integer(0, 13) {
        0 => {}
        1 => mutant[axis] = -p[axis],
        2 => mutant = [0, 1, 2].map(|i| (p[i] + q[i]) / 2.0),
        3 => mutant = [0, 1, 2].map(|i| 2.0 * p[i] - q[i]),
        4 => mutant = [0, 1, 2].map(|i| p[i] + q[i] - r[i]),
        5 => mutant = [0, 1, 2].map(|i| (p[i] + q[i] + r[i] + s[i]) / 4.0),
        6 => mutant[axis] = p[axis].next_up(),
        7 => mutant[axis] = p[axis].next_down(),
        8 => mutant[axis] = q[axis],
        9 => mutant[axis] = 0.0,
        10 => mutant[axis] = -0.0,
        11 => mutant.swap(axis, (axis + 1) % 3),
        // Nearly in a plane with three others.
        12 => {
            let (t, u) = (random.unit(), random.unit());
            mutant = [0, 1, 2].map(|i| p[i] + t * (q[i] - p[i]) + u * (r[i] - p[i]));
        }
        // Nearly on a line with two others.
        _ => {
            let t = 3.0 * signed_unit(random);
            mutant = [0, 1, 2].map(|i| p[i] + t * (q[i] - p[i]));
        }
    }
    mutant
}

/// Changes all points in the same way.
fn transform(random: &mut Random, points: &mut [Point]) {
    let axis = random.integer(0, 2) as usize;
    let scales =
        [0.1, 0.3, 0.001, 1e-7, 1e5, 1e-40, 1e-100, 1e-155, 1e-300, 1e-318, 1e40, 1e100, 1e154, 1e300];
    match random.integer(0, 9) {
        0..=2 => {
            let scale = pick(random, &scales);
            points.as_flattened_mut().iter_mut().for_each(|c| *c *= scale);
        }
        3 => {
            let exponent = random.integer(-1000, 1000) as i32;
            points.as_flattened_mut().iter_mut().for_each(|c| *c *= 2f64.powi(exponent));
        }
        4 => {
            let offset = pick(random, &[0.1, 1e3, 12345.678, 1e6, 2f64.powi(40), 2f64.powi(52), -1e15]);
            points.as_flattened_mut().iter_mut().for_each(|c| *c += offset);
        }
        5 => {
            let scale = pick(random, &[1e-9, 1e-3, 1e3, 1e9, 0.0, 1.0 / 3.0]);
            points.iter_mut().for_each(|p| p[axis] *= scale);
        }
        6 => points.as_flattened_mut().iter_mut().for_each(|c| *c = c.round()),
        // Change some coordinates by one unit in the last place.
        7 => points.as_flattened_mut().iter_mut().for_each(|c| match random.integer(0, 5) {
            0 => *c = c.next_up(),
            1 => *c = c.next_down(),
            _ => {}
        }),
        // Shear by integer factors.
        8 => points.iter_mut().for_each(|p| p[axis] += 2.0 * p[(axis + 1) % 3] - p[(axis + 2) % 3]),
        // Rotate by about 37 degrees: cospherical points stay cospherical up to rounding.
        _ => points.iter_mut().for_each(|p| {
            let (x, y) = (p[axis], p[(axis + 1) % 3]);
            (p[axis], p[(axis + 1) % 3]) = (0.8 * x - 0.6 * y, 0.6 * x + 0.8 * y);
        }),
    }
}
