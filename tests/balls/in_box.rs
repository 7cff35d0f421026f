//! Balls in a periodic box, against the middle of many copies without a box.

use super::vectors::{Point, length, minus};
use spmesh_molecules::balls::{Balls, measure, measure_in_box};
use spmesh_reference::sets::Random;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::num::NonZeroUsize;

const CUBE: [Point; 3] = [[10.0, 0.0, 0.0], [0.0, 10.0, 0.0], [0.0, 0.0, 10.0]];

#[test]
fn a_ball_on_the_border_has_its_whole_area() {
    for centre in [[0.0; 3], [9.9, 5.0, 0.1], [35.0, -7.0, 10.0]] {
        let balls = Balls { centres: &[centre], radii: &[2.5] };
        let found = measure_in_box(balls, CUBE, Some(0.0), NonZeroUsize::MIN).unwrap();
        assert!((found.cells[0].area - 4.0 * PI * 6.25).abs() < 1e-12);
        assert!((found.cells[0].volume - 4.0 / 3.0 * PI * 2.5f64.powi(3)).abs() < 1e-12);
        assert!(found.contacts.is_empty());
    }
}

#[test]
fn balls_meet_through_the_border() {
    let (r, d) = (2.0, 3.0);
    let balls = Balls { centres: &[[1.0, 5.0, 5.0], [8.0, 5.0, 5.0]], radii: &[r, r] };
    let found = measure_in_box(balls, CUBE, Some(0.0), NonZeroUsize::MIN).unwrap();
    let [contact] = found.contacts[..] else { panic!("{:?}", found.contacts) };
    assert_eq!((contact.sites, contact.shift), ([0, 1], [-1, 0, 0]));
    assert!((contact.distance - d).abs() < 1e-12);
    assert!((contact.area - PI * (r * r - d * d / 4.0)).abs() < 1e-12);
    for cell in &found.cells {
        assert!((cell.area - (4.0 * PI * r * r - 2.0 * PI * r * (r - d / 2.0))).abs() < 1e-12);
    }
    // A ball that meets its own images, along one axis: a chain of lenses.
    let thin = [[3.0, 0.0, 0.0], CUBE[1], CUBE[2]];
    let found =
        measure_in_box(Balls { centres: &[[7.0; 3]], radii: &[r] }, thin, Some(0.0), NonZeroUsize::MIN)
            .unwrap();
    assert!((found.cells[0].area - (4.0 * PI * r * r - 4.0 * PI * r * (r - d / 2.0))).abs() < 1e-12);
    let shifts: Vec<_> = found.contacts.iter().map(|contact| (contact.sites, contact.shift)).collect();
    assert_eq!(shifts, [([0, 0], [1, 0, 0])]);
}

#[test]
fn balls_in_a_box_are_those_in_the_middle_of_copies() {
    let mut random = Random::new(21);
    let vectors = [[7.0, 0.0, 0.0], [2.0, 6.0, 0.0], [-1.5, 1.0, 8.0]];
    let place = |p: Point, shift: [i64; 3]| -> Point {
        std::array::from_fn(|axis| p[axis] + (0..3).map(|k| shift[k] as f64 * vectors[k][axis]).sum::<f64>())
    };
    for count in [1, 3, 12, 40] {
        let mut numbers = || [(); 3].map(|()| 6.0 * random.unit());
        let centres: Vec<Point> = (0..count).map(|_| numbers()).collect();
        let radii: Vec<f64> = (0..count).map(|_| 0.8 + 1.2 * random.unit()).collect();
        let found = measure_in_box(
            Balls { centres: &centres, radii: &radii },
            vectors,
            Some(1e-9),
            NonZeroUsize::MIN,
        )
        .unwrap();
        let range = -3..=3i64;
        let mut shifts = vec![[0; 3]];
        for x in range.clone() {
            for y in range.clone() {
                shifts.extend(range.clone().map(|z| [x, y, z]).filter(|&shift| shift != [0; 3]));
            }
        }
        let all: Vec<Point> =
            shifts.iter().flat_map(|&s| centres.iter().map(move |&p| place(p, s))).collect();
        let all_radii = radii.repeat(shifts.len());
        let balls = Balls { centres: &all, radii: &all_radii };
        let copies = measure(balls, Some(1e-9), NonZeroUsize::MIN).unwrap();
        for (cell, copy) in found.cells.iter().zip(&copies.cells) {
            assert!((cell.area - copy.area).abs() < 1e-11, "{cell:?} {copy:?}");
            assert!((cell.volume - copy.volume).abs() < 1e-11, "{cell:?} {copy:?}");
        }
        let mut expected = BTreeMap::new();
        for contact in copies.contacts.iter().filter(|contact| (contact.balls[0] as usize) < count) {
            let [i, j] = contact.balls.map(|ball| ball as usize);
            let (other, shift) = ((j % count) as u32, shifts[j / count]);
            if (i as u32, [0; 3]) < (other, shift) {
                expected.insert((i as u32, other, shift), (contact.area, length(minus(all[i], all[j]))));
            }
        }
        assert_eq!(found.contacts.len(), expected.len());
        for contact in &found.contacts {
            let (area, distance) = expected[&(contact.sites[0], contact.sites[1], contact.shift)];
            assert!((contact.area - area).abs() < 1e-11 && (contact.distance - distance).abs() < 1e-11);
        }
    }
}
