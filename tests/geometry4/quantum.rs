//! Coordinates that are multiples of a number.

use spmesh_spacetime::dd4::Quantum;
use spmesh_stream::model::cells4::Point4;

#[test]
fn multiples_become_whole() {
    let quantum: Quantum = "0.1".parse().unwrap();
    let mut points: Vec<Point4> =
        (-1000..1000).map(|i| [f64::from(i) * 0.1, f64::from(i) / 10.0, 0.3, -0.0]).collect();
    quantum.divide(&mut points).unwrap();
    for (point, i) in points.iter().zip(-1000..) {
        assert_eq!(*point, [f64::from(i), f64::from(i), 3.0, 0.0]);
        assert!(point.iter().all(|x| *x != 0.0 || x.is_sign_positive()));
    }
    let mut far = vec![[2_147_483_648.0 * 0.1, -214_748_364.7, 0.0, 0.0]];
    quantum.divide(&mut far).unwrap();
    assert_eq!(far, [[2_147_483_648.0, -2_147_483_647.0, 0.0, 0.0]]);
}

#[test]
fn other_numbers_are_refused() {
    let quantum: Quantum = "0.5".parse().unwrap();
    for (point, part) in [
        ([0.0, 1.5, 0.25, 1.0], "z = 0.25 is no multiple of 0.5, but 0.5 times"),
        ([0.0, 1.500_001, 0.0, 1.0], "y = 1.500001"),
        ([0.0, 0.0, 0.0, 1e10], "t = 10000000000 is more than 2^31"),
        ([f64::NAN, 0.0, 0.0, 0.0], "x = NaN"),
    ] {
        let message = quantum.divide(&mut [[0.0; 4], point]).unwrap_err().to_string();
        assert!(message.contains(part) && message.contains("point ["), "{message}");
    }
    for text in ["0", "-1", "inf", "nan", "1e-320", "one", ""] {
        assert!(text.parse::<Quantum>().is_err(), "{text}");
    }
}
