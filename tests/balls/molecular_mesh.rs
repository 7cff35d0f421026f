//! The molecular surface as a mesh: closed, where a probe touches and none reaches further, and with the
//! exact area and volume in the limit. The checks know triangles and balls only.

use std::num::NonZeroUsize;

use super::surfaces::{area, check_closed, volumes};
use super::vectors::{Point, dot, minus};
use spmesh_molecules::balls::{Balls, Surface, molecular_mesh, molecular_surface};
use spmesh_reference::sets::Random;

const ONE: NonZeroUsize = NonZeroUsize::MIN;

/// By how much a place is inside of the balls.
fn cover(at: Point, centres: &[Point], radii: &[f64]) -> f64 {
    let depth =
        |(centre, radius): (&Point, &f64)| radius - dot(minus(at, *centre), minus(at, *centre)).sqrt();
    centres.iter().zip(radii).map(depth).fold(f64::NEG_INFINITY, f64::max)
}

/// Of each vertex: a probe along the normal overlaps no ball, and one anywhere nearer does. The radii include
/// that of the probe.
fn check_vertices(mesh: &Surface, centres: &[Point], radii: &[f64], probe: f64) {
    let mut random = Random::new(5);
    for ((&at, &normal), &owner) in mesh.points.iter().zip(&mesh.normals).zip(&mesh.owners) {
        let resting = [0, 1, 2].map(|axis| at[axis] + probe * normal[axis]);
        assert!(cover(resting, centres, radii) < 1e-5, "{at:?} is not reached");
        for _ in 0..4 {
            let offset = [0; 3].map(|_| 2.0 * random.unit() - 1.0);
            let size = dot(offset, offset).sqrt().max(1.0);
            let place = [0, 1, 2].map(|axis| at[axis] + 0.999 * probe * offset[axis] / size);
            assert!(cover(place, centres, radii) > -1e-6, "{at:?} is reached from {place:?}");
        }
        let power =
            |ball: usize| dot(minus(at, centres[ball]), minus(at, centres[ball])) - radii[ball].powi(2);
        let least = (0..centres.len()).map(power).fold(f64::INFINITY, f64::min);
        assert!(power(owner as usize) - least < 1e-9);
    }
}

/// Makes a mesh, checks it, and compares it with the exact area and volume.
fn check(centres: &[Point], radii: &[f64], probe: f64, step: f64, tolerance: f64) -> Surface {
    let balls = Balls { centres, radii };
    let mesh = molecular_mesh(balls, probe, step, ONE).unwrap();
    check_closed(&mesh.triangles);
    check_vertices(&mesh, centres, radii, probe);
    let cells = molecular_surface(balls, probe, ONE).unwrap();
    let [exact_area, exact_volume] =
        [cells.iter().map(|cell| cell.area).sum(), cells.iter().map(|cell| cell.volume).sum::<f64>()];
    let (found_area, found_volume): (f64, f64) = (area(&mesh), volumes(&mesh).iter().sum());
    let near = |found: f64, exact: f64| (found - exact).abs() <= tolerance * exact;
    assert!(near(found_area, exact_area), "area {found_area}, exact {exact_area}");
    assert!(near(found_volume, exact_volume), "volume {found_volume}, exact {exact_volume}");
    mesh
}

#[test]
fn few_balls_have_the_surfaces_of_textbooks() {
    // A sphere; a saddle between two balls; and one with a cusp.
    let one = check(&[[0.3, 0.1, 7.0]], &[3.0], 1.0, 0.1, 2e-3);
    for at in &one.points {
        let from = minus(*at, [0.3, 0.1, 7.0]);
        assert!((dot(from, from).sqrt() - 2.0).abs() < 1e-6);
    }
    check(&[[0.0; 3], [2.5, 0.0, 0.0]], &[2.5, 2.2], 1.0, 0.1, 3e-3);
    check(&[[0.0; 3], [4.4, 0.0, 0.0]], &[2.5, 2.5], 1.0, 0.05, 3e-3);
    // Coinciding balls, one in another, and one far away.
    check(&[[0.0; 3], [0.0; 3], [0.1, 0.0, 0.0], [1e3, 0.0, 0.0]], &[2.0, 2.0, 1.5, 3.0], 1.0, 0.1, 3e-3);
}

#[test]
fn crowds_have_closed_surfaces_with_the_exact_area_in_the_limit() {
    let mut random = Random::new(77);
    for (count, side, step) in [(12, 4.0, 0.1), (60, 9.0, 0.15)] {
        let centres: Vec<Point> = (0..count).map(|_| [0; 3].map(|_| side * random.unit())).collect();
        let radii: Vec<f64> = (0..count).map(|_| 2.4 + random.unit()).collect();
        check(&centres, &radii, 1.4, step, 1e-2);
        // Coarse ones are closed, too.
        let coarse = molecular_mesh(Balls { centres: &centres, radii: &radii }, 1.4, 1.0, ONE).unwrap();
        check_closed(&coarse.triangles);
        check_vertices(&coarse, &centres, &radii, 1.4);
        let threads = NonZeroUsize::new(2).unwrap();
        let again = molecular_mesh(Balls { centres: &centres, radii: &radii }, 1.4, 1.0, threads).unwrap();
        assert_eq!(again, coarse);
    }
}

/// A cage of balls around a space that holds a probe: two surfaces.
#[test]
fn cavities_have_surfaces_of_their_own() {
    let range = || 0..=4;
    let sites = range().flat_map(|x| range().flat_map(move |y| range().map(move |z| [x, y, z])));
    let shell = sites.filter(|site: &[i32; 3]| site.iter().any(|&c| c == 0 || c == 4));
    let centres: Vec<Point> = shell.map(|site| site.map(|c| 2.0 * f64::from(c))).collect();
    let radii = vec![2.9; centres.len()];
    let mesh = check(&centres, &radii, 1.4, 0.2, 1e-2);
    let mut volumes = volumes(&mesh);
    volumes.sort_by(f64::total_cmp);
    assert_eq!(volumes.len(), 2);
    assert!(volumes[0] < -10.0 && volumes[1] > 500.0, "{volumes:?}");
}

#[test]
fn what_has_no_mesh_is_refused() {
    let mesh = |probe, step| {
        let balls = Balls { centres: &[[0.0; 3], [1e9, 0.0, 0.0]], radii: &[2.0, 2.0] };
        molecular_mesh(balls, probe, step, ONE)
    };
    for (probe, step) in [(0.0, 0.1), (1.0, 0.0), (1.0, f64::NAN), (3.0, 0.1), (1.0, 0.1), (f64::NAN, 0.1)] {
        assert!(mesh(probe, step).is_err(), "{probe} {step}");
    }
    let empty = molecular_mesh(Balls { centres: &[], radii: &[] }, 1.0, 0.1, ONE).unwrap();
    assert_eq!(empty, Surface::default());
}
