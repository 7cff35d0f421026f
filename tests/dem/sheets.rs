//! `--tiles`: many rasters in one pass, against windows of the raster of the whole.

use std::collections::HashMap;
use std::fs;
use std::io::Cursor;

use super::tiles::{mesh_and_grid, tiff_values};
use super::{is_same, options, raster, values};
use crate::programs::{Folder, assert_outcome, mesh_of_cloud, outcome, run, sample};
use spmesh_formats::raster::{Differences, Grid, RasterFormat, RasterOptions};
use spmesh_stream::StreamReader;
use spmesh_terrain::dem::{Method, Options, Quantity, Sample, rasterize};
use spmesh_terrain::files::{Destination, Division, Index, Pattern, SheetSize, Sheets};

/// The files of a raster by name, and how many sheets have no data. Sheets replace or remove `old` files.
pub(super) fn sheets(
    stream: &[u8],
    grid: &Grid,
    options: &Options,
    division: Division,
    old: &[&str],
) -> (HashMap<String, Vec<u8>>, u64) {
    let folder = Folder::new();
    let path = folder.root().join("all.x");
    // Of an earlier run.
    old.iter().chain(&["other.x"]).for_each(|name| drop(folder.file(name, "old")));
    let mut sheets =
        Sheets::new(&path, division, Pattern::usual(division.size), Index::default(), options.raster.format)
            .unwrap();
    let mut reader = StreamReader::new(stream, "mesh").unwrap();
    let output: Destination<Cursor<Vec<u8>>> = Destination::Sheets(&mut sheets);
    rasterize(&mut reader, output, grid, options, |_| {}).unwrap();
    let mut files: HashMap<String, Vec<u8>> = folder
        .names("")
        .into_iter()
        .map(|name| (name.clone(), fs::read(folder.path(&name)).unwrap()))
        .collect();
    assert_eq!(files.remove("other.x").unwrap(), b"old");
    assert_eq!(sheets.written, files.len() as u64);
    assert_eq!(sheets.bytes, files.values().map(|bytes| bytes.len() as u64).sum::<u64>());
    (files, sheets.blank)
}

/// Compares each sheet with the part of the whole that its name and the margin state.
fn check(stream: &[u8], grid: &Grid, options: &Options, sizes: [f64; 2], old: &[&str]) {
    check_parts(&raster(stream, grid, options), stream, grid, options, sizes, old);
}

/// As [`check`], with the raster of the whole.
fn check_parts(
    whole: &[f32],
    stream: &[u8],
    grid: &Grid,
    options: &Options,
    [side, margin]: [f64; 2],
    old: &[&str],
) {
    let division = Division { size: SheetSize::Side(side), anchor: [0.0; 2], buffer: margin, is_full: false };
    let (mut files, blank) = sheets(stream, grid, options, division, old);
    let squares = |low: f64, high: f64| (low / side).floor() as i64..=((high / side).ceil() as i64 - 1);
    let (right, all) = (grid.left + f64::from(grid.columns) * grid.step, squares);
    let mut without_data = 0;
    for (x, y) in all(grid.left, right)
        .flat_map(|x| all(grid.bottom(), grid.top).map(move |y| (x as f64 * side, y as f64 * side)))
    {
        // Cells with a centre in the square, and as many more as the margin covers.
        let inside = |count: u32, centre: &dyn Fn(u32) -> f64, low: f64| -> Option<[u32; 2]> {
            let cells: Vec<u32> = (0..count).filter(|&at| (low..low + side).contains(&centre(at))).collect();
            let more = (margin / grid.step).ceil() as u32;
            Some([cells.first()?.saturating_sub(more), (cells.last()? + 1 + more).min(count)])
        };
        let columns = inside(grid.columns, &|column| grid.x_of(column), x);
        let rows = inside(grid.rows, &|row| grid.y_of(row), y);
        let (Some([left, right]), Some([top, bottom])) = (columns, rows) else { continue };
        let expected: Vec<f32> = (top..bottom)
            .flat_map(|row| (left..right).map(move |column| (row, column)))
            .map(|(row, column)| whole[(row * grid.columns + column) as usize])
            .collect();
        let decimals = usize::from(side.fract() != 0.0);
        let file = files.remove(&format!("all_{x:.decimals$}_{y:.decimals$}.x"));
        if expected.iter().all(|value| value.is_nan()) {
            assert_eq!(file, None, "{x} {y}");
            without_data += 1;
            continue;
        }
        let part = Grid { columns: right - left, rows: bottom - top, ..*grid };
        let found = match options.raster.format {
            RasterFormat::Ascii => values(&file.unwrap()),
            RasterFormat::GeoTiff => tiff_values(&file.unwrap(), &part),
        };
        assert!(is_same(&found, &expected), "{x} {y}");
    }
    assert_eq!((files.len(), blank), (0, without_data));
}

