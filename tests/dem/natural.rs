//! Rasters by natural neighbours: the same for every order of triangles, and exact for planes.

use spmesh_delaunay::delaunay2::triangulate;
use spmesh_formats::raster::{Grid, RasterFormat};
use spmesh_reference::sets::Random;
use spmesh_stream::Coordinates;
use spmesh_terrain::dem::{Options, Quantity};

use super::{Mesh, file, is_same, options, raster};

fn natural() -> Options {
    Options { natural: true, ..options(Quantity::Elevation) }
}

fn points(random: &mut Random, most: i64, count: usize) -> Vec<[i64; 2]> {
    let mut points: Vec<[i64; 2]> =
        (0..count).map(|_| [random.integer(0, most), random.integer(0, most)]).collect();
    points.sort_unstable();
    points.dedup();
    points
}

#[test]
fn neither_order_nor_memory_changes_a_cell() {
    let mut random = Random::new(21);
    for most in [12, 400] {
        let places = points(&mut random, most, 150);
        let mesh = Mesh::of(&mut random, &places);
        let side = most as f64 / 600.0;
        let grid = Grid { left: -side, top: most as f64 + side, step: side, columns: 602, rows: 602 };
        let expected = raster(&mesh.stream(Coordinates::F64), &grid, &natural());
        let linear = raster(&mesh.stream(Coordinates::F64), &grid, &options(Quantity::Elevation));
        assert!(expected.iter().zip(&linear).all(|(a, b)| a.is_nan() == b.is_nan()));
        let differ = expected.iter().zip(&linear).filter(|(a, b)| a != b).count();
        assert!(2 * differ > expected.iter().filter(|value| !value.is_nan()).count(), "{differ}");
        // Four tiles of sums are held at least, and two of elevations.
        for memory in [1 << 30, 36 << 20] {
            let shuffled = mesh.shuffled(&mut random).stream(Coordinates::F64);
            assert!(is_same(&raster(&shuffled, &grid, &Options { memory, ..natural() }), &expected));
        }
    }
}

#[test]
fn planes_stay_planes_and_points_have_their_elevation() {
    let mut random = Random::new(22);
    let places = points(&mut random, 40, 200);
    let mut mesh = Mesh::of(&mut random, &places);
    let grid = Grid { left: -0.5, top: 40.5, step: 1.0, columns: 41, rows: 41 };
    let at = |[x, y]: [i64; 2]| (40 - y) as usize * 41 + x as usize;
    let values = raster(&mesh.stream(Coordinates::F64), &grid, &natural());
    assert!(places.iter().zip(&mesh.points).all(|(&place, point)| values[at(place)] == point[2] as f32));
    mesh.points.iter_mut().for_each(|point| point[2] = 3.0 * point[0] - 2.0 * point[1] + 100.0);
    let values = raster(&mesh.stream(Coordinates::F64), &grid, &natural());
    let known =
        (0..41).flat_map(|y| (0..41).map(move |x| [x, y])).filter(|&place| !values[at(place)].is_nan());
    let mut count = 0;
    for [x, y] in known {
        let error = f64::from(values[at([x, y])]) - (3 * x - 2 * y + 100) as f64;
        assert!(error.abs() < 2e-5, "{error:e} at {x}, {y}");
        count += 1;
    }
    assert!(count > 1200, "{count}");
}

#[test]
fn points_at_centres_keep_their_elevation_though_they_are_no_integers() {
    let mut random = Random::new(23);
    for step in [0.7, 30.87, 0.1] {
        let places: Vec<[i64; 2]> = (0..40).flat_map(|x| (0..40).map(move |y| [x, y])).collect();
        let at = |[x, y]: [i64; 2]| [(x as f64 + 0.5) * step, (y as f64 + 0.5) * step];
        let placed: Vec<[f64; 2]> = places.iter().map(|&place| at(place)).collect();
        let points = placed.iter().map(|&[x, y]| [x, y, random.integer(0, 999) as f64]).collect();
        let mesh = Mesh { points, triangles: triangulate(&placed).unwrap().simplices().collect() };
        let grid = Grid { left: 0.0, top: 40.0 * step, step, columns: 40, rows: 40 };
        let values = raster(&mesh.stream(Coordinates::F64), &grid, &natural());
        // Rounding puts some centres at the border outside.
        let is_inner = |[x, y]: [i64; 2]| (1..39).contains(&x) && (1..39).contains(&y);
        for (&[x, y], point) in places.iter().zip(&mesh.points).filter(|(place, _)| is_inner(**place)) {
            let value = f64::from(values[(39 - y) as usize * 40 + x as usize]);
            assert!((value - point[2]).abs() < 1e-3, "{value} for {} at {x}, {y} times {step}", point[2]);
        }
    }
}

#[test]
fn meshes_that_are_not_delaunay_are_refused() {
    let points = [[0.0, 0.0, 0.0], [10.0, -1.0, 1.0], [20.0, 0.0, 2.0], [10.0, 1.0, 3.0]].to_vec();
    let grid = Grid { left: 0.0, top: 2.0, step: 1.0, columns: 20, rows: 4 };
    let of = |triangles: [[u32; 3]; 2]| {
        let mesh = Mesh { points: points.clone(), triangles: triangles.to_vec() };
        file(&mesh.stream(Coordinates::F64), RasterFormat::Ascii, &grid, &natural())
    };
    assert!(of([[0, 1, 3], [1, 2, 3]]).is_ok());
    let message = of([[0, 1, 2], [0, 2, 3]]).unwrap_err().to_string();
    assert!(message.contains("not Delaunay"), "{message}");
}
