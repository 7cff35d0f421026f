//! Mean, least and greatest elevations over cells, against clipping each triangle to each cell.

use spmesh_formats::raster::{Grid, RasterFormat};
use spmesh_reference::sets::Random;
use spmesh_stream::Coordinates;
use spmesh_terrain::dem::{Method, Options, Quantity, Sample};

use super::tiles::tiff_values;
use super::{Mesh, file, is_same, options, raster};

/// A polygon: x, y and elevation of its corners.
type Polygon = Vec<[f64; 3]>;

/// The part of a polygon where a linear function of x and y is not negative.
fn half(polygon: &Polygon, side: impl Fn(&[f64; 3]) -> f64) -> Polygon {
    let mut part = Vec::new();
    for (at, corner) in polygon.iter().enumerate() {
        let next = &polygon[(at + 1) % polygon.len()];
        let [here, there] = [side(corner), side(next)];
        if here >= 0.0 {
            part.push(*corner);
        }
        if here * there < 0.0 {
            let share = here / (here - there);
            part.push([0, 1, 2].map(|axis| (1.0 - share) * corner[axis] + share * next[axis]));
        }
    }
    part
}

/// Covered area, integral, least and greatest elevation of each cell.
fn covers(mesh: &Mesh, grid: &Grid) -> Vec<[f64; 4]> {
    let mut covers = Vec::new();
    for (row, column) in (0..grid.rows).flat_map(|row| (0..grid.columns).map(move |column| (row, column))) {
        let left = grid.left + f64::from(column) * grid.step;
        let top = grid.top - f64::from(row) * grid.step;
        let mut cover = [0.0, 0.0, f64::INFINITY, f64::NEG_INFINITY];
        for triangle in &mesh.triangles {
            let mut part: Polygon = triangle.iter().map(|&corner| mesh.points[corner as usize]).collect();
            part = half(&part, |corner| corner[0] - left);
            part = half(&part, |corner| left + grid.step - corner[0]);
            part = half(&part, |corner| top - corner[1]);
            part = half(&part, |corner| corner[1] - (top - grid.step));
            let mut size = 0.0;
            for at in 1..part.len().max(2) - 1 {
                let [a, b, c] = [part[0], part[at], part[at + 1]];
                let area = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0;
                size += area;
                cover[1] += area * (a[2] + b[2] + c[2]) / 3.0;
            }
            cover[0] += size;
            if size > 1e-15 * grid.step * grid.step {
                for corner in part {
                    cover[2] = cover[2].min(corner[2]);
                    cover[3] = cover[3].max(corner[2]);
                }
            }
        }
        covers.push(cover);
    }
    covers
}

fn sampled(sample: Sample) -> Options {
    Options { sample, ..options(Quantity::Elevation) }
}

fn check(mesh: &Mesh, grid: &Grid) {
    let stream = mesh.stream(Coordinates::F64);
    let shuffled = mesh.shuffled(&mut Random::new(1)).stream(Coordinates::F64);
    let covers = covers(mesh, grid);
    for (which, sample) in [Sample::Mean, Sample::Min, Sample::Max].into_iter().enumerate() {
        let found = raster(&stream, grid, &sampled(sample));
        for (cell, (value, cover)) in found.iter().zip(&covers).enumerate() {
            let [area, integral, least, greatest] = *cover;
            let expected = [integral / area, least, greatest][which];
            let is_covered = area > 1e-12 * grid.step * grid.step;
            if !is_covered {
                // So little that rounding decides.
                continue;
            }
            let off = (f64::from(*value) - expected).abs();
            assert!(off <= 1e-6 * 1000.0, "{sample:?}, cell {cell}: {value} {expected} of {area}");
        }
        let uncovered = |(value, cover): (&f32, &[f64; 4])| cover[0] == 0.0 && !value.is_nan();
        assert!(!found.iter().zip(&covers).any(uncovered));
        // Neither the order of triangles nor memory shows: half of the least has four tiles of 32 bytes a
        // cell.
        let tight = Options { memory: 16 << 20, ..sampled(sample) };
        assert!(is_same(&found, &raster(&shuffled, grid, &tight)), "{sample:?}");
        let (tiff, _) = file(&shuffled, RasterFormat::GeoTiff, grid, &tight).unwrap();
        assert!(is_same(&found, &tiff_values(&tiff, grid)));
    }
}

