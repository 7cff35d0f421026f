//! Parts of unions, and how unions change, against the measures of whole unions.

use super::vectors::{Point, length, minus};
use spmesh_molecules::balls::{Balls, Contact, buried, contacts_between, gradients, measure, nearest};
use spmesh_reference::sets::Random;
use std::num::NonZeroUsize;

const ONE: NonZeroUsize = NonZeroUsize::MIN;

/// Balls in a cube, each of one of `parts` parts that lie side by side, with some of each in the others.
fn crowd(count: usize, side: f64, parts: u32, seed: u64) -> (Vec<Point>, Vec<f64>, Vec<u32>) {
    let mut random = Random::new(seed);
    let centres: Vec<Point> =
        (0..count).map(|_| [random.unit(), random.unit(), random.unit()].map(|c| c * side)).collect();
    let radii = (0..count).map(|_| 0.5 + random.unit()).collect();
    let part = |at: &Point| {
        let own = (at[0] / side * f64::from(parts)) as u32;
        if random.unit() < 0.02 { (own + 1) % parts } else { own }
    };
    let parts = centres.iter().map(part).collect();
    (centres, radii, parts)
}

fn sums(centres: &[Point], radii: &[f64]) -> [f64; 2] {
    let cells = measure(Balls { centres, radii }, None, ONE).unwrap().cells;
    [cells.iter().map(|cell| cell.area).sum(), cells.iter().map(|cell| cell.volume).sum()]
}

