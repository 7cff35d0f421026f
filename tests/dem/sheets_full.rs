//! `--tiles SIZE --full`, and names of tiles by a pattern.

use std::fs;
use std::io::Cursor;

use tiff::decoder::Decoder;
use tiff::tags::Tag;

use super::sheets::sheets;
use super::tiles::{mesh_and_grid, tiff_values};
use super::{is_same, options, raster, values};
use crate::programs::{Folder, assert_outcome, mesh_of_cloud, run};
use spmesh_formats::raster::{Differences, Grid, RasterFormat, RasterOptions};
use spmesh_terrain::dem::{Method, Options, Quantity};
use spmesh_terrain::files::{Division, SheetSize};

/// The left and the upper side of a file.
fn corner(bytes: &[u8], format: RasterFormat, step: f64) -> [f64; 2] {
    match format {
        RasterFormat::GeoTiff => {
            let mut decoder = Decoder::new(Cursor::new(bytes)).unwrap();
            let tie = decoder.get_tag_f64_vec(Tag::Unknown(33922)).unwrap();
            [tie[3], tie[4]]
        }
        RasterFormat::Ascii => {
            let number = |line: usize| -> f64 {
                let line = std::str::from_utf8(bytes).unwrap().lines().nth(line).unwrap();
                line.split(' ').nth(1).unwrap().parse().unwrap()
            };
            [number(2), number(3) + number(1) * step]
        }
    }
}

/// The value of the raster in the cell with this centre; NaN outside of it.
fn value_at(whole: &[f32], grid: &Grid, [x, y]: [f64; 2]) -> f32 {
    let [column, row] = [(x - grid.left) / grid.step, (grid.top - y) / grid.step].map(f64::floor);
    let is_inside =
        (0.0..f64::from(grid.columns)).contains(&column) && (0.0..f64::from(grid.rows)).contains(&row);
    if is_inside { whole[row as usize * grid.columns as usize + column as usize] } else { f32::NAN }
}

#[test]
fn full_sheets_have_no_data_outside_and_the_cells_of_the_whole() {
    let (stream, grid) = mesh_and_grid();
    let slope = Options { method: Method::Cells(Differences::Horn), ..options(Quantity::Slope) };
    let filled = Options { kill: Some(60.0), fill: Some(9), ..options(Quantity::Elevation) };
    // Sides are multiples of the step, margins need not be.
    for (case, side, margin) in
        [(options(Quantity::Elevation), 160.0, 0.0), (slope, 480.0, 17.0), (filled, 1600.0, 3.2)]
    {
        let whole = raster(&stream, &grid, &case);
        for format in [RasterFormat::GeoTiff, RasterFormat::Ascii] {
            let division =
                Division { size: SheetSize::Side(side), anchor: [0.0; 2], buffer: margin, is_full: true };
            let options = Options {
                raster: RasterOptions { format, ..RasterOptions::default() },
                memory: 1 << 20,
                ..case.clone()
            };
            let (mut files, _) = sheets(&stream, &grid, &options, division, &[]);
            let more = (margin / grid.step).ceil();
            let count = (side / grid.step).round() + 2.0 * more;
            let part = Grid { columns: count as u32, rows: count as u32, ..grid };
            let squares = |low: f64, high: f64| (low / side).floor() as i64..(high / side).ceil() as i64;
            let right = grid.left + f64::from(grid.columns) * grid.step;
            for x in squares(grid.left, right) {
                for y in squares(grid.bottom(), grid.top) {
                    let [left, bottom] = [x, y].map(|square| square as f64 * side - more * grid.step);
                    let top = bottom + count * grid.step;
                    let center = |at: usize| {
                        let [column, row] =
                            [at % count as usize, at / count as usize].map(|n| n as f64 + 0.5);
                        [left + column * grid.step, top - row * grid.step]
                    };
                    let expected: Vec<f32> =
                        (0..part.cells() as usize).map(|at| value_at(&whole, &grid, center(at))).collect();
                    let Some(file) = files.remove(&format!("all_{}_{}.x", x * side as i64, y * side as i64))
                    else {
                        assert!(expected.iter().all(|value| value.is_nan()), "{x} {y}");
                        continue;
                    };
                    let place = corner(&file, format, grid.step);
                    assert!((place[0] - left).abs() < 1e-9 && (place[1] - top).abs() < 1e-9, "{place:?}");
                    let found = match format {
                        RasterFormat::Ascii => values(&file),
                        RasterFormat::GeoTiff => tiff_values(&file, &part),
                    };
                    assert!(is_same(&found, &expected), "{x} {y}");
                }
            }
            assert_eq!(files.len(), 0);
        }
    }
}