fn mesh(seed: u64, count: i64, size: i64) -> Mesh {
    let mut random = Random::new(seed);
    let mut points: Vec<[i64; 2]> = (0..count).map(|_| [0, 1].map(|_| random.integer(0, size))).collect();
    points.sort_unstable();
    points.dedup();
    Mesh::of(&mut random, &points)
}

#[test]
fn cells_have_the_mean_and_the_extremes_of_the_surface() {
    for (seed, count, size) in [(1, 3, 20), (2, 40, 20), (3, 120, 60), (4, 60, 8)] {
        let mesh = mesh(seed, count, size);
        // Sides of cells on edges and corners; others; cells larger than triangles, and than the mesh.
        for (left, step) in [(0.0, 1.0), (-0.37, 0.83), (-2.0, 4.0), (-40.3, 100.0)] {
            let cells = (size as f64 / step) as u32 + 3;
            let grid = Grid { left, top: size as f64 + 0.6 * step, step, columns: cells, rows: cells };
            check(&mesh, &grid);
        }
    }
}

/// Triangles of no width but a length, and many tiles.
#[test]
fn slivers_and_tiles_add_up() {
    let mut points: Vec<[f64; 3]> =
        (0..40).map(|i| [f64::from(i) * 15.0, f64::from(i % 2) * 1e-7, f64::from(i * 7 % 11)]).collect();
    points.extend((0..40).map(|i| [f64::from(i) * 15.0, 300.0, f64::from(i % 5)]));
    let mut triangles = Vec::new();
    for i in 0..39 {
        triangles.extend([[i, i + 1, i + 41], [i, i + 41, i + 40]]);
    }
    let mesh = Mesh { points, triangles };
    let grid = Grid { left: -3.0, top: 301.0, step: 2.0, columns: 300, rows: 153 };
    check(&mesh, &grid);
}

/// A plane has its own mean, and slopes follow from sampled cells.
#[test]
fn planes_keep_their_slope() {
    let plane = |x: f64, y: f64| [x, y, 2.0 * x + y];
    let mesh = Mesh {
        points: vec![plane(0.0, 0.0), plane(40.0, 0.0), plane(40.0, 40.0), plane(0.0, 40.0)],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    };
    let stream = mesh.stream(Coordinates::F64);
    let grid = Grid { left: 0.0, top: 40.0, step: 4.0, columns: 10, rows: 10 };
    let centres = raster(&stream, &grid, &sampled(Sample::Centre));
    assert_eq!(centres, raster(&stream, &grid, &sampled(Sample::Mean)));
    let shift = |sample, by: f32| {
        let found = raster(&stream, &grid, &sampled(sample));
        assert!(found.iter().zip(&centres).all(|(found, centre)| found - centre == by), "{sample:?}");
    };
    shift(Sample::Min, -6.0);
    shift(Sample::Max, 6.0);
    let slopes = Options {
        quantity: Quantity::Slope,
        method: Method::Cells(spmesh_formats::raster::Differences::Horn),
        ..sampled(Sample::Max)
    };
    let expected = 5f64.sqrt().atan().to_degrees() as f32;
    let found = raster(&stream, &grid, &slopes);
    assert_eq!(found.iter().filter(|slope| !slope.is_nan()).count(), 64);
    assert!(found.iter().all(|slope| slope.is_nan() || *slope == expected));
}

#[test]
fn empty_meshes_have_no_samples() {
    let empty = Mesh { points: Vec::new(), triangles: Vec::new() }.stream(Coordinates::F64);
    let grid = Grid { left: 0.0, top: 3.0, step: 1.0, columns: 3, rows: 3 };
    assert!(raster(&empty, &grid, &sampled(Sample::Mean)).iter().all(|value| value.is_nan()));
}
