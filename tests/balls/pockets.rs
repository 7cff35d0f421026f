//! Pockets and voids against flooded grids and sampling.

use spmesh_molecules::balls::{Balls, Pocket, pockets};
use spmesh_reference::sets::Random;

type Point = [f64; 3];

fn found(centres: &[Point], radii: &[f64]) -> Vec<Pocket> {
    pockets(Balls { centres, radii }).expect("finite balls")
}

/// The surface of a cube of `side` steps, without the points that `is_open` names.
fn shell(side: i32, is_open: impl Fn([i32; 3]) -> bool) -> Vec<Point> {
    let range = || 0..=side;
    let all = range().flat_map(|x| range().flat_map(move |y| range().map(move |z| [x, y, z])));
    all.filter(|p| p.iter().any(|&c| c == 0 || c == side) && !is_open(*p)).map(|p| p.map(f64::from)).collect()
}

#[test]
fn a_closed_shell_has_a_void() {
    let centres = shell(6, |_| false);
    let pockets = found(&centres, &vec![0.8; centres.len()]);
    assert_eq!(pockets.len(), 1);
    let void = &pockets[0];
    assert!(void.mouths.is_empty() && void.depth == 0.0);
    let inner = sampled_volume(&centres, 0.8, [0.0; 3], [6.0; 3]);
    assert!((void.volume - inner).abs() < 0.01 * inner, "{} {inner}", void.volume);
    // Each ball of the sides shows the void a cap between its neighbours; none of the edges' balls does.
    assert_eq!(void.balls.len(), centres.len());
    assert!(void.area > 6.0 * 25.0 && void.area < 6.0 * 36.0 * 1.5, "{}", void.area);
}

#[test]
fn holes_in_a_shell_are_mouths() {
    let middle = |p: [i32; 3]| p[0] == 3 && p[1] == 3;
    for (holes, mouths) in [(1, 1), (2, 2)] {
        let centres = shell(6, |p| middle(p) && (p[2] == 0 || holes == 2));
        let pockets = found(&centres, &vec![0.8; centres.len()]);
        assert_eq!(
            pockets.iter().map(|pocket| pocket.mouths.len()).collect::<Vec<_>>(),
            [mouths],
            "{holes} holes"
        );
        let pocket = &pockets[0];
        let inner = sampled_volume(&centres, 0.8, [0.0; 3], [6.0; 3]);
        assert!((pocket.volume - inner).abs() < 0.02 * inner, "{} {inner}", pocket.volume);
        let hole = sampled_volume(&centres, 0.8, [2.0, 2.0, -1e-9], [4.0, 4.0, 1e-9]) / 2e-9;
        let expected = hole * f64::from(holes);
        let area = pocket.mouth_area();
        assert!((area - expected).abs() < 0.02 * expected, "{area} {expected}");
        let depth = if holes == 1 { 6.0 } else { 3.0 };
        assert!(pocket.depth >= depth, "{}", pocket.depth);
    }
}

#[test]
fn what_is_open_is_no_pocket() {
    assert!(found(&[], &[]).is_empty());
    assert!(found(&[[0.0; 3]], &[1.0]).is_empty());
    let row: Vec<Point> = (0..9).map(|i| [f64::from(i), 0.0, 0.0]).collect();
    assert!(found(&row, &[0.7; 9]).is_empty());
    // A bowl whose opening is its widest part: the centre of its sphere is above the rim.
    let mut random = Random::new(3);
    let mut bowl = Vec::new();
    while bowl.len() < 600 {
        let p = [(); 3].map(|()| 2.0 * random.unit() - 1.0);
        let length = square(p, [0.0; 3]).sqrt();
        if length < 1.0 && p[2] < -0.5 * length {
            bowl.push(p.map(|c| c * (6.0 + 0.01 * random.unit()) / length));
        }
    }
    assert!(found(&bowl, &[0.9; 600]).iter().map(|pocket| pocket.volume).sum::<f64>() < 0.1);
}

/// Voids of random balls are the parts of a fine grid that a flood from outside does not reach.
#[test]
fn voids_of_random_balls() {
    let (mut voids, mut equal) = (0, 0);
    for seed in 0..12 {
        let mut random = Random::new(seed);
        // A shell that is tight or not.
        let mut jitter = |c: f64| c + 0.16 * (random.unit() - 0.5);
        let centres: Vec<Point> = shell(4, |_| false).into_iter().map(|p| p.map(&mut jitter)).collect();
        let radii: Vec<f64> = centres.iter().map(|_| 0.74 + random.unit() * 0.2).collect();
        let flooded: f64 = flood(&centres, &radii, 0.04).into_iter().filter(|&volume| volume > 0.02).sum();
        let pockets = found(&centres, &radii);
        let sum = |is_wanted: &dyn Fn(&Pocket) -> bool| -> f64 {
            let wanted = pockets.iter().filter(|pocket| pocket.volume > 0.02 && is_wanted(pocket));
            wanted.map(|pocket| pocket.volume).sum()
        };
        let closed = sum(&|pocket| pocket.mouths.is_empty());
        // The grid does not see necks that are narrower than its step, so that pockets behind such look
        // closed.
        let open = sum(&|pocket| !pocket.mouths.is_empty());
        let near = 0.02 + 0.05 * flooded;
        assert!(
            closed < flooded + near && flooded < closed + open + near,
            "{seed}: {closed} {open} {flooded}"
        );
        equal += usize::from((closed - flooded).abs() < near);
        voids += pockets.iter().filter(|pocket| pocket.mouths.is_empty() && pocket.volume > 0.02).count();
    }
    assert!(voids >= 4 && equal >= 9, "{voids} voids, {equal} sets of 12 equal");
}

