//! Masks against a test of each centre in integers.

use std::sync::Arc;

use spmesh_formats::raster::{Grid, RasterFormat};
use spmesh_formats::source::{Mask, Polygon};
use spmesh_stream::Coordinates;
use spmesh_terrain::dem::{Options, Quantity};

use super::tiles::tiff_values;
use super::{Mesh, file, is_same, options, raster, values};
use crate::programs::{Folder, assert_outcome, mesh_of_cloud};
use spmesh_reference::sets::Random;

/// A place in halves of a unit: all coordinates are multiples of these.
fn halves([x, y]: [f64; 2]) -> [i64; 2] {
    [x, y].map(|value| (value * 2.0) as i64)
}

/// The edges of a polygon that reach this far up and down: the other ones do not matter to places at this
/// `y`.
fn edges_at(polygon: &Polygon, y: f64) -> Vec<[[i64; 2]; 2]> {
    let edges = polygon.iter().flat_map(|ring| {
        ring.iter().enumerate().map(|(number, &from)| [from, ring[(number + 1) % ring.len()]].map(halves))
    });
    let [y, _] = halves([y, 0.0]);
    edges.filter(|[a, b]| a[1].min(b[1]) <= y && y <= a[1].max(b[1])).collect()
}

/// Whether a place is in a polygon or on its border.
fn is_in(polygon: &Polygon, at: [f64; 2]) -> bool {
    is_between_edges(&edges_at(polygon, at[1]), at)
}

/// As [`is_in`], with the edges at the y of the place.
fn is_between_edges(edges: &[[[i64; 2]; 2]], at: [f64; 2]) -> bool {
    let p = halves(at);
    let mut crossings = 0;
    for &[a, b] in edges {
        let area = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
        if area == 0 && a[0].min(b[0]) <= p[0] && p[0] <= a[0].max(b[0]) {
            return true;
        }
        // A ray to the right passes the edge.
        crossings += i32::from((a[1] > p[1]) != (b[1] > p[1]) && (area > 0) == (b[1] > a[1]));
    }
    crossings % 2 == 1
}

/// Flat ground under a grid.
fn ground(grid: &Grid) -> Vec<u8> {
    let [right, bottom] =
        [grid.left + grid.step * f64::from(grid.columns), grid.top - grid.step * f64::from(grid.rows)];
    let corners = [[grid.left, bottom], [right, bottom], [right, grid.top], [grid.left, grid.top]];
    let points = corners.iter().map(|[x, y]| [*x, *y, x + y]).collect();
    Mesh { points, triangles: vec![[0, 1, 2], [0, 2, 3]] }.stream(Coordinates::F64)
}

fn masked(mask: Vec<Polygon>) -> Options {
    Options { mask: Some(Arc::new(Mask { polygons: mask })), ..options(Quantity::Elevation) }
}

#[test]
fn cells_with_centres_in_polygons_have_data() {
    let mut random = Random::new(21);
    let grid = Grid { left: -20.0, top: 300.0, step: 1.0, columns: 300, rows: 280 };
    let stream = ground(&grid);
    let whole = raster(&stream, &grid, &options(Quantity::Elevation));
    for round in 0..12 {
        // Corners on centres of cells, on their corners, beyond the grid; rings that cross themselves and each
        // other, and level edges.
        let mut corner =
            |spread: i64| [random.integer(-spread, 600) as f64 / 2.0, random.integer(0, 640) as f64 / 2.0];
        let mut ring = |count: usize| {
            let mut ring: Vec<[f64; 2]> = (0..count).map(|_| corner(100)).collect();
            ring[1][1] = ring[0][1];
            ring
        };
        let count = if round < 6 { 4 + round } else { 300 };
        let polygons: Vec<Polygon> = vec![vec![ring(count), ring(5)], vec![ring(3)], vec![ring(3)]];
        let mut expected = vec![f32::NAN; whole.len()];
        for row in 0..280 {
            let y = grid.top - row as f64 - 0.5;
            let edges: Vec<_> = polygons.iter().map(|polygon| edges_at(polygon, y)).collect();
            for column in 0..300 {
                let center = [grid.left + column as f64 + 0.5, y];
                if edges.iter().any(|edges| is_between_edges(edges, center)) {
                    expected[300 * row + column] = whole[300 * row + column];
                }
            }
        }
        for memory in [1 << 30, 1] {
            let options = Options { memory, ..masked(polygons.clone()) };
            let (text, stats) = file(&stream, RasterFormat::Ascii, &grid, &options).unwrap();
            assert!(is_same(&values(&text), &expected), "{round}");
            let (bytes, of_tiff) = file(&stream, RasterFormat::GeoTiff, &grid, &options).unwrap();
            assert!(is_same(&tiff_values(&bytes, &grid), &expected), "{round}");
            assert_eq!(stats.known, of_tiff.known);
        }
    }
}

