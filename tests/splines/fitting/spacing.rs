//! The distance of observations, where there are some.

use spmesh_splines::fitting::{Observation, spacing};

#[test]
fn gaps_do_not_count() {
    let all: Vec<Observation> = (0..10_000)
        .map(|i| [f64::from(i % 100), f64::from(i / 100)])
        .map(|point| Observation::new(point, 0.0))
        .collect();
    let found = spacing(&all).unwrap();
    assert!((found.distance - 1.0).abs() < 0.05 && found.places == 10_000.0, "{found:?}");
    // Half of the box is empty, except for its corner.
    let mut some: Vec<Observation> = all.iter().copied().filter(|one| one.point[0] < 50.0).collect();
    some.push(all[9_999]);
    let found = spacing(&some).unwrap();
    assert!((found.distance - 1.0).abs() < 0.1 && found.places == 5_001.0, "{found:?}");
    // Of a thousand observations at one place, a few count.
    let mut crowded = vec![all[0]; 1_000];
    crowded.push(all[9_999]);
    let found = spacing(&crowded).unwrap();
    assert!(found.distance < 0.3 && found.places == 32.0, "{found:?}");
    assert!(spacing(&all[..1]).is_err());
}