/// Volume of a box that no ball covers, by a grid of points.
fn sampled_volume(centres: &[Point], radius: f64, min: Point, max: Point) -> f64 {
    let steps = 90;
    let at =
        |i: usize, axis: usize| min[axis] + (i as f64 + 0.5) / f64::from(steps) * (max[axis] - min[axis]);
    let mut free = 0u32;
    for x in 0..steps as usize {
        for y in 0..steps as usize {
            for z in 0..steps as usize {
                let p = [at(x, 0), at(y, 1), at(z, 2)];
                free += u32::from(centres.iter().all(|&c| square(c, p) > radius * radius));
            }
        }
    }
    f64::from(free) / f64::from(steps).powi(3) * (0..3).map(|axis| max[axis] - min[axis]).product::<f64>()
}

/// Volumes of the parts of a grid outside of all balls that are not joined to its border.
fn flood(centres: &[Point], radii: &[f64], step: f64) -> Vec<f64> {
    let side = (6.0 / step) as usize;
    let at = |i: usize| -1.0 + (i as f64 + 0.5) * step;
    let place = |x: usize, y: usize, z: usize| (x * side + y) * side + z;
    let mut is_free = vec![true; side * side * side];
    for (c, r) in centres.iter().zip(radii) {
        let range = |axis: usize| {
            let low = ((c[axis] - r + 1.0) / step).floor().max(0.0) as usize;
            low..(((c[axis] + r + 1.0) / step).ceil() as usize + 1).min(side)
        };
        for x in range(0) {
            for y in range(1) {
                for z in range(2) {
                    if square(*c, [at(x), at(y), at(z)]) <= r * r {
                        is_free[place(x, y, z)] = false;
                    }
                }
            }
        }
    }
    let mut fill = |start: usize| -> usize {
        let mut open = vec![start];
        let mut count = 0;
        while let Some(cell) = open.pop() {
            if !std::mem::replace(&mut is_free[cell], false) {
                continue;
            }
            count += 1;
            let (x, y, z) = (cell / side / side, cell / side % side, cell % side);
            for (i, far) in [(x, side * side), (y, side), (z, 1)] {
                if i > 0 {
                    open.push(cell - far);
                }
                if i + 1 < side {
                    open.push(cell + far);
                }
            }
        }
        count
    };
    fill(0);
    (0..side * side * side)
        .map(&mut fill)
        .filter(|&count| count > 0)
        .map(|count| count as f64 * step.powi(3))
        .collect()
}

fn square(p: Point, q: Point) -> f64 {
    (0..3).map(|i| (p[i] - q[i]).powi(2)).sum()
}

/// The volume of open pockets, by a grid of points: those in a tetrahedron of the pocket and in no ball. The
/// sum over tetrahedra counts balls that reach through a mouth as if they did not.
#[test]
fn volumes_of_open_pockets_are_those_of_their_tetrahedra() {
    let (mut sampled, mut found_all, mut apart) = (0.0, 0.0, 0.0);
    for seed in 0..6 {
        let mut random = Random::new(seed);
        let mut jitter = |c: f64| c + 0.2 * (random.unit() - 0.5);
        let is_open = |p: [i32; 3]| p[2] == 0 && (1..=2).contains(&p[0]) && p[1] == 2;
        let centres: Vec<Point> = shell(5, is_open).into_iter().map(|p| p.map(&mut jitter)).collect();
        let radii: Vec<f64> = centres.iter().map(|_| 0.8 + random.unit() * 0.1).collect();
        for pocket in found(&centres, &radii).iter().filter(|pocket| pocket.volume > 1.0) {
            assert!(!pocket.mouths.is_empty(), "{seed}");
            let expected = free_volume(pocket, &centres, &radii, 0.05);
            sampled += expected;
            found_all += pocket.volume;
            apart = f64::max(apart, (pocket.volume - expected).abs() / expected);
        }
    }
    println!("{found_all} by formula, {sampled} by points, greatest relative difference {apart}");
    assert!(sampled > 100.0 && apart < 0.02, "{found_all} {sampled} {apart}");
}

/// Volume of the part of a pocket's tetrahedra that no ball covers.
fn free_volume(pocket: &Pocket, centres: &[Point], radii: &[f64], step: f64) -> f64 {
    let mut count = 0u32;
    for corners in &pocket.tetrahedra {
        let corners = corners.map(|ball| centres[ball as usize]);
        let range = |axis: usize| {
            let side = corners.map(|corner| corner[axis] / step);
            let low = side.into_iter().fold(f64::INFINITY, f64::min).ceil() as i64;
            low..=side.into_iter().fold(f64::NEG_INFINITY, f64::max).floor() as i64
        };
        for x in range(0) {
            for y in range(1) {
                for z in range(2) {
                    let p = [x, y, z].map(|c| c as f64 * step);
                    let is_free = |(&c, &r): (&Point, &f64)| square(c, p) > r * r;
                    if is_in(corners, p) && centres.iter().zip(radii).all(is_free) {
                        count += 1;
                    }
                }
            }
        }
    }
    f64::from(count) * step.powi(3)
}

/// Whether a point is on the inner side of all facets, or on their planes.
fn is_in([a, b, c, d]: [Point; 4], p: Point) -> bool {
    let side = |a: Point, b: Point, c: Point, p: Point| {
        let [u, v, w] = [b, c, p].map(|q| [0, 1, 2].map(|i| q[i] - a[i]));
        u[0] * (v[1] * w[2] - v[2] * w[1])
            + u[1] * (v[2] * w[0] - v[0] * w[2])
            + u[2] * (v[0] * w[1] - v[1] * w[0])
    };
    side(a, b, c, p) >= 0.0 && side(a, c, d, p) >= 0.0 && side(a, d, b, p) >= 0.0 && side(b, d, c, p) >= 0.0
}
