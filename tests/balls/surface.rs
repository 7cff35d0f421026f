//! Molecular surfaces against closed forms, and against sampling by their definition: excluded is what is at
//! least the radius of the probe away from every point that its centre can reach.

use super::vectors::{Point, along, cross, dot, minus, square, unit_vector};
use spmesh_molecules::balls::{Balls, Cell, measure, molecular_surface};
use spmesh_reference::sets::Random;
use std::f64::consts::PI;
use std::num::NonZeroUsize;

/// `radii` are those without the probe.
fn surface(centres: &[Point], radii: &[f64], probe: f64) -> Vec<Cell> {
    let radii: Vec<f64> = radii.iter().map(|radius| radius + probe).collect();
    molecular_surface(Balls { centres, radii: &radii }, probe, NonZeroUsize::MIN).expect("finite balls")
}

fn total(cells: &[Cell]) -> [f64; 2] {
    [cells.iter().map(|cell| cell.area).sum(), cells.iter().map(|cell| cell.volume).sum()]
}

fn assert_near(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found - expected).abs() <= tolerance, "{what}: {found}, not {expected}");
}

fn sphere(r: f64) -> [f64; 2] {
    [4.0 * PI * r * r, 4.0 / 3.0 * PI * r.powi(3)]
}

#[test]
fn balls_far_apart_and_within_one_another() {
    let [area, volume] = total(&surface(&[[3.0, -4.0, 5.0]], &[2.5], 1.4));
    assert_near(area, sphere(2.5)[0], 1e-12, "area of one");
    assert_near(volume, sphere(2.5)[1], 1e-12, "volume of one");
    assert!(surface(&[], &[], 1.0).is_empty());
    let point = surface(&[[1.0; 3]], &[0.0], 1.0);
    assert_near(point[0].area, 0.0, 1e-15, "area of a point");
    assert_near(point[0].volume, 0.0, 1e-14, "volume of a point");
    // The probe passes between.
    let [area, volume] = total(&surface(&[[0.0; 3], [5.1, 0.0, 0.0]], &[1.0, 2.0], 1.0));
    assert_near(area, sphere(1.0)[0] + sphere(2.0)[0], 1e-12, "area of two");
    assert_near(volume, sphere(1.0)[1] + sphere(2.0)[1], 1e-12, "volume of two");
    let inner = surface(&[[0.0; 3], [0.5, 0.0, 0.0]], &[2.0, 1.0], 1.0);
    assert_eq!((inner[1].area, inner[1].volume), (0.0, 0.0));
    assert_near(inner[0].volume, sphere(2.0)[1], 1e-12, "the outer ball");
}

/// The body of two balls is one of revolution.
#[test]
fn two_balls() {
    let mut random = Random::new(1);
    let (mut cusps, mut behind) = (0, 0);
    for _ in 0..300 {
        let (r, s, p) = (0.2 + random.unit(), 0.2 + 2.0 * random.unit(), 0.2 + random.unit());
        let (least, most) = ((r - s).abs(), r + s + 2.0 * p);
        let d = least + (most - least) * (0.05 + 0.9 * random.unit());
        // Distance of the circle's plane from the first centre, and the circle's radius.
        let x = (d * d + (r + p).powi(2) - (s + p).powi(2)) / (2.0 * d);
        let rho = ((r + p).powi(2) - x * x).sqrt();
        cusps += i32::from(rho < p);
        behind += i32::from(x < 0.0 || x > d);
        let [mut area, mut volume] = [0.0; 2];
        // Where the probe touches the balls.
        let [from, to] = [x * r / (r + p), d - (d - x) * s / (s + p)];
        for (radius, cap) in [(r, from), (s, d - to)] {
            area += 2.0 * PI * radius * (radius + cap);
            volume += PI * (2.0 / 3.0 * radius.powi(3) + radius * radius * cap - cap.powi(3) / 3.0);
        }
        let steps = 20_000;
        let angle = |at: f64| ((at - x) / p).asin();
        let width = (angle(to) - angle(from)) / f64::from(steps);
        for step in 0..steps {
            let theta = angle(from) + width * (f64::from(step) + 0.5);
            let height = (rho - p * theta.cos()).max(0.0);
            area += 2.0 * PI * height * p * width;
            volume += PI * height * height * p * theta.cos() * width;
        }
        let axis = unit_vector(&mut random);
        let cells = surface(&[[0.0; 3], axis.map(|c| d * c)], &[r, s], p);
        let [found_area, found_volume] = total(&cells);
        assert_near(found_area, area, 2e-6 * area, &format!("area of {r} {s} {p} {d}"));
        assert_near(found_volume, volume, 2e-6 * volume, &format!("volume of {r} {s} {p} {d}"));
    }
    assert!(cusps > 25 && behind > 20, "{cusps} {behind}");
}