#[test]
fn borders_are_inside() {
    let grid = Grid { left: 0.0, top: 6.0, step: 1.0, columns: 6, rows: 6 };
    let ring = |min: f64, max: f64| vec![[min, min], [max, min], [max, max], [min, max]];
    // Centres 1.5 to 4.5; the hole leaves its border.
    let found = raster(&ground(&grid), &grid, &masked(vec![vec![ring(1.5, 4.5), ring(1.5, 3.5)]]));
    let known: String = found.iter().map(|value| if value.is_nan() { '.' } else { '#' }).collect();
    assert_eq!(known, "....../.####./.####./.#.##./.####./......".replace('/', "").as_str());
}

#[test]
fn holes_are_filled_inside_of_the_mask_alone() {
    let grid = Grid { left: 0.0, top: 40.0, step: 1.0, columns: 40, rows: 40 };
    // Around a killed strip in the middle.
    let xs = [0.0, 10.0, 30.0, 40.0];
    let points =
        xs.iter().flat_map(|&x| [[x, 0.0, 1.0], [x, 15.0, 1.0], [x, 30.0, 1.0], [x, 40.0, 1.0]]).collect();
    let square = |i: u32| [[i, i + 4, i + 5], [i, i + 5, i + 1]];
    let triangles = (0..12).filter(|i| i % 4 != 3).flat_map(square).collect();
    let stream = Mesh { points, triangles }.stream(Coordinates::F64);
    let polygon = vec![vec![[5.5, 5.5], [20.5, 5.5], [20.5, 20.5], [5.5, 20.5]]];
    let options = Options { kill: Some(19.0), fill: Some(40), ..masked(vec![polygon.clone()]) };
    let found = raster(&stream, &grid, &options);
    for (cell, value) in found.iter().enumerate() {
        let center = [(cell % 40) as f64 + 0.5, 39.5 - (cell / 40) as f64];
        assert_eq!(!value.is_nan(), is_in(&polygon, center), "{center:?}");
    }
}

#[test]
fn files_of_masks_are_read_and_refused() {
    let folder = Folder::new();
    let mesh = mesh_of_cloud(500);
    let mask = &folder.path("mask.wkt")[..];
    folder.file("mask.wkt", "POLYGON((0 0,50000 0,50000 50000,0 50000,0 0))");
    let flags = ["--columns", "40", "-o", "/dev/null", "--mask", mask];
    assert_outcome("spdem", &flags, &mesh, 0, "without data");
    folder.file("mask.wkt", "POLYGON((0 0,50000 0,50000 50000))");
    assert_outcome("spdem", &flags, &mesh, 3, "mask.wkt: line 1: ring 0: it starts at 0, 0");
    folder.file("mask.wkt", r#"{"type":"LineString","coordinates":[[0,0],[1,1]]}"#);
    assert_outcome("spdem", &flags, &mesh, 3, "mask.wkt: feature 0: found a line, expected polygons");
    assert_outcome("spdem", &["--mask", mask, "-o", mask], &mesh, 2, "mask.wkt");
}
