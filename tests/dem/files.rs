//! Filled holes, overviews, other no-data values, and grids taken from other files.

use std::io::Cursor;

use spmesh_formats::raster::{Grid, NoData, RasterFormat, RasterOptions, TILE};
use spmesh_terrain::dem::{Options, Quantity};
use tiff::decoder::Decoder;

use super::tiles::{mesh_and_grid, tiff_values};
use super::{file, is_same, options, raster, values};
use crate::programs::{Folder, cloud, outcome, run};

/// The mean of the nearest values in eight directions within reach, weighted by inverse distance.
fn filled(values: &[f32], columns: usize, at: [usize; 2], reach: i64) -> f32 {
    let rows = values.len() / columns;
    let cell = |[x, y]: [i64; 2]| {
        let is_inside = (0..columns as i64).contains(&x) && (0..rows as i64).contains(&y);
        is_inside.then(|| values[y as usize * columns + x as usize]).filter(|value| !value.is_nan())
    };
    let (mut sum, mut weights) = (0.0, 0.0);
    for [dx, dy] in [[-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0], [1, 1], [0, 1], [-1, 1]] {
        let distance = |step: i64| step as f64 * ((dx * dx + dy * dy) as f64).sqrt();
        let steps = (1..=reach).filter(|&step| distance(step) <= reach as f64);
        let found = steps.map(|step| (step, cell([at[0] as i64 + dx * step, at[1] as i64 + dy * step])));
        if let Some((step, Some(value))) = { found }.find(|(_, value)| value.is_some()) {
            sum += f64::from(value) / distance(step);
            weights += 1.0 / distance(step);
        }
    }
    (sum / weights) as f32
}

#[test]
fn holes_are_filled_from_what_is_near() {
    let (stream, _) = mesh_and_grid();
    // Centres of cells are not rounded, so they are the same in both rasters.
    let grid = Grid { left: -19.5, top: 900.25, step: 1.625, columns: 640, rows: 566 };
    let whole = Options { kill: Some(150.0), ..options(Quantity::Elevation) };
    // The mesh goes on above the raster, and cells there count, too.
    let above = 80;
    let wide = Grid { top: grid.top + f64::from(above) * grid.step, rows: grid.rows + above, ..grid };
    let drawn = raster(&stream, &wide, &whole);
    // Cells outside of the convex hull stay empty.
    let covered = raster(&stream, &wide, &options(Quantity::Elevation));
    let columns = grid.columns as usize;
    for reach in [1, 40] {
        for memory in [1 << 30, 600_000] {
            let options = Options { fill: Some(reach), memory, ..whole.clone() };
            let (text, stats) = file(&stream, RasterFormat::Ascii, &grid, &options).unwrap();
            let found = values(&text);
            let (bytes, of_tiff) = file(&stream, RasterFormat::GeoTiff, &grid, &options).unwrap();
            assert!(is_same(&found, &tiff_values(&bytes, &grid)), "{reach}");
            assert_eq!((stats.known, stats.filled), (of_tiff.known, of_tiff.filled));
            let mut count = 0;
            for (&value, number) in found.iter().zip(above as usize * columns..) {
                let before = drawn[number];
                let is_inside = !covered[number].is_nan();
                let at = [number % columns, number / columns];
                let is_hole = is_inside && before.is_nan();
                let expected = if is_hole { filled(&drawn, columns, at, i64::from(reach)) } else { before };
                let is_near = (value - expected).abs() <= 1e-3 || value.is_nan() && expected.is_nan();
                assert!(is_near, "{reach}: cell {number} has {value}, expected {expected}");
                count += u64::from(before.is_nan() && !value.is_nan());
            }
            assert_eq!(stats.filled, count);
            assert!(count > 100);
        }
    }
}