/// Three balls that a probe touches in three directions at right angles: its patch is an octant.
#[test]
fn three_balls() {
    let (r, p) = (1.7, 1.1);
    let big = r + p;
    let centres = [[big, 0.0, 0.0], [0.0, big, 0.0], [0.0, 0.0, big]];
    let exposed = measure(Balls { centres: &centres, radii: &[big; 3] }, None, NonZeroUsize::MIN);
    let exposed: f64 = exposed.expect("finite balls").cells.iter().map(|cell| cell.area).sum();
    // The third ball covers the angle between the two corners on a circle, whose cosine is -1/3.
    let arc = 2.0 * PI - (-1.0f64 / 3.0).acos();
    let saddle = p * (big / 2.0f64.sqrt() * PI / 2.0 - p * 2.0f64.sqrt());
    let concave = 2.0 * sphere(p)[0] / 8.0;
    let expected = exposed * (r / big).powi(2) + 3.0 * arc * saddle + concave;
    let cells = surface(&centres, &[r; 3], p);
    assert_near(total(&cells)[0], expected, 1e-12 * expected, "area");
    for cell in &cells {
        assert_near(cell.area, expected / 3.0, 1e-12 * expected, "a third");
    }
}

#[test]
fn without_a_probe_it_is_the_union() {
    let mut random = Random::new(5);
    let (centres, radii) = random_balls(&mut random, 40, 4.0, 0.5);
    let cells = measure(Balls { centres: &centres, radii: &radii }, None, NonZeroUsize::MIN);
    assert_eq!(surface(&centres, &radii, 0.0), cells.expect("finite balls").cells);
}

#[test]
fn probes_must_be_smaller_than_balls() {
    for probe in [-0.1, 1.1, f64::NAN, f64::INFINITY] {
        let balls = Balls { centres: &[[0.0; 3]], radii: &[1.0] };
        let error = molecular_surface(balls, probe, NonZeroUsize::MIN).expect_err("no radius of a probe");
        assert!(error.to_string().contains("expected 0 to 1"), "{error}");
    }
}

/// The volume shrinks with the level by the area, also where patches cut one another.
#[test]
fn areas_are_derivatives_of_volumes() {
    let mut random = Random::new(6);
    let mut rough = 0;
    for round in 0..40 {
        let (centres, radii) = random_balls(&mut random, 40, 2.0 + 0.1 * f64::from(round), 0.7);
        let at = |probe: f64| {
            let balls = Balls { centres: &centres, radii: &radii };
            total(&molecular_surface(balls, probe, NonZeroUsize::MIN).expect("finite balls"))
        };
        for probe in [0.05, 0.2, 0.4, 0.65] {
            let step = 1e-4;
            let derivative = (at(probe - step)[1] - at(probe + step)[1]) / (2.0 * step);
            let area = at(probe)[0];
            assert_near(area, derivative, 1e-3 * area, &format!("round {round}, {probe}"));
            // At some levels a patch begins or ends between the two.
            rough += i32::from((area - derivative).abs() > 1e-6 * area);
        }
    }
    assert!(rough < 10, "{rough}");
}

