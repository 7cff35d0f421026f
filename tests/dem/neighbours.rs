//! Slopes, aspects and hillshades from neighbouring cells, against the formulas written out on the whole
//! raster.

use std::io::Cursor;

use spmesh_formats::raster::colour_map::{BATLOW, lit};
use spmesh_formats::raster::{Differences, Grid, Light, RasterFormat, RasterOptions, Shading, TILE};
use spmesh_reference::sets::Random;
use spmesh_stream::{Coordinates, StreamReader};
use spmesh_terrain::dem::{Method, Options, Quantity};
use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult};
use tiff::tags::Tag;

use super::tiles::tiff_values;
use super::{Mesh, file, is_same, options, raster, values};

const COLUMNS: usize = 518;
const ROWS: usize = 262;
const GRID: Grid =
    Grid { left: -0.5, top: ROWS as f64 - 0.5, step: 1.0, columns: COLUMNS as u32, rows: ROWS as u32 };

/// Squares cut in two, with corners in the centres of cells and integer elevations, so that cells are exact.
/// No triangles around some corners, and none in one tile.
fn squares() -> Mesh {
    let mut random = Random::new(4);
    let mut points = Vec::new();
    for y in 0..ROWS {
        points.extend((0..COLUMNS).map(|x| [x as f64, y as f64, random.integer(0, 40) as f64 + x as f64]));
    }
    let is_left_out: Vec<bool> =
        points.iter().map(|[x, y, _]| random.integer(0, 150) == 0 || (*x > 508.0 && *y < 50.0)).collect();
    let mut triangles = Vec::new();
    for (y, x) in (1..ROWS).flat_map(|y| (1..COLUMNS).map(move |x| (y, x))) {
        let corner = |dx: usize, dy: usize| ((y - dy) * COLUMNS + x - dx) as u32;
        triangles
            .extend([[corner(1, 1), corner(0, 1), corner(0, 0)], [corner(1, 1), corner(0, 0), corner(1, 0)]]);
    }
    triangles.retain(|triangle| triangle.iter().all(|&corner| !is_left_out[corner as usize]));
    // Without vertices that no triangle has.
    let mut numbers = vec![u32::MAX; points.len()];
    let mut used = Vec::new();
    for corner in triangles.iter_mut().flatten() {
        let number = &mut numbers[*corner as usize];
        if *number == u32::MAX {
            *number = used.len() as u32;
            used.push(points[*corner as usize]);
        }
        *corner = *number;
    }
    Mesh { points: used, triangles }
}

/// The sums of three differences to the east and to the north, or those of the nearest pairs; as `gdaldem`
/// documents them. `None` if a neighbour is missing.
fn gradient(heights: &[f32], cell: usize, differences: Differences) -> Option<[f64; 2]> {
    let (column, row) = (cell % COLUMNS, cell / COLUMNS);
    if column == 0 || row == 0 || column + 1 == COLUMNS || row + 1 == ROWS {
        return None;
    }
    let at =
        |east: i64, south: i64| f64::from(heights[(cell as i64 + east + south * COLUMNS as i64) as usize]);
    let (weights, sum) = match differences {
        Differences::Horn => ([1.0, 2.0, 1.0], 8.0),
        Differences::ZevenbergenThorne => ([0.0, 1.0, 0.0], 2.0),
    };
    let pairs = || weights.iter().zip(-1..=1);
    let east: f64 = pairs().map(|(weight, line)| weight * (at(1, line) - at(-1, line))).sum();
    let north: f64 = pairs().map(|(weight, line)| weight * (at(line, -1) - at(line, 1))).sum();
    let is_known = (-1..=1).flat_map(|x| (-1..=1).map(move |y| at(x, y))).all(|height| !height.is_nan());
    is_known.then_some([east / sum, north / sum])
}

/// The cosine between the normal and the light, 0 if it is negative.
fn cosine([east, north]: [f64; 2], azimuth: f64, altitude: f64) -> f64 {
    let (azimuth, altitude) = (azimuth.to_radians(), altitude.to_radians());
    let light = [azimuth.sin() * altitude.cos(), azimuth.cos() * altitude.cos(), altitude.sin()];
    let normal = [-east, -north, 1.0];
    let product: f64 = light.iter().zip(normal).map(|(a, b)| a * b).sum();
    (product / normal.iter().map(|part| part * part).sum::<f64>().sqrt()).max(0.0)
}