#[test]
fn sheets_are_parts_of_the_whole() {
    let (stream, grid) = mesh_and_grid();
    let slope = Options { method: Method::Cells(Differences::Horn), ..options(Quantity::Slope) };
    let filled = Options { kill: Some(60.0), fill: Some(9), ..options(Quantity::Elevation) };
    let mean = Options { sample: Sample::Mean, ..options(Quantity::Elevation) };
    let cases = [
        (options(Quantity::Elevation), 160.0, 0.0),
        (options(Quantity::Elevation), 333.3, 12.5),
        (slope, 250.0, 1.6),
        (filled, 400.0, 300.0),
        (mean, 100.0, 0.0),
    ];
    for (case, side, margin) in cases {
        // Formats and memory do not show in it.
        let whole = raster(&stream, &grid, &case);
        let least = if case.sample == Sample::Centre { 0 } else { 16 << 20 };
        for (format, memory) in [(RasterFormat::GeoTiff, least), (RasterFormat::Ascii, 1 << 30)] {
            let raster = RasterOptions { format, ..RasterOptions::default() };
            let options = Options { raster, memory, ..case.clone() };
            check_parts(&whole, &stream, &grid, &options, [side, margin], &[]);
        }
    }
}

#[test]
fn sheets_without_data_are_not_written_and_old_ones_are_removed() {
    let (stream, _) = mesh_and_grid();
    // The mesh ends at 1000.
    let grid = Grid { left: 0.0, top: 1e4, step: 10.0, columns: 100, rows: 1000 };
    check(&stream, &grid, &options(Quantity::Elevation), [100.0, 0.0], &["all_0_0.x", "all_100_9900.x"]);
}

#[test]
fn rasters_of_points_and_canopies_are_divided_too() {
    let folder = Folder::new();
    let points = run("spfinalize", &[&sample("lareunion.laz")], &[]).stdout;
    let mesh = folder.write("ground.spm", run("spdelaunay2d", &[], &points).stdout);
    let tile = sample("lareunion.laz");
    let jobs: [(&str, Vec<&str>, &[u8]); 2] = [
        ("spdem", vec!["--points", "--kind", "max", "--step", "0.5"], &points),
        ("spcanopy", vec!["--ground", &mesh, &tile, "--step", "0.5"], &[]),
    ];
    for (name, arguments, input) in jobs {
        let write = |flags: &[&str], path: &str| {
            let all: Vec<&str> = arguments.iter().chain(flags).copied().chain(["-o", path]).collect();
            let output = run(name, &all, input);
            assert!(output.status.success(), "{:?}", outcome(&output));
            outcome(&output).1
        };
        write(&["--tiles", "1,1"], &folder.path("part.asc"));
        write(&[], &folder.path("whole.asc"));
        let read = |name: &str| fs::read(folder.path(name)).unwrap();
        assert!(read("part_0_0.asc") == read("whole.asc"), "{name}");
        let message = write(&["--tiles", "2,3"], &folder.path(&format!("{name}.tif")));
        assert!(message.contains("6 rasters"), "{message}");
        for (x, y) in (0..2).flat_map(|x| (0..3).map(move |y| (x, y))) {
            assert!(!read(&format!("{name}_{x}_{y}.tif")).is_empty());
        }
    }
}

#[test]
fn wrong_divisions_are_refused() {
    let folder = Folder::new();
    let mesh = super::pipelines::mesh();
    let path = folder.path("all.tif");
    let refused = |flags: &[&str], part: &str| {
        let arguments: Vec<&str> = flags.iter().copied().chain(["-o", &path]).collect();
        assert_outcome("spdem", &arguments, &mesh, 2, part);
    };
    for size in ["0", "-5", "x", "2,0", "2,3,4", "nan", "inf", "2,"] {
        refused(&["--tiles", size], "expected the side of rasters");
    }
    refused(&["--tiles", "9", "--buffer", "-1"], "--buffer takes a length from 0 on");
    refused(&["--tiles", "9", "--buffer", "inf"], "--buffer takes a length from 0 on");
    refused(&["--buffer", "1"], "--tiles");
    refused(&["--tiles", "9", "--contours", "5"], "cannot be used with");
    refused(&["--tiles", "0.5", "--step", "1"], "smaller than a cell");
    refused(&["--tiles", "51,1", "--step", "1"], "cannot be divided");
    assert_outcome("spdem", &["--tiles", "9"], &mesh, 2, "--tiles writes many files");
    assert_outcome("spdem", &["--tiles", "9", "-o", "/dev/stdout"], &mesh, 2, "--tiles writes many files");
    assert_eq!(folder.names(""), Vec::<String>::new());
    let output = run("spdem", &["--step", "1", "--tiles", "1,1", "-o", &path], &mesh);
    assert!(output.status.success());
    let like = folder.path("all_0_0.tif");
    refused(&["--tiles", "1,1", "--like", &like], "would replace the input");
}

#[test]
fn the_folder_of_sheets_is_made() {
    let folder = Folder::new();
    let (mesh, name) = (mesh_of_cloud(100), folder.path("new/folder/dem.asc"));
    assert_outcome("spdem", &["--columns", "8", "--tiles", "2,2", "-o", &name], &mesh, 0, "4 rasters");
    assert_eq!(folder.names("new/folder").len(), 4);
}
