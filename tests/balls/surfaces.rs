//! Meshes of surfaces and faces of balls: closed, on the spheres, and with the exact areas in the limit. The
//! checks know triangles and balls only.

use std::collections::{HashMap, HashSet};
use std::f64::consts::PI;
use std::num::NonZeroUsize;

use super::vectors::{Point, cross, dot, minus};
use spmesh_molecules::balls::{Balls, Faces, Surface, faces, measure, pockets, surface};
use spmesh_reference::sets::Random;

fn meshed(centres: &[Point], radii: &[f64], step: f64) -> Surface {
    let surface = surface(Balls { centres, radii }, step, NonZeroUsize::MIN).expect("finite balls");
    check_closed(&surface.triangles);
    check_on_spheres(&surface, centres, radii);
    assert_eq!(surface.left_out, 0);
    surface
}

/// Each edge belongs to two triangles, which run along it in opposite directions.
pub(super) fn check_closed(triangles: &[[u32; 3]]) {
    let mut edges: HashMap<[u32; 2], [u32; 2]> = HashMap::new();
    for &[a, b, c] in triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            edges.entry([from.min(to), from.max(to)]).or_default()[usize::from(from > to)] += 1;
        }
    }
    let open: Vec<_> = edges.iter().filter(|(_, uses)| **uses != [1, 1]).collect();
    assert!(open.is_empty(), "{} of {} edges: {:?}", open.len(), edges.len(), open.first());
}

/// Corners of a triangle are on the sphere of its ball, and in no other ball.
fn check_on_spheres(surface: &Surface, centres: &[Point], radii: &[f64]) {
    let away =
        |at: Point, ball: usize| dot(minus(at, centres[ball]), minus(at, centres[ball])).sqrt() - radii[ball];
    for (triangle, &ball) in surface.triangles.iter().zip(&surface.balls) {
        let corners = triangle.map(|node| surface.points[node as usize]);
        for (node, at) in triangle.iter().zip(corners) {
            assert!(away(at, ball as usize).abs() < 1e-6, "{ball}: {}", away(at, ball as usize));
            let normal = surface.normals[*node as usize];
            assert!((dot(normal, normal) - 1.0).abs() < 1e-9);
        }
    }
    for (at, &owner) in surface.points.iter().zip(&surface.owners) {
        assert!(away(*at, owner as usize).abs() < 1e-6);
        for ball in 0..centres.len() {
            assert!(away(*at, ball) > -1e-6, "{ball} covers a vertex of {owner} by {}", -away(*at, ball));
        }
    }
}

pub(super) fn area(surface: &Surface) -> f64 {
    let twice = |[a, b, c]: [Point; 3]| {
        let normal = cross(minus(b, a), minus(c, a));
        dot(normal, normal).sqrt()
    };
    surface.triangles.iter().map(|t| twice(t.map(|node| surface.points[node as usize])) / 2.0).sum()
}

/// The volume that is enclosed, by component: those of voids are negative.
pub(super) fn volumes(surface: &Surface) -> Vec<f64> {
    let mut group: Vec<usize> = (0..surface.points.len()).collect();
    fn root(group: &mut [usize], mut at: usize) -> usize {
        while group[at] != at {
            group[at] = group[group[at]];
            at = group[at];
        }
        at
    }
    for triangle in &surface.triangles {
        for side in 1..3 {
            let [p, q] = [triangle[0], triangle[side]].map(|node| root(&mut group, node as usize));
            group[p] = q;
        }
    }
    let mut sums: HashMap<usize, f64> = HashMap::new();
    for triangle in &surface.triangles {
        let [a, b, c] = triangle.map(|node| surface.points[node as usize]);
        *sums.entry(root(&mut group, triangle[0] as usize)).or_default() += dot(a, cross(b, c)) / 6.0;
    }
    sums.into_values().collect()
}

fn euler(surface: &Surface) -> i64 {
    let mut edges = HashSet::new();
    for &[a, b, c] in &surface.triangles {
        edges.extend([[a, b], [b, c], [c, a]].map(|[p, q]| [p.min(q), p.max(q)]));
    }
    surface.points.len() as i64 - edges.len() as i64 + surface.triangles.len() as i64
}

fn random_balls(seed: u64, count: usize, side: f64) -> (Vec<Point>, Vec<f64>) {
    let mut random = Random::new(seed);
    (0..count).map(|_| ([(); 3].map(|()| side * random.unit()), 0.4 + 0.8 * random.unit())).unzip()
}

#[test]
fn areas_and_volumes_converge_to_the_exact_ones() {
    let (centres, radii) = random_balls(1, 60, 3.5);
    let exact = measure(Balls { centres: &centres, radii: &radii }, None, NonZeroUsize::MIN).unwrap().cells;
    let [exact_area, exact_volume] =
        [exact.iter().map(|cell| cell.area).sum::<f64>(), exact.iter().map(|cell| cell.volume).sum::<f64>()];
    let mut last = [f64::INFINITY; 2];
    for step in [0.4, 0.2, 0.1, 0.05] {
        let mesh = meshed(&centres, &radii, step);
        let lacks = [exact_area - area(&mesh), exact_volume - volumes(&mesh).iter().sum::<f64>()];
        // Inscribed: the error is of second order, and half the step leaves a quarter.
        for (lack, last) in lacks.iter().zip(&mut last) {
            assert!(*lack > 0.0 && *lack < 0.4 * *last, "step {step}: {lack} after {last}");
            *last = *lack;
        }
    }
    assert!(last[0] < 1e-3 * exact_area && last[1] < 1e-3 * exact_volume, "{last:?}");
}

