//! Cells of unions of balls against closed forms and against sampling, which share nothing with the power
//! diagram.

use super::vectors::{Point, cross, dot, length, minus, square, unit_vector};
use spmesh_molecules::balls::{Balls, Cells, measure};
use spmesh_reference::sets::Random;
use std::f64::consts::PI;
use std::num::NonZeroUsize;

fn measured(centres: &[Point], radii: &[f64]) -> Cells {
    measure(Balls { centres, radii }, Some(0.0), NonZeroUsize::MIN).expect("finite balls")
}

fn assert_near(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found - expected).abs() <= tolerance, "{what}: {found}, not {expected}");
}

fn volume(cells: &Cells) -> f64 {
    cells.cells.iter().map(|cell| cell.volume).sum()
}

fn area(cells: &Cells) -> f64 {
    cells.cells.iter().map(|cell| cell.area).sum()
}

fn ball_volume(r: f64) -> f64 {
    4.0 / 3.0 * PI * r.powi(3)
}

/// Volume of a cap of height h.
fn cap(r: f64, h: f64) -> f64 {
    PI * h * h * (3.0 * r - h) / 3.0
}

/// Volume that two balls share, at distance d with spheres that meet.
fn lens(r: f64, s: f64, d: f64) -> f64 {
    let x = (d * d + r * r - s * s) / (2.0 * d);
    cap(r, r - x) + cap(s, s - (d - x))
}

#[test]
fn one_ball() {
    let cells = measured(&[[3.0, -4.0, 5.0]], &[2.5]);
    assert_near(area(&cells), 4.0 * PI * 6.25, 1e-12, "area");
    assert_near(volume(&cells), ball_volume(2.5), 1e-12, "volume");
    assert!(cells.contacts.is_empty());
    assert_eq!(measured(&[], &[]).cells, []);
    assert_eq!(measured(&[[1.0; 3]], &[0.0]).cells[0].area, 0.0);
}

#[test]
fn two_balls() {
    let mut random = Random::new(1);
    for _ in 0..2_000 {
        let (r, s) = (1.0 + random.unit(), 0.2 + 2.0 * random.unit());
        let d = 0.05 + 4.5 * random.unit();
        let direction = unit_vector(&mut random);
        let origin = [random.unit(), random.unit(), random.unit()];
        let other = [0, 1, 2].map(|i| origin[i] + d * direction[i]);
        let cells = measured(&[origin, other], &[r, s]);
        let x = (d * d + r * r - s * s) / (2.0 * d);
        let (first, second, face) = if d >= r + s {
            (4.0 * PI * r * r, 4.0 * PI * s * s, 0.0)
        } else if d <= (r - s).abs() {
            let [r, s] = if r > s { [r, 0.0] } else { [0.0, s] };
            (4.0 * PI * r * r, 4.0 * PI * s * s, 0.0)
        } else {
            (2.0 * PI * r * (r + x), 2.0 * PI * s * (s + d - x), PI * (r * r - x * x))
        };
        assert_near(cells.cells[0].area, first, 1e-12 * 16.0 * PI, "first area");
        assert_near(cells.cells[1].area, second, 1e-12 * 16.0 * PI, "second area");
        let shared = if face > 0.0 { lens(r, s, d) } else { 0.0 };
        let outer = if d <= (r - s).abs() { ball_volume(r.max(s)) } else { ball_volume(r) + ball_volume(s) };
        assert_near(volume(&cells), outer - shared, 1e-12 * 32.0, "volume");
        let found = cells.contacts.iter().next().map_or(0.0, |contact| contact.area);
        assert_near(found, face, 1e-12 * 12.0, "face");
    }
}

/// Three balls whose spheres meet in two points, by the tetrahedron of the centres and one of these points:
/// it lies in the union, so that the shares of balls, lenses and the common part add up to it.
#[test]
fn three_balls() {
    let mut random = Random::new(2);
    let mut count = 0;
    while count < 1_000 {
        let centres: [Point; 3] = [(); 3].map(|()| [(); 3].map(|()| random.unit() * 1.5));
        let radii = [(); 3].map(|()| 0.8 + 0.6 * random.unit());
        let Some(meeting) = meeting_point(centres, radii) else { continue };
        let tetrahedron = [centres[0], centres[1], centres[2], meeting];
        // The formula needs the meeting point on the outside of every pair.
        let distances = [[0, 1], [1, 2], [2, 0]].map(|[i, j]| length(minus(centres[i], centres[j])));
        if distances.iter().any(|&d| d < 0.3) {
            continue;
        }
        count += 1;
        let mut share = volume_of(tetrahedron);
        let mut union = 0.0;
        for i in 0..3 {
            let [j, k] = [(i + 1) % 3, (i + 2) % 3];
            let solid = solid_angle(centres[i], [centres[j], centres[k], meeting]);
            share -= solid / (4.0 * PI) * ball_volume(radii[i]);
            let pair = lens(radii[i], radii[j], distances[i]);
            let dihedral = dihedral([centres[i], centres[j]], centres[k], meeting);
            share += dihedral / (2.0 * PI) * pair;
            union += ball_volume(radii[i]) - pair;
        }
        let cells = measured(&centres, &radii);
        assert_near(volume(&cells), union + 2.0 * share, 4e-12, &format!("{centres:?} {radii:?}"));
    }
}

