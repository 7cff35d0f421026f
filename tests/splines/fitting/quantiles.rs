//! Quantiles from one pass against sorted numbers.

use spmesh_base::random::Random;
use spmesh_splines::fitting::QuantileSketch;

#[test]
fn medians_are_half_a_percent_off_at_most() {
    let mut random = Random::new(4);
    for count in [1, 2, 3, 10, 1001] {
        let mut all: Vec<f64> =
            (0..count).map(|_| random.bits() as f64 * 2f64.powi(random.below(90) as i32 - 100)).collect();
        let mut sketch = QuantileSketch::default();
        all.iter().enumerate().for_each(|(i, &x)| sketch.add(if i % 2 == 0 { x } else { -x }));
        all.sort_by(f64::total_cmp);
        let expected = all[(count - 1) / 2];
        let found = sketch.median().unwrap();
        assert!((found / expected - 1.0).abs() < 0.005, "{count}: {found}, {expected}");
        for (part, at) in [(0.95, (95 * count).div_ceil(100) - 1), (1.0, count - 1)] {
            let (expected, found) = (all[at], sketch.quantile(part).unwrap());
            assert!((found / expected - 1.0).abs() < 0.005, "{count} {part}: {found}, {expected}");
        }
    }
    assert_eq!(QuantileSketch::default().median(), None);
    let mut zeros = QuantileSketch::default();
    [0.0, -0.0, 5.0].iter().for_each(|&x| zeros.add(x));
    assert_eq!(zeros.median(), Some(0.0));
}
