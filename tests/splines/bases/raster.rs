//! Rasters against evaluation at single points.

use super::sets::cases;
use spmesh_reference::sets::Random;
use spmesh_splines::bases::{Raster, Scratch};

fn check(degree: usize, columns: usize, rows: usize) {
    for (number, case) in cases(degree).iter().enumerate() {
        let mut random = Random::new(number as u64);
        let coefficients: Vec<f64> = (0..case.basis.len()).map(|_| random.unit()).collect();
        let mut scratch = Scratch::default();
        for (origin, step) in [
            // A raster with centres on many knots and lines, and beyond the knots.
            ([-0.125, 1.125], [1.25 / columns as f64, -1.25 / rows as f64]),
            ([0.0, 0.0], [1.0 / columns as f64, 1.0 / rows as f64]),
            ([random.unit() * 0.1, random.unit() * 0.1], [0.013, 0.0171]),
            ([0.4, -0.1], [3.0, 0.05]),
        ] {
            let raster = Raster { origin, step, columns, rows };
            let mut seen = 0;
            let result = case.basis.raster(&coefficients, &raster, |row| {
                assert_eq!((row.row, row.y, row.values.len()), (seen, raster.y(seen), columns));
                seen += 1;
                for (column, found) in row.values.iter().enumerate() {
                    let x = [raster.x(column), row.y];
                    let expected = case.basis.value(&coefficients, x, &mut scratch);
                    assert!((found - expected).abs() < 1e-13, "{} at {x:?}: {found} {expected}", case.name);
                    assert_eq!(
                        row.domain.contains(&column),
                        case.basis.is_in_domain(x),
                        "{} at {x:?}",
                        case.name
                    );
                }
                Ok(())
            });
            result.expect("a raster");
            assert_eq!(seen, rows);
        }
    }
}

#[test]
fn rasters_of_degrees_0_and_1_are_those_of_points() {
    check(0, 32, 16);
    check(1, 32, 16);
}

#[test]
fn rasters_of_degree_2_are_those_of_points() {
    check(2, 64, 32);
}

#[test]
fn rasters_of_degree_3_are_those_of_points() {
    check(3, 12, 8);
}

#[test]
fn rasters_that_make_no_sense_are_errors() {
    let case = cases(1).swap_remove(0);
    let coefficients = vec![1.0; case.basis.len()];
    let refused = |coefficients: &[f64], change: &dyn Fn(&mut Raster)| {
        let mut raster = Raster { origin: [0.0, 0.0], step: [0.5, 0.5], columns: 2, rows: 2 };
        change(&mut raster);
        let result = case.basis.raster(coefficients, &raster, |_| Ok(()));
        result.expect_err("an error").to_string()
    };
    assert!(refused(&coefficients[1..], &|_| ()).contains("one each is needed"));
    assert!(
        refused(&vec![f64::NAN; case.basis.len()], &|_| ()).contains("function 0: coefficient is not finite")
    );
    assert!(refused(&coefficients, &|raster| raster.step[0] = -0.5).contains("left to right"));
    assert!(refused(&coefficients, &|raster| raster.step[1] = 0.0).contains("must not be zero"));
    assert!(refused(&coefficients, &|raster| raster.origin[1] = f64::NAN).contains("not finite"));
    assert!(refused(&coefficients, &|raster| raster.step[0] = 1e308).contains("not finite"));
}