#[test]
fn random_balls_have_closed_surfaces() {
    let mut voids = 0;
    for seed in 0..200 {
        let (centres, radii) = random_balls(seed, 4 + seed as usize, 1.0 + (seed % 10) as f64 * 0.5);
        let mesh = meshed(&centres, &radii, [0.9, 0.3, 5.0][seed as usize % 3]);
        let components = volumes(&mesh);
        assert!(euler(&mesh) % 2 == 0 && euler(&mesh) <= 2 * components.len() as i64, "{seed}");
        let found = pockets(Balls { centres: &centres, radii: &radii }).unwrap();
        let closed = found.iter().filter(|pocket| pocket.mouths.is_empty()).count();
        assert_eq!(components.iter().filter(|&&volume| volume < 0.0).count(), closed, "{seed}");
        voids += closed;
    }
    assert!(voids > 20, "{voids}");
}

#[test]
fn few_balls_by_hand() {
    let sphere = meshed(&[[1.0, 2.0, 3.0]], &[1.5], 0.1);
    assert!((area(&sphere) - 9.0 * PI).abs() < 0.02 * 9.0 * PI && euler(&sphere) == 2);
    // A small cap on a large ball, with no vertex inside at this step.
    let cap = meshed(&[[0.0; 3], [1.9, 0.0, 0.0]], &[2.0, 0.2], 1.0);
    assert_eq!(euler(&cap), 2);
    // A ring of balls is a torus.
    let ring: Vec<Point> =
        (0..12).map(|i| (PI / 6.0 * f64::from(i)).sin_cos()).map(|(y, x)| [3.0 * x, 3.0 * y, 0.0]).collect();
    assert_eq!(euler(&meshed(&ring, &[1.0; 12], 0.3)), 0);
    // Apart, touching, hidden, and two at one place.
    assert_eq!(euler(&meshed(&[[0.0; 3], [3.0, 0.0, 0.0]], &[1.0, 1.0], 0.3)), 4);
    assert_eq!(euler(&meshed(&[[0.0; 3], [2.0, 0.0, 0.0]], &[1.0, 1.0], 0.3)), 4);
    assert_eq!(euler(&meshed(&[[0.0; 3], [0.1, 0.0, 0.0], [0.0; 3]], &[1.0, 0.2, 1.0], 0.3)), 2);
    assert!(surface(Balls { centres: &[], radii: &[] }, 0.1, NonZeroUsize::MIN).unwrap().points.is_empty());
}

/// Many spheres through one point, and circles that touch.
#[test]
fn lattices_have_closed_surfaces() {
    let lattice = |side: i32| {
        let range = move || 0..side;
        range().flat_map(move |x| range().flat_map(move |y| range().map(move |z| [x, y, z].map(f64::from))))
    };
    for radius in [0.5, 0.6, 0.5f64.sqrt(), 0.8, 0.75f64.sqrt(), 0.9] {
        let centres: Vec<Point> = lattice(3).collect();
        let mesh =
            surface(Balls { centres: &centres, radii: &[radius; 27] }, 0.2, NonZeroUsize::MIN).unwrap();
        // Where eight spheres meet in a point, rounding leaves the borders in doubt, and the mesh says so.
        assert!(mesh.left_out == 0 || radius == 0.75f64.sqrt(), "{radius}: {} left out", mesh.left_out);
        check_on_spheres(&mesh, &centres, &[radius; 27]);
        check_closed(&mesh.triangles);
    }
}

#[test]
fn the_step_is_checked() {
    for step in [0.0, -1.0, f64::NAN, 0.004] {
        let balls = Balls { centres: &[[0.0; 3]], radii: &[1.0] };
        assert!(surface(balls, step, NonZeroUsize::MIN).unwrap_err().to_string().contains("step"), "{step}");
    }
}

#[test]
fn threads_make_no_difference() {
    let (centres, radii) = random_balls(5, 400, 7.0);
    let balls = Balls { centres: &centres, radii: &radii };
    let one = surface(balls, 0.3, NonZeroUsize::MIN).unwrap();
    assert_eq!(one, surface(balls, 0.3, NonZeroUsize::new(3).unwrap()).unwrap());
}

/// Faces have their exact areas in the limit, and neighbours share their corners.
#[test]
fn faces_are_polygons_of_the_exact_area() {
    // Segments beyond the sides of a polygon in a circle have less than 2 pi / 12 times the square of a side.
    const STEP: f64 = 0.02;
    for seed in 0..20 {
        let (centres, radii) = random_balls(seed, 80, 3.0);
        let balls = Balls { centres: &centres, radii: &radii };
        let found: Faces = faces(balls, STEP, |_| true).unwrap();
        let exact = measure(balls, Some(1e-9), NonZeroUsize::MIN).unwrap().contacts;
        let mut areas: HashMap<[u32; 2], f64> = HashMap::new();
        let mut start = 0;
        for (contact, &end) in found.contacts.iter().zip(&found.ends) {
            let corners: Vec<Point> =
                found.corners[start..end].iter().map(|&c| found.points[c as usize]).collect();
            let mut normal = [0.0; 3];
            for pair in corners.windows(2).skip(1) {
                let part = cross(minus(pair[0], corners[0]), minus(pair[1], corners[0]));
                (0..3).for_each(|axis| normal[axis] += part[axis]);
            }
            let [p, q] = contact.balls.map(|ball| centres[ball as usize]);
            assert!(dot(normal, minus(q, p)) > -1e-12);
            areas.insert(contact.balls, dot(normal, normal).sqrt() / 2.0);
            start = end;
        }
        for contact in exact.iter() {
            let found = areas.remove(&contact.balls).unwrap_or(0.0);
            let lack = contact.area - found;
            assert!(lack.abs() < 0.53 * STEP * STEP + 1e-7, "{seed} {contact:?} {found}");
        }
        assert!(areas.values().all(|&area| area < 1e-7), "{seed}: {areas:?}");
    }
}