/// A centre in the planes of two faces sees them both edge on.
#[test]
fn centres_in_two_planes() {
    // A quarter of the ball: dihedral angle of the planes through its centre.
    let cells = measured(&[[0.0; 3], [1.0, 0.0, 1.0], [0.0, 0.0, 2.0]], &[1.5, 0.5, 1.5]);
    assert_near(cells.cells[1].area, 4.0 * PI * 0.25 / 4.0, 1e-7, "a quarter of a sphere");
    assert_near(cells.cells[1].volume, ball_volume(0.5) / 4.0, 1e-7, "a quarter of a ball");
    let outer = measured(&[[0.0, 0.5, 0.0], [-2.0, 0.0, 0.0], [1.0, 0.0, 0.0]], &[4.5, 4.0, 5.0]);
    assert_near(outer.cells[1].area, 92.69, 0.01, "area");
    assert_near(outer.cells[1].volume, 123.59, 0.01, "volume");
}

#[test]
fn numbers_that_are_too_large_are_refused() {
    for bad in [1e61, -1e154, 1e308] {
        let balls = Balls { centres: &[[0.0; 3], [bad, 0.0, 0.0]], radii: &[1.0, 1.0] };
        let error = measure(balls, None, NonZeroUsize::MIN).expect_err("too large");
        assert!(error.to_string().contains("too large"), "{error}");
    }
    let far = measured(&[[0.0; 3], [1e59, 0.0, 0.0], [0.0, 1e59, 1e59]], &[1.0; 3]);
    assert_near(area(&far), 12.0 * PI, 1e-9, "far apart");
}

#[test]
fn lattices_have_cubes_as_cells() {
    for (step, offset) in [(1.0, 0.0), (1_000.0, 7.0), (0.1, 0.3)] {
        let centres: Vec<Point> =
            (0..343).map(|i| [i % 7, i / 7 % 7, i / 49].map(|c| f64::from(c) * step + offset)).collect();
        let cells = measured(&centres, &vec![0.9 * step; 343]);
        let middle = 3 + 7 * 3 + 49 * 3;
        assert_near(cells.cells[middle].volume, step.powi(3), 1e-12 * step.powi(3), "a cube");
        assert_eq!(cells.cells[middle].area, 0.0);
        let faces: Vec<f64> = cells
            .contacts
            .iter()
            .filter(|contact| contact.balls.contains(&(middle as u32)) && contact.area > 1e-9 * step * step)
            .map(|contact| contact.area)
            .collect();
        assert_eq!(faces.len(), 6);
        faces.iter().for_each(|&face| assert_near(face, step * step, 1e-12 * step * step, "a side"));
    }
}

#[test]
fn balls_in_a_plane_and_on_a_line() {
    let line: Vec<Point> = (0..9).map(|i| [f64::from(i), 0.0, 0.0]).collect();
    let cells = measured(&line, &[1.0; 9]);
    assert_near(area(&cells), 2.0 * PI * (8.0 + 2.0), 1e-12, "area of a chain");
    assert_eq!(cells.contacts.len(), 8);
    let plane: Vec<Point> = (0..25).map(|i| [f64::from(i % 5), f64::from(i / 5), 2.0]).collect();
    let cells = measured(&plane, &[0.5; 25]);
    assert_near(volume(&cells), 25.0 * ball_volume(0.5), 1e-11, "balls that touch");
}

#[test]
fn equal_centres_are_one_cell() {
    let cells = measured(&[[1.0; 3], [1.0; 3], [1.0; 3]], &[1.0, 2.0, 2.0]);
    let volumes: Vec<f64> = cells.cells.iter().map(|cell| cell.volume).collect();
    assert_eq!((volumes[0], volumes[2]), (0.0, 0.0));
    assert_near(volumes[1], ball_volume(2.0), 1e-12, "the largest");
}

