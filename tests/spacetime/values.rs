//! Values between points.

use spmesh_base::error::ErrorKind;
use spmesh_spacetime::diagram4::diagram;
use spmesh_spacetime::slices::{Interpolator, Locator};
use spmesh_stream::model::cells4::Point4;

use super::{sampled, scattered, with_values};
use spmesh_reference::sets::Random;

fn affine([x, y, z, t]: Point4) -> f64 {
    2.0 * x - 3.0 * y + 0.5 * z + 7.0 * t - 11.0
}

#[test]
fn linear_functions_come_out() {
    let mut random = Random::new(21);
    for share in [1.0, 0.4, 0.0] {
        let diagram = with_values(sampled(&mut random, [5, 4, 4, 5], share), affine);
        let mut interpolator = Interpolator::new(&diagram).unwrap();
        for _ in 0..300 {
            let site = [4.0, 3.0, 3.0, 4.0].map(|side| (random.unit() * side * 64.0).floor() / 64.0);
            let value = interpolator.value(site).unwrap().expect("inside of the box");
            assert!((value - affine(site)).abs() < 1e-11, "{site:?}: {value}");
        }
    }
}

#[test]
fn vertices_have_their_values() {
    let mut random = Random::new(22);
    let diagram =
        with_values(scattered(&mut random, 150, 9), |[x, y, z, t]| (x * 1.7 + y * z).sin() / (t + 0.3));
    let mut interpolator = Interpolator::new(&diagram).unwrap();
    for (point, value) in diagram.points.iter().zip(diagram.values.as_ref().unwrap()) {
        assert_eq!(interpolator.value(*point).unwrap(), Some(*value));
    }
}

#[test]
fn values_are_continuous_across_cells() {
    let mut random = Random::new(23);
    let diagram =
        with_values(sampled(&mut random, [4, 4, 4, 4], 0.5), |p| p.iter().map(|x| (x * 2.3).sin()).sum());
    let mut interpolator = Interpolator::new(&diagram).unwrap();
    // Slopes are at most a few units, so nearby sites have nearby values. Some sites lie on facets of cubes.
    for _ in 0..300 {
        let site = [(); 4].map(|()| random.integer(0, 12) as f64 / 4.0);
        let here = interpolator.value(site).unwrap().unwrap();
        let near = site.map(|x| (x + 1e-9 * (random.unit() - 0.5)).clamp(0.0, 3.0));
        let there = interpolator.value(near).unwrap().unwrap();
        assert!((here - there).abs() < 1e-6, "{site:?}: {here} {there}");
    }
}

#[test]
fn the_hull_is_inside_and_beyond_is_nothing() {
    let mut random = Random::new(24);
    let diagram = with_values(sampled(&mut random, [3, 3, 3, 3], 0.5), affine);
    let mut interpolator = Interpolator::new(&diagram).unwrap();
    for axis in 0..4 {
        for border in [0.0, 2.0f64] {
            let mut site = [0.7, 1.3, 0.2, 1.9];
            site[axis] = border;
            assert!(interpolator.value(site).unwrap().is_some(), "{site:?}");
            site[axis] = if border == 0.0 { -f64::MIN_POSITIVE } else { border.next_up() };
            assert_eq!(interpolator.value(site).unwrap(), None, "{site:?}");
        }
    }
    assert_eq!(interpolator.value([1e300; 4]).unwrap(), None);
}

#[test]
fn units_do_not_matter() {
    let mut random = Random::new(25);
    let points = sampled(&mut random, [3, 3, 3, 3], 0.5);
    for unit in [1e-200, 1e-80, 1e60, 1e150] {
        let diagram =
            with_values(points.iter().map(|p| p.map(|x| x * unit)).collect(), |p| p[0] / unit + 1.0);
        let value = Interpolator::new(&diagram).unwrap().value([0.3, 1.1, 0.9, 1.6].map(|x| x * unit));
        assert!((value.unwrap().unwrap() - 1.3).abs() < 1e-9, "{unit}");
    }
}

#[test]
fn unknown_values_spread_to_their_simplices_only() {
    let points = sampled(&mut Random::new(26), [4, 2, 2, 2], 1.0);
    let diagram = with_values(points, |p| if p == [0.0; 4] { f64::NAN } else { p[0] });
    let mut interpolator = Interpolator::new(&diagram).unwrap();
    assert!(interpolator.value([0.0; 4]).unwrap().unwrap().is_nan());
    assert!(interpolator.value([0.5, 0.5, 0.4, 0.3]).unwrap().unwrap().is_nan());
    let known = interpolator.value([1.5, 0.5, 0.4, 0.3]).unwrap().unwrap();
    assert!((known - 1.5).abs() < 1e-12);
}

#[test]
fn points_without_values_are_refused() {
    let (diagram, _) = diagram(sampled(&mut Random::new(27), [2, 2, 2, 2], 1.0), None).unwrap();
    assert_eq!(Interpolator::new(&diagram).unwrap_err().kind(), ErrorKind::Usage);
}

#[test]
fn walks_find_the_cell() {
    let mut random = Random::new(28);
    let (diagram, _) = diagram(scattered(&mut random, 300, 1000), None).unwrap();
    let mut locator = Locator::new(&diagram);
    for (number, cell) in diagram.cells.iter().enumerate().filter(|(_, cell)| !cell.is_infinite).step_by(7) {
        let mean = |axis: usize| {
            let sum: f64 = cell.vertices.iter().map(|&v| diagram.points[v as usize][axis]).sum();
            sum / cell.vertices.len() as f64
        };
        assert_eq!(locator.locate(std::array::from_fn(mean)), Some(number));
    }
    assert!(locator.visited > 0);
}
