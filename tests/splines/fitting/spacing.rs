//! The distance of observations, where there are some.

use spmesh_splines::fitting::Density;

#[test]
fn gaps_do_not_count() {
    let all: Vec<[f64; 2]> = (0..10_000).map(|i| [f64::from(i % 100), f64::from(i / 100)]).collect();
    let found = Density::of(all.clone(), 1.0).unwrap();
    assert!((found.distance() - 1.0).abs() < 0.05 && found.places().len() == 10_000, "{}", found.distance());
    // Half of the box is empty, except for its corner.
    let mut some: Vec<[f64; 2]> = all.iter().copied().filter(|place| place[0] < 50.0).collect();
    some.push(all[9_999]);
    let found = Density::of(some, 1.0).unwrap();
    assert!((found.distance() - 1.0).abs() < 0.1 && found.places().len() == 5_001, "{}", found.distance());
    // Of a thousand places next to each other, and one far away, the former count.
    let mut crowded: Vec<[f64; 2]> = all[..1_000].iter().map(|place| place.map(|x| 0.001 * x)).collect();
    crowded.push(all[9_999]);
    let found = Density::of(crowded, 1.0).unwrap();
    assert!(found.distance() < 0.3, "{}", found.distance());
    assert!(Density::of(all[..1].to_vec(), 1.0).is_err());
}