/// The value of a cell; NaN if it has none.
fn expected(quantity: &Quantity, gradient: [f64; 2]) -> f64 {
    let [east, north] = gradient;
    let is_level = gradient == [0.0, 0.0];
    match quantity {
        Quantity::Slope => (east * east + north * north).sqrt().atan().to_degrees(),
        Quantity::Aspect if is_level => f64::NAN,
        Quantity::Aspect => (-east).atan2(-north).to_degrees().rem_euclid(360.0),
        Quantity::Hillshade(Shading::One(_)) => (1.0 + 254.0 * cosine(gradient, 300.0, 40.0)).round(),
        _ if is_level => (1.0 + 254.0 * 30f64.to_radians().sin()).round(),
        _ => {
            let aspect = (-east).atan2(-north);
            let shade = |azimuth: f64| {
                (aspect - azimuth.to_radians()).cos().powi(2) * cosine(gradient, azimuth, 30.0)
            };
            (1.0 + 254.0 * 0.5 * [225.0, 270.0, 315.0, 360.0].map(shade).iter().sum::<f64>()).round()
        }
    }
}

fn quantities() -> [Quantity; 4] {
    let one = Shading::One(Light::from(300.0, 40.0));
    [Quantity::Slope, Quantity::Aspect, Quantity::Hillshade(one), Quantity::Hillshade(Shading::Many(30.0))]
}

#[test]
fn values_follow_from_the_cells_around() {
    let whole = Coordinates::I32 { scale: [1.0; 3], offset: [0.0; 3] };
    let mesh = squares();
    let stream = mesh.stream(whole);
    let shuffled = mesh.shuffled(&mut Random::new(5)).stream(whole);
    let heights = raster(&stream, &GRID, &options(Quantity::Elevation));
    for differences in [Differences::Horn, Differences::ZevenbergenThorne] {
        let gradients: Vec<_> =
            (0..heights.len()).map(|cell| gradient(&heights, cell, differences)).collect();
        for quantity in quantities() {
            let chosen = Options { method: Method::Cells(differences), ..options(quantity.clone()) };
            let is_byte = matches!(quantity, Quantity::Hillshade(_));
            let (text, stats) = file(&stream, RasterFormat::Ascii, &GRID, &chosen).unwrap();
            let mut found = values(&text);
            if is_byte {
                found.iter_mut().filter(|value| **value == 0.0).for_each(|value| *value = f32::NAN);
            }
            assert_eq!(stats.known, found.iter().filter(|value| !value.is_nan()).count() as u64);
            assert!(stats.known > 100_000);
            // All rows and columns come up; other files below are compared cell by cell.
            for (cell, &value) in found.iter().enumerate().step_by(5) {
                let expected = gradients[cell].map_or(f64::NAN, |gradient| expected(&quantity, gradient));
                let is_near = (f64::from(value) - expected).abs() < 1e-4;
                assert!(
                    is_near || value.is_nan() && expected.is_nan(),
                    "{quantity:?} {cell}: {value} {expected}"
                );
            }
            // Tiles that wait on the disk, any order of triangles, and files of other formats.
            for (stream, memory) in [(&stream, 1), (&shuffled, 1 << 30)] {
                let tight = Options { memory, ..chosen.clone() };
                let (tiff, stats) = file(stream, RasterFormat::GeoTiff, &GRID, &tight).unwrap();
                assert_eq!(stats.spilled > 0, memory == 1, "{stats:?}");
                assert!(is_same(&found, &tiff_values(&tiff, &GRID)));
                if is_byte {
                    let raster = RasterOptions { has_overviews: true, ..RasterOptions::default() };
                    let with = Options { raster, ..tight };
                    let (tiff, _) = file(stream, RasterFormat::GeoTiff, &GRID, &with).unwrap();
                    assert!(is_same(&found, &tiff_values(&tiff, &GRID)));
                }
            }
        }
    }
}