/// The area and the volume at several places tell how they change there (central differences, extrapolated).
#[test]
fn gradients_are_the_limits_of_differences() {
    let mut compared = 0;
    for seed in 0..12 {
        let count = [1, 2, 3, 8, 20, 40][seed as usize % 6];
        let (mut centres, radii, _) = crowd(count, 1.0 + 0.08 * count as f64, 1, 100 + seed);
        let found = gradients(Balls { centres: &centres, radii: &radii }, ONE).unwrap();
        for (ball, gradient) in found.iter().enumerate() {
            for axis in 0..3 {
                let mut slope = |step: f64| {
                    let middle = centres[ball][axis];
                    let [after, before] = [step, -step].map(|step| {
                        centres[ball][axis] = middle + step;
                        sums(&centres, &radii)
                    });
                    centres[ball][axis] = middle;
                    [0, 1].map(|i| (after[i] - before[i]) / (2.0 * step))
                };
                let (coarse, fine) = (slope(2e-4), slope(1e-4));
                let expected = [0, 1].map(|i| (4.0 * fine[i] - coarse[i]) / 3.0);
                for (found, expected) in [gradient.area[axis], gradient.volume[axis]].iter().zip(expected) {
                    let wrong = (found - expected).abs();
                    assert!(
                        wrong < 1e-6 * (1.0 + expected.abs()),
                        "{seed} {ball} {axis}: {found}, {expected}"
                    );
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 800, "{compared}");
}

/// Where all balls move together, nothing changes.
#[test]
fn gradients_of_all_balls_add_up_to_nothing() {
    // Several tiles.
    let (centres, radii, _) = crowd(9_000, 30.0, 1, 5);
    let found = gradients(Balls { centres: &centres, radii: &radii }, ONE).unwrap();
    for axis in 0..3 {
        let sum = |of: fn(&spmesh_molecules::balls::Gradient) -> Point| -> f64 {
            found.iter().map(|gradient| of(gradient)[axis]).sum()
        };
        assert!(sum(|gradient| gradient.area).abs() < 1e-8 && sum(|gradient| gradient.volume).abs() < 1e-8);
    }
}

#[test]
fn contacts_between_parts_are_those_of_the_whole() {
    for (count, side, parts, seed) in [
        (0, 1.0, 1, 1),
        (1, 1.0, 1, 2),
        (2, 0.5, 2, 3),
        (800, 12.0, 2, 4),
        (800, 12.0, 5, 5),
        (9_000, 40.0, 3, 6),
    ] {
        let (centres, radii, parts) = crowd(count, side, parts, seed);
        let balls = Balls { centres: &centres, radii: &radii };
        let whole = measure(balls, Some(0.0), ONE).unwrap();
        let expected: Vec<Contact> = whole
            .contacts
            .iter()
            .filter(|contact| parts[contact.balls[0] as usize] != parts[contact.balls[1] as usize])
            .copied()
            .collect();
        let found = contacts_between(balls, &parts, ONE).unwrap();
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(&expected) {
            assert_eq!(found.balls, expected.balls);
            assert!((found.area - expected.area).abs() < 1e-11, "{found:?}, {expected:?}");
        }
    }
}

/// With a radius that reaches all, all balls are kept.
#[test]
fn contacts_between_parts_of_large_balls() {
    let (mut centres, mut radii, mut parts) = crowd(3_000, 3.0, 1, 7);
    centres.push([40.0; 3]);
    radii.push(60.0);
    parts.push(1);
    let balls = Balls { centres: &centres, radii: &radii };
    let found = contacts_between(balls, &parts, ONE).unwrap();
    let whole = measure(balls, Some(0.0), ONE).unwrap();
    let expected = whole.contacts.iter().filter(|contact| contact.balls[1] == 3_000).count();
    assert_eq!(found.len(), expected);
}

/// Each pair of parts alone, as three measures of all of its balls.
#[test]
fn buried_areas_are_what_parts_lose_together() {
    for (count, side, parts, seed) in [(2, 0.5, 2, 11), (300, 7.0, 2, 12), (400, 8.0, 4, 13)] {
        let (centres, radii, of) = crowd(count, side, parts, seed);
        let found = buried(Balls { centres: &centres, radii: &radii }, &of, |_| true, ONE).unwrap();
        let area = |wanted: &[u32]| {
            let members: Vec<usize> = (0..count).filter(|&ball| wanted.contains(&of[ball])).collect();
            let centres: Vec<Point> = members.iter().map(|&ball| centres[ball]).collect();
            let radii: Vec<f64> = members.iter().map(|&ball| radii[ball]).collect();
            sums(&centres, &radii)[0]
        };
        let mut pairs = 0;
        for p in 0..parts {
            for q in p + 1..parts {
                let expected = area(&[p]) + area(&[q]) - area(&[p, q]);
                let burial = found.iter().find(|burial| burial.parts == [p, q]);
                let buried: f64 = burial.map_or(0.0, |burial| burial.areas().iter().sum());
                assert!((buried - expected).abs() < 1e-9, "{p} {q}: {buried}, not {expected}");
                pairs += usize::from(burial.is_some());
            }
        }
        assert_eq!(pairs, found.len());
        let some = buried(Balls { centres: &centres, radii: &radii }, &of, |pair| pair[0] > 0, ONE).unwrap();
        assert_eq!(some, found.into_iter().filter(|burial| burial.parts[0] > 0).collect::<Vec<_>>());
    }
}

#[test]
fn the_nearest_of_some_balls_by_a_search_of_all() {
    let (centres, radii, of) = crowd(500, 9.0, 2, 21);
    let members: Vec<u32> = (0..500).filter(|&ball| of[ball as usize] == 0).collect();
    let others: Vec<u32> = (0..500).filter(|&ball| of[ball as usize] == 1).collect();
    let found = nearest(Balls { centres: &centres, radii: &radii }, &members, &others);
    for (&ball, found) in others.iter().zip(found) {
        let distance = |other: u32| length(minus(centres[ball as usize], centres[other as usize]));
        let touching = members
            .iter()
            .copied()
            .filter(|&other| distance(other) <= radii[ball as usize] + radii[other as usize]);
        assert_eq!(found, touching.min_by(|&p, &q| distance(p).total_cmp(&distance(q))));
    }
}