/// Every point of a sample decides for itself which cell it is in.
#[test]
fn random_balls_against_sampling() {
    for seed in 0..6 {
        let mut random = Random::new(seed);
        let count = 30;
        let side = 1.0 + seed as f64 * 0.6;
        let centres: Vec<Point> = (0..count).map(|_| [(); 3].map(|()| random.unit() * side)).collect();
        let radii: Vec<f64> = (0..count).map(|_| 0.2 + random.unit() * 0.6).collect();
        let cells = measured(&centres, &radii);
        let power = |p: Point, i: usize| square(minus(p, centres[i])) - radii[i] * radii[i];
        for i in 0..count {
            assert_sphere(&mut random, i, &centres, &radii, &cells);
        }
        for contact in cells.contacts.iter() {
            let [i, j] = contact.balls.map(|ball| ball as usize);
            let (rho, mut point_in_disk) = disk(&mut random, [centres[i], centres[j]], [radii[i], radii[j]]);
            let samples = 4_000;
            let inside = (0..samples)
                .filter(|_| {
                    let p = point_in_disk();
                    let own = power(p, i);
                    (0..count).filter(|&k| k != i && k != j).all(|k| power(p, k) > own)
                })
                .count();
            let disk = PI * rho * rho;
            assert_near(contact.area, inside as f64 / f64::from(samples) * disk, 0.04 * disk, "face");
        }
        let samples = 200_000;
        let low = -1.0;
        let high = side + 1.0;
        let mut hits = vec![0; count];
        for _ in 0..samples {
            let p = [(); 3].map(|()| low + random.unit() * (high - low));
            let nearest = (0..count).min_by(|&i, &j| power(p, i).total_cmp(&power(p, j))).expect("balls");
            hits[nearest] += i32::from(power(p, nearest) < 0.0);
        }
        let box_volume = f64::powi(high - low, 3);
        for (i, &hits) in hits.iter().enumerate() {
            let share = cells.cells[i].volume / box_volume;
            let deviation = (share * (1.0 - share) / f64::from(samples)).sqrt() + 1e-6;
            assert_near(f64::from(hits) / f64::from(samples), share, 5.0 * deviation, "volume");
        }
    }
}

fn assert_sphere(random: &mut Random, i: usize, centres: &[Point], radii: &[f64], cells: &Cells) {
    let samples = 4_000;
    let exposed = (0..samples)
        .filter(|_| {
            let direction = unit_vector(random);
            let p = [0, 1, 2].map(|axis| centres[i][axis] + radii[i] * direction[axis]);
            (0..centres.len()).all(|k| k == i || square(minus(p, centres[k])) > radii[k] * radii[k])
        })
        .count();
    let sphere = 4.0 * PI * radii[i] * radii[i];
    assert_near(cells.cells[i].area, exposed as f64 / f64::from(samples) * sphere, 0.04 * sphere, "area");
}

/// The radius of the disk that two spheres bound, and random points of it.
fn disk<'r>(
    random: &'r mut Random,
    [p, q]: [Point; 2],
    [r, s]: [f64; 2],
) -> (f64, impl FnMut() -> Point + use<'r>) {
    let between = minus(q, p);
    let d = length(between);
    let x = (d * d + r * r - s * s) / (2.0 * d);
    let n = between.map(|c| c / d);
    let rho = (r * r - x * x).max(0.0).sqrt();
    let aside = if n[0].abs() < 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let u = cross(n, aside);
    let u = u.map(|c| c / length(u));
    let v = cross(n, u);
    let point = move || loop {
        let [a, b] = [(); 2].map(|()| 2.0 * random.unit() - 1.0);
        if a * a + b * b < 1.0 {
            return [0, 1, 2].map(|i| p[i] + x * n[i] + rho * (a * u[i] + b * v[i]));
        }
    };
    (rho, point)
}

/// A point of all three spheres, if there is one off the plane of their centres.
fn meeting_point(centres: [Point; 3], radii: [f64; 3]) -> Option<Point> {
    let [b, c] = [1, 2].map(|i| minus(centres[i], centres[0]));
    let normal = cross(b, c);
    // X = s b + t c + u n.
    let [p, q] = [(b, 1), (c, 2)]
        .map(|(v, i): (Point, usize)| 0.5 * (square(v) - radii[i] * radii[i] + radii[0] * radii[0]));
    let determinant = square(b) * square(c) - dot(b, c).powi(2);
    let s = (p * square(c) - q * dot(b, c)) / determinant;
    let t = (q * square(b) - p * dot(b, c)) / determinant;
    let flat = [0, 1, 2].map(|i| s * b[i] + t * c[i]);
    let rest = radii[0] * radii[0] - square(flat);
    (rest > 0.01).then(|| {
        let u = rest.sqrt() / length(normal);
        [0, 1, 2].map(|i| centres[0][i] + flat[i] + u * normal[i])
    })
}

fn volume_of([a, b, c, d]: [Point; 4]) -> f64 {
    dot(minus(b, a), cross(minus(c, a), minus(d, a))).abs() / 6.0
}

/// Solid angle of a tetrahedron at `apex`, by the dihedral angles at its three edges (Girard).
fn solid_angle(apex: Point, [a, b, c]: [Point; 3]) -> f64 {
    dihedral([apex, a], b, c) + dihedral([apex, b], c, a) + dihedral([apex, c], a, b) - PI
}

/// Angle at an edge between the half-planes through two points.
fn dihedral([p, q]: [Point; 2], a: Point, b: Point) -> f64 {
    let axis = minus(q, p);
    let (m, n) = (cross(axis, minus(a, p)), cross(axis, minus(b, p)));
    length(cross(m, n)).atan2(dot(m, n))
}