/// Lattices are full of ties: more than three spheres meet, and bisectors coincide.
#[test]
fn lattices() {
    for (radius, probe) in [(0.55, 0.1), (0.3, 0.4), (0.1, 0.45), (0.05, 0.6), (0.0, 0.8)] {
        let axis = 0..4;
        let sites = axis.clone().flat_map(|x| axis.clone().map(move |y| (x, y)));
        let centres: Vec<Point> =
            sites.flat_map(|(x, y)| axis.clone().map(move |z| [x, y, z].map(f64::from))).collect();
        let cells = surface(&centres, &vec![radius; centres.len()], probe);
        let shaken: Vec<Point> = {
            let mut random = Random::new(9);
            centres.iter().map(|p| p.map(|c| c + 1e-7 * random.unit())).collect()
        };
        let [area, volume] = total(&cells);
        let [other_area, other_volume] = total(&surface(&shaken, &vec![radius; centres.len()], probe));
        let what = format!("{radius} {probe}");
        assert_near(area, other_area, 1e-4 * (1.0 + area), &what);
        assert_near(volume, other_volume, 1e-4 * (1.0 + volume), &what);
    }
}

#[test]
fn random_balls_against_sampling() {
    let (mut kinds, mut cut) = ([0; 3], 0);
    for seed in 0..12 {
        let mut random = Random::new(100 + seed);
        let probe = [0.3, 0.6, 0.9][seed as usize % 3];
        let side = 2.0 + 0.25 * seed as f64;
        let (centres, radii) = random_balls(&mut random, 16, side, probe + 0.05);
        let balls = Balls { centres: &centres, radii: &radii };
        let cells = molecular_surface(balls, probe, NonZeroUsize::MIN).expect("finite balls");
        let reach = Reach::new(&centres, &radii);
        assert_volumes(&mut random, &reach, probe, &cells, &mut kinds);
        cut += assert_areas(&mut random, &reach, probe, &cells);
    }
    assert!(kinds.iter().all(|&count| count > 1_000), "{kinds:?}");
    assert!(cut > 30, "{cut} patches are cut");
}

/// Radii from `least` to 0.6 more.
fn random_balls(random: &mut Random, count: usize, side: f64, least: f64) -> (Vec<Point>, Vec<f64>) {
    let centres = (0..count).map(|_| [(); 3].map(|()| random.unit() * side)).collect();
    (centres, (0..count).map(|_| least + random.unit() * 0.6).collect())
}

/// Volumes of all balls: each point decides in which cell it is, and whether it is excluded; else it counts
/// for the ball of least power of those that its nearest point of the boundary is on.
fn assert_volumes(
    random: &mut Random,
    reach: &Reach<'_>,
    probe: f64,
    cells: &[Cell],
    kinds: &mut [usize; 3],
) {
    let count = cells.len();
    let samples = 60_000;
    let lower = [0, 1, 2].map(|axis| reach.extent(axis, -1.0));
    let sides = [0, 1, 2].map(|axis| reach.extent(axis, 1.0) - lower[axis]);
    let (mut sums, mut squares) = (vec![0i32; count], vec![0i32; count]);
    for _ in 0..samples {
        let p = [0, 1, 2].map(|axis| lower[axis] + random.unit() * sides[axis]);
        let own = least(0..count, |i| reach.power(p, i));
        if reach.power(p, own) >= 0.0 {
            continue;
        }
        let (distance, on) = reach.nearest(p);
        sums[own] += 1;
        squares[own] += 1;
        if distance < probe {
            kinds[on.len() - 1] += 1;
            let of = least(on.into_iter(), |i| reach.power(p, i));
            sums[of] -= 1;
            squares[own] -= i32::from(of == own);
            squares[of] += i32::from(of != own);
        }
    }
    let whole: f64 = sides.iter().product();
    let compare = |volume: f64, sum: i32, square: i32, what: &str| {
        let deviation = (f64::from(square) + 10.0).sqrt() / f64::from(samples) * whole;
        assert_near(volume, f64::from(sum) / f64::from(samples) * whole, 5.0 * deviation, what);
    };
    for i in 0..count {
        compare(cells[i].volume, sums[i], squares[i], "volume of a ball");
    }
    compare(total(cells)[1], sums.iter().sum(), squares.iter().sum(), "volume of all");
}