#[test]
fn complete_tiles_are_sources_for_their_neighbours() {
    // A square that covers the first of two tiles in a row and a small part of the second; the rest of the
    // second is covered by triangles with a long edge.
    let corners = [[0.0, 0.0], [300.0, 0.0], [512.0, 0.0], [512.0, 256.0], [300.0, 256.0], [0.0, 256.0]];
    let points = corners.iter().map(|&[x, y]| [x, y, 5.0]).chain([[900.0, 128.0, 5.0]]).collect();
    let triangles = vec![[0, 1, 4], [0, 4, 5], [1, 6, 4], [1, 2, 6], [4, 6, 3]];
    let mesh = super::Mesh { points, triangles };
    let stream = mesh.stream(spmesh_stream::Coordinates::F64);
    let grid = Grid { left: 0.0, top: 256.0, step: 1.0, columns: 512, rows: 256 };
    let options = Options { fill: Some(100), kill: Some(500.0), ..options(Quantity::Elevation) };
    let (bytes, stats) = file(&stream, RasterFormat::GeoTiff, &grid, &options).unwrap();
    let found = tiff_values(&bytes, &grid);
    let is_row_filled =
        |row: &[f32]| row.iter().enumerate().all(|(cell, value)| (cell < 400) == (*value == 5.0));
    assert!(found.chunks(512).all(is_row_filled));
    assert_eq!((stats.known, stats.filled), (400 * 256, 100 * 256));
}

#[test]
fn overviews_change_no_cell() {
    let (stream, grid) = mesh_and_grid();
    for no_data in [NoData::default(), NoData(f32::NAN), NoData(500.0)] {
        let plain = RasterOptions { no_data, ..RasterOptions::default() };
        let with = RasterOptions { has_overviews: true, ..plain.clone() };
        let decoded = [plain, with].map(|raster| {
            let options = Options { raster, ..options(Quantity::Elevation) };
            let (bytes, _) = file(&stream, RasterFormat::GeoTiff, &grid, &options).unwrap();
            let values = tiff_values(&bytes, &grid);
            let mut decoder = Decoder::new(Cursor::new(bytes)).unwrap();
            let mut images = 1;
            while decoder.more_images() {
                decoder.next_image().unwrap();
                images += 1;
            }
            (images, values)
        });
        assert!(is_same(&decoded[0].1, &decoded[1].1));
        assert!(grid.columns as usize > 2 * TILE);
        assert_eq!([decoded[0].0, decoded[1].0], [1, 3]);
    }
}

#[test]
fn grids_fit_those_of_other_files() {
    let folder = Folder::new();
    let points = run("spfinalize", &["-"], cloud(3_000).as_bytes());
    let mesh = run("spdelaunay2d", &[], &points.stdout).stdout;
    let raster = |name: &str, arguments: &[&str]| {
        let path = folder.path(name);
        let (code, message) = outcome(&run("spdem", &[arguments, &["-o", &path]].concat(), &mesh));
        assert_eq!(code, Some(0), "{message}");
        (spmesh_formats::raster::Grid::of_file(path.as_ref()).unwrap(), std::fs::read(&path).unwrap())
    };
    let (grid, bytes) = raster("a.tif", &["--step", "1000", "--align", "17,-5"]);
    assert_eq!([(grid.left - 17.0) % 1000.0, (grid.top + 5.0) % 1000.0], [0.0, 0.0]);
    let path = folder.path("a.tif");
    let (again, same) = raster("b.tif", &["--like", &path]);
    assert_eq!(again, grid);
    assert!(same == bytes);
    // Through a pipe, tiles are written in rows; the cells do not change.
    let piped = run("spdem", &["--like", &path], &mesh).stdout;
    assert!(is_same(&tiff_values(&piped, &grid), &tiff_values(&bytes, &grid)));
    // Nothing is compared if one system is not known, and heights may differ.
    let (utm, _) = raster("utm.tif", &["--like", &path, "--crs", "EPSG:32631+3855"]);
    let path = folder.path("utm.tif");
    let (unknown, _) = raster("c.tif", &["--like", &path]);
    let (higher, _) = raster("d.tif", &["--like", &path, "--crs", "EPSG:32631+5773"]);
    assert_eq!([utm, unknown, higher], [grid; 3]);
    let next = run("spdem", &["--like", &path, "--crs", "EPSG:32632"], &mesh);
    let (code, message) = outcome(&next);
    let part = "its cells are in EPSG:32631, the data in EPSG:32632";
    assert!(code == Some(2) && message.contains(part), "{code:?}: {message}");
}