/// Colours are those of the elevations, in the light of the slopes; cells without a slope are transparent.
#[test]
fn reliefs_have_the_colours_of_elevations() {
    let whole = Coordinates::I32 { scale: [1.0; 3], offset: [0.0; 3] };
    let stream = squares().stream(whole);
    let heights = raster(&stream, &GRID, &options(Quantity::Elevation));
    let shading = Shading::One(Light::from(300.0, 40.0));
    for (range, [low, high]) in [(None, [0.0; 2]), (Some([100.0, 200.0]), [100.0, 200.0])] {
        let chosen = Options {
            method: Method::Cells(Differences::Horn),
            ..options(Quantity::ShadedRelief(shading, range))
        };
        let header = StreamReader::new(&stream[..], "mesh").unwrap().header().clone();
        let all = header.bounds.unwrap();
        let [low, high] = if range.is_none() { [all.min[2], all.max[2]] } else { [low, high] };
        for has_overviews in [false, true] {
            let raster = RasterOptions { has_overviews, ..RasterOptions::default() };
            let chosen = Options { raster, ..chosen.clone() };
            let (tiff, stats) = file(&stream, RasterFormat::GeoTiff, &GRID, &chosen).unwrap();
            let found = colours_of(&tiff);
            assert_eq!(stats.known, found.iter().filter(|colour| colour[3] == 255).count() as u64);
            for (cell, &colour) in found.iter().enumerate() {
                let expected = gradient(&heights, cell, Differences::Horn).map_or([0; 4], |gradient| {
                    let part = (f64::from(heights[cell]) - low) / (high - low);
                    let level = 40f64.to_radians().sin();
                    let [r, g, b] = lit(BATLOW.at(part), cosine(gradient, 300.0, 40.0), level);
                    [r, g, b, 255]
                });
                let off = (0..4).map(|band| colour[band].abs_diff(expected[band])).max().unwrap();
                assert!(off <= 1 && colour[3] == expected[3], "{cell}: {colour:?} {expected:?}");
            }
        }
    }
}

/// Red, green, blue and opacity of each cell; zeros in missing tiles.
fn colours_of(tiff: &[u8]) -> Vec<[u8; 4]> {
    let mut decoder = Decoder::new(Cursor::new(tiff)).unwrap();
    assert_eq!(decoder.colortype().unwrap(), ColorType::RGBA(8));
    let lengths = decoder.get_tag_u64_vec(Tag::TileByteCounts).unwrap();
    let mut colours = vec![[0; 4]; COLUMNS * ROWS];
    for chunk in (0..lengths.len()).filter(|&chunk| lengths[chunk] > 0) {
        let DecodingResult::U8(tile) = decoder.read_chunk(chunk as u32).unwrap() else { panic!("bytes") };
        let (width, _) = decoder.chunk_data_dimensions(chunk as u32);
        let across = COLUMNS.div_ceil(TILE);
        let [left, top] = [chunk % across * TILE, chunk / across * TILE];
        for (row, found) in tile.chunks_exact(4 * width as usize).enumerate() {
            for (column, colour) in found.chunks_exact(4).enumerate() {
                colours[(top + row) * COLUMNS + left + column] = colour.try_into().unwrap();
            }
        }
    }
    colours
}

/// Holes are filled before slopes are taken.
#[test]
fn filled_cells_count_as_neighbours() {
    let whole = Coordinates::I32 { scale: [1.0; 3], offset: [0.0; 3] };
    let stream = squares().stream(whole);
    let filled = Options { fill: Some(3), kill: Some(1.0), ..options(Quantity::Elevation) };
    let heights = raster(&stream, &GRID, &filled);
    let differences = Differences::Horn;
    let slopes = Options { quantity: Quantity::Slope, method: Method::Cells(differences), ..filled };
    for (cell, &value) in raster(&stream, &GRID, &slopes).iter().enumerate() {
        let expected = gradient(&heights, cell, differences)
            .map_or(f64::NAN, |gradient| expected(&Quantity::Slope, gradient));
        let is_near = (f64::from(value) - expected).abs() < 1e-3;
        assert!(is_near || value.is_nan() && expected.is_nan(), "{cell}: {value} {expected}");
    }
}

#[test]
fn small_rasters_have_slopes_where_the_mesh_goes_on() {
    let mesh =
        Mesh { points: vec![[0.0, 0.0, 1.0], [9.0, 0.0, 2.0], [0.0, 9.0, 3.0]], triangles: vec![[0, 1, 2]] };
    let stream = mesh.stream(Coordinates::F64);
    let slopes = Options { method: Method::Cells(Differences::Horn), ..options(Quantity::Slope) };
    for (columns, rows, known) in [(1, 1, 0), (1, 5, 0), (5, 2, 4), (3, 3, 4), (9, 9, 15)] {
        let grid = Grid { left: 0.0, top: rows as f64, step: 1.0, columns, rows };
        let found = raster(&stream, &grid, &slopes);
        assert_eq!(found.iter().filter(|value| !value.is_nan()).count(), known, "{columns} {rows}");
    }
    let empty = Mesh { points: Vec::new(), triangles: Vec::new() }.stream(Coordinates::F64);
    let grid = Grid { left: 0.0, top: 300.0, step: 1.0, columns: 300, rows: 300 };
    assert!(raster(&empty, &grid, &slopes).iter().all(|value| value.is_nan()));
}