/// Areas of all balls: points on spheres, tori and probes decide whether they are excluded, just so. Returns
/// how many patches of probes are cut by others.
fn assert_areas(random: &mut Random, reach: &Reach<'_>, probe: f64, cells: &[Cell]) -> usize {
    let count = cells.len();
    let mut areas = vec![0.0; count];
    let mut variances = vec![1e-6; count];
    // Half of all samples of an element of area `whole` are taken for the share of a ball, at most.
    let mut add = |i: usize, weight: f64| {
        areas[i] += weight;
        variances[i] += weight * weight;
    };
    let is_on = |p: Point| reach.nearest(p).0 >= probe - 1e-9;
    let samples = 1_500;
    let share = 1.0 / f64::from(samples);
    for i in 0..count {
        let radius = reach.radii[i] - probe;
        for _ in 0..samples {
            let out = unit_vector(random);
            let [p, rest] = [radius, reach.radii[i]].map(|by| along(reach.centres[i], by, out));
            if reach.is_free(rest) && is_on(p) {
                add(i, 4.0 * PI * radius * radius * share);
            }
        }
    }
    for circle in &reach.circles {
        for _ in 0..samples {
            let [phi, theta] = [(); 2].map(|()| 2.0 * PI * random.unit());
            let out = [0, 1, 2].map(|a| circle.axes[0][a] * phi.cos() + circle.axes[1][a] * phi.sin());
            let rest = along(circle.middle, circle.rho, out);
            let p = along(along(rest, -probe * theta.cos(), out), probe * theta.sin(), circle.normal);
            let height = circle.rho - probe * theta.cos();
            if height > 0.0 && reach.is_free(rest) && is_on(p) {
                let of = least(circle.balls.into_iter(), |i| reach.power(p, i));
                add(of, 4.0 * PI * PI * probe * height * share);
            }
        }
    }
    let mut cut = 0;
    for (at, balls) in &reach.corners {
        let mut lost = 0;
        for _ in 0..samples {
            let p = along(*at, probe, unit_vector(random));
            let (distance, on) = reach.nearest(p);
            if distance >= probe - 1e-9 && is_in_cone(p, *at, balls.map(|i| reach.centres[i])) {
                let of = least(balls.iter().copied(), |i| reach.power(p, i));
                add(of, 4.0 * PI * probe * probe * share);
            }
            lost += i32::from(on.len() == 3 && distance < probe - 1e-9);
        }
        cut += usize::from(lost > 20);
    }
    for i in 0..count {
        assert_near(cells[i].area, areas[i], 5.0 * variances[i].sqrt() + 0.003, &format!("area of {i}"));
    }
    let deviation = variances.iter().sum::<f64>().sqrt();
    assert_near(total(cells)[0], areas.iter().sum(), 5.0 * deviation, "area of all");
    cut
}

/// What the centre of the probe can reach: all candidates for the nearest of its points.
struct Reach<'b> {
    centres: &'b [Point],
    radii: &'b [f64],
    circles: Vec<Circle>,
    /// Points on three spheres that no ball covers.
    corners: Vec<(Point, [usize; 3])>,
}

/// Where two spheres meet.
struct Circle {
    balls: [usize; 2],
    middle: Point,
    rho: f64,
    normal: Point,
    axes: [Point; 2],
}

impl<'b> Reach<'b> {
    fn new(centres: &'b [Point], radii: &'b [f64]) -> Self {
        let mut reach = Reach { centres, radii, circles: Vec::new(), corners: Vec::new() };
        let count = centres.len();
        for i in 0..count {
            for j in 0..i {
                let Some(circle) = circle([i, j], centres, radii) else { continue };
                for k in 0..j {
                    let corners = circle.meets(centres[k], radii[k]);
                    let free = corners.into_iter().flatten().filter(|&p| reach.is_free(p));
                    reach.corners.extend(free.map(|p| (p, [i, j, k])).collect::<Vec<_>>());
                }
                reach.circles.push(circle);
            }
        }
        reach
    }