#[test]
fn tiles_have_the_names_of_a_pattern() {
    let (folder, mesh) = (Folder::new(), mesh_of_cloud(100));
    let path = folder.path("out/dem.asc");
    let write = |flags: &[&str]| {
        let all: Vec<&str> =
            ["-q", "--step", "2000"].iter().chain(flags).copied().chain(["-o", &path]).collect();
        let output = run("spdem", &all, &mesh);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let mut names = folder.names("out");
        names.sort_unstable();
        fs::remove_dir_all(folder.path("out")).unwrap();
        names
    };
    assert_eq!(write(&["--tiles", "1,2", "--tile-name", "{row:3}"]), ["000.asc", "001.asc"]);
    let usual = write(&["--tiles", "20000", "--full"]);
    let named = write(&["--tiles", "20000", "--full", "--tile-name", "{name}_{x_nw}_{y_nw}"]);
    let moved: Vec<String> = usual
        .iter()
        .map(|name| {
            let mut parts = name.trim_end_matches(".asc").rsplitn(3, '_');
            let [y, x] = [0, 1].map(|_| parts.next().unwrap().parse::<i64>().unwrap());
            format!("dem_{x}_{}.asc", y + 20000)
        })
        .collect();
    assert!(usual.len() > 1);
    assert_eq!(named.len(), usual.len());
    assert!(moved.iter().all(|name| named.contains(name)), "{named:?}, expected {moved:?}");
    // A table names all squares but the first, and one that is elsewhere.
    let row = |(number, name): (usize, &String)| {
        let mut parts = name.trim_end_matches(".asc").rsplitn(3, '_');
        let [y, x] = [0, 1].map(|_| parts.next().unwrap().to_string());
        format!("{x},{y},blatt {number}\n")
    };
    let rows: String = usual.iter().enumerate().skip(1).map(row).collect();
    let table = folder.write("names.csv", "x,y,name\n".to_string() + &rows + "-200000,0,nowhere\n");
    let by_table = write(&["--tiles", "20000", "--full", "--tile-table", &table]);
    let mut expected: Vec<String> = (1..usual.len()).map(|number| format!("blatt {number}.asc")).collect();
    expected.sort_unstable();
    assert_eq!(by_table, expected);
    let with_pattern = ["--tiles", "20000", "--tile-name", "d_{sheet}", "--tile-table", &table];
    assert_eq!(write(&with_pattern), expected.iter().map(|name| format!("d_{name}")).collect::<Vec<_>>());
    let refused = |flags: &[&str], part: &str| {
        let all: Vec<&str> = ["--step", "2000"].iter().chain(flags).copied().chain(["-o", &path]).collect();
        assert_outcome("spdem", &all, &mesh, 2, part);
    };
    refused(&["--tiles", "20000", "--tile-name", "a_{x}"], "two rasters would have the name");
    refused(&["--tiles", "20000", "--tile-name", "a_{z}"], "there is no field {z}, but {name}, {sheet}, {x}");
    refused(&["--tiles", "20000", "--tile-name", "a/{x}_{y}"], "-o folder/name.tif");
    refused(&["--tiles", "1,2", "--tile-name", "{x}_{y}"], "take {column} and {row}");
    refused(&["--tiles", "20000", "--tile-name", "{sheet}"], "give --tile-table FILE");
    refused(
        &["--tiles", "20000", "--tile-name", "{x}_{y}", "--tile-table", &table],
        "add {sheet} to --tile-name",
    );
    refused(&["--tiles", "1,2", "--tile-table", &table], "--tile-table names squares");
    refused(&["--tile-name", "{x}_{y}"], "--tiles");
    refused(&["--full"], "--tiles");
    refused(&["--tiles", "1,2", "--full"], "full rasters are squares");
    refused(&["--tiles", "21000", "--full"], "no whole number of cells");
    refused(&["--tiles", "1e12", "--full"], "tiles, at most");
    assert_eq!(folder.names("out"), Vec::<String>::new());
}