    fn power(&self, p: Point, i: usize) -> f64 {
        square(minus(p, self.centres[i])) - self.radii[i] * self.radii[i]
    }

    fn is_free(&self, p: Point) -> bool {
        (0..self.centres.len()).all(|i| self.power(p, i) >= -1e-9)
    }

    /// Distance of the nearest point that can be reached, and the balls on whose spheres it is.
    fn nearest(&self, p: Point) -> (f64, Vec<usize>) {
        if (0..self.centres.len()).all(|i| self.power(p, i) >= 0.0) {
            return (0.0, Vec::new());
        }
        let (mut best, mut on) = (f64::INFINITY, Vec::new());
        let mut offer = |q: Point, balls: &[usize], is_free: bool| {
            let distance = square(minus(p, q)).sqrt();
            if distance < best && (is_free || self.is_free(q)) {
                (best, on) = (distance, balls.to_vec());
            }
        };
        for (corner, balls) in &self.corners {
            offer(*corner, balls, true);
        }
        for circle in &self.circles {
            offer(circle.nearest(p), &circle.balls, false);
        }
        for (i, &centre) in self.centres.iter().enumerate() {
            let out = minus(p, centre);
            let size = square(out).sqrt();
            offer(along(centre, self.radii[i] / size, out), &[i], false);
        }
        (best, on)
    }

    /// The end of the box of all balls on an axis.
    fn extent(&self, axis: usize, sign: f64) -> f64 {
        let ends = self.centres.iter().zip(self.radii).map(|(p, r)| sign * p[axis] + r);
        sign * ends.fold(f64::NEG_INFINITY, f64::max)
    }
}

fn circle(balls: [usize; 2], centres: &[Point], radii: &[f64]) -> Option<Circle> {
    let [i, j] = balls;
    let between = minus(centres[j], centres[i]);
    let d = square(between).sqrt();
    let x = (d * d + radii[i] * radii[i] - radii[j] * radii[j]) / (2.0 * d);
    let normal = between.map(|c| c / d);
    let aside = if normal[0].abs() < 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let first = cross(normal, aside);
    let first = first.map(|c| c / square(first).sqrt());
    let rest = radii[i] * radii[i] - x * x;
    let middle = along(centres[i], x, normal);
    let axes = [first, cross(normal, first)];
    (rest > 0.0).then(|| Circle { balls, middle, rho: rest.sqrt(), normal, axes })
}

impl Circle {
    fn nearest(&self, p: Point) -> Point {
        let [x, y] = self.axes.map(|axis| dot(axis, minus(p, self.middle)));
        let scale = self.rho / x.hypot(y);
        along(along(self.middle, x * scale, self.axes[0]), y * scale, self.axes[1])
    }

    /// Where a sphere meets the circle.
    fn meets(&self, centre: Point, radius: f64) -> [Option<Point>; 2] {
        let to = minus(centre, self.middle);
        let [x, y] = self.axes.map(|axis| dot(axis, to));
        // |middle + rho e - centre| = radius.
        let cosine = (square(to) + self.rho * self.rho - radius * radius) / (2.0 * self.rho * x.hypot(y));
        [1.0, -1.0].map(|sign| {
            let angle = y.atan2(x) + sign * cosine.acos();
            let out = [0, 1, 2].map(|a| self.axes[0][a] * angle.cos() + self.axes[1][a] * angle.sin());
            (cosine.abs() < 1.0).then(|| along(self.middle, self.rho, out))
        })
    }
}

/// Whether a point is in the cone of three points.
fn is_in_cone(p: Point, apex: Point, points: [Point; 3]) -> bool {
    let [a, b, c] = points.map(|q| minus(q, apex));
    let x = minus(p, apex);
    let whole = dot(a, cross(b, c)).signum();
    [cross(b, c), cross(c, a), cross(a, b)].iter().all(|&normal| dot(x, normal) * whole >= 0.0)
}

fn least(items: impl Iterator<Item = usize>, of: impl Fn(usize) -> f64) -> usize {
    items.min_by(|&i, &j| of(i).total_cmp(&of(j))).expect("not empty")
}
