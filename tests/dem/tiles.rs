//! Rasters of several tiles, with any amount of memory, in both formats.

use std::io::Cursor;

use spmesh_formats::raster::{Cells, Grid, RasterFormat, TILE, Window};
use spmesh_stream::Coordinates;
use spmesh_terrain::dem::{Options, Quantity};
use tiff::decoder::{Decoder, DecodingResult};
use tiff::tags::Tag;

use super::{Mesh, file, is_same, options, raster, values};
use spmesh_reference::sets::{Random, uniform};

const SIDE: i64 = 1_000;

/// A mesh with large triangles and small ones, in random order, and a grid of three tiles each way, of which
/// the last ones are cut.
pub(super) fn mesh_and_grid() -> (Vec<u8>, Grid) {
    let mut random = Random::new(11);
    let mut points = uniform(&mut random, 30, SIDE);
    points.extend(uniform(&mut random, 150, 60).iter().map(|[x, y]| [x + 470, y + 480]));
    points.sort_unstable();
    points.dedup();
    let mesh = Mesh::of(&mut random, &points).shuffled(&mut random);
    let window = Window { min: [-20.0; 2], max: [SIDE as f64 + 20.0, SIDE as f64 - 100.0] };
    let grid = Grid::of(window, Cells::Step { step: 1.6, anchor: [0.0; 2] }).unwrap();
    assert_eq!([grid.columns, grid.rows].map(|count| (count as usize).div_ceil(TILE)), [3, 3]);
    (mesh.stream(Coordinates::F64), grid)
}

/// The values of a GeoTIFF of floats or bytes. Missing tiles have no data.
pub(super) fn tiff_values(bytes: &[u8], grid: &Grid) -> Vec<f32> {
    let mut decoder = Decoder::new(Cursor::new(bytes)).unwrap();
    assert_eq!(decoder.dimensions().unwrap(), (grid.columns, grid.rows));
    let lengths = decoder.get_tag_u64_vec(Tag::TileByteCounts).unwrap();
    let columns = grid.columns as usize;
    let mut values = vec![f32::NAN; grid.cells() as usize];
    for chunk in (0..lengths.len()).filter(|&chunk| lengths[chunk] > 0) {
        let tile = match decoder.read_chunk(chunk as u32).unwrap() {
            DecodingResult::F32(tile) => tile,
            DecodingResult::U8(tile) => {
                tile.into_iter().map(|byte| if byte == 0 { -9999.0 } else { byte.into() }).collect()
            }
            _ => panic!("floats or bytes"),
        };
        let (width, _) = decoder.chunk_data_dimensions(chunk as u32);
        let across = columns.div_ceil(TILE);
        let [left, top] = [chunk % across * TILE, chunk / across * TILE];
        for (row, found) in tile.chunks_exact(width as usize).enumerate() {
            values[(top + row) * columns + left..][..found.len()].copy_from_slice(found);
        }
    }
    values.iter().map(|&value| if value == -9999.0 { f32::NAN } else { value }).collect()
}

#[test]
fn tiles_are_those_of_the_whole() {
    let (stream, grid) = mesh_and_grid();
    for quantity in [Quantity::Elevation, Quantity::Aspect] {
        let whole = raster(&stream, &grid, &options(quantity.clone()));
        assert!(whole.iter().any(|value| value.is_nan()) && whole.iter().any(|value| !value.is_nan()));
        // A raster of a single cell has the value of that cell.
        for cell in (0..whole.len()).step_by(4_001) {
            let [column, row] =
                [cell % grid.columns as usize, cell / grid.columns as usize].map(|n| n as u32);
            let single = Grid {
                left: grid.left + f64::from(column) * grid.step,
                top: grid.top - f64::from(row) * grid.step,
                columns: 1,
                rows: 1,
                ..grid
            };
            let [alone] = raster(&stream, &single, &options(quantity.clone()))[..] else {
                panic!("one cell")
            };
            let is_near = (alone - whole[cell]).abs() <= 1e-3 || alone.is_nan() && whole[cell].is_nan();
            assert!(is_near, "{alone} and {} at {column}, {row}", whole[cell]);
        }
    }
}

#[test]
fn memory_and_formats_change_nothing() {
    let (stream, grid) = mesh_and_grid();
    let whole = raster(&stream, &grid, &options(Quantity::Elevation));
    for (memory, may_spill) in [(0, true), (600_000, true), (1 << 30, false)] {
        let limited = Options { memory, ..options(Quantity::Elevation) };
        for format in [RasterFormat::Ascii, RasterFormat::GeoTiff] {
            let (bytes, stats) = file(&stream, format, &grid, &limited).unwrap();
            assert_eq!(stats.spilled > 0, may_spill, "{memory} {format:?}");
            let found = match format {
                RasterFormat::Ascii => values(&bytes),
                RasterFormat::GeoTiff => tiff_values(&bytes, &grid),
            };
            assert!(is_same(&found, &whole), "{memory} {format:?}");
            assert_eq!(stats.known, whole.iter().filter(|value| !value.is_nan()).count() as u64);
        }
    }
}

#[test]
fn tiles_that_are_full_leave_memory() {
    // Squares from left to right, or from right to left: of the 20 tiles in a row, only a few are open at a
    // time.
    let points: Vec<[i64; 2]> = (0..=500).flat_map(|x| [[10 * x, 0], [10 * x, 240]]).collect();
    let corner = |x: u32, y: u32| 2 * x + y;
    let square = |x| {
        [[corner(x, 0), corner(x + 1, 0), corner(x + 1, 1)], [corner(x, 0), corner(x + 1, 1), corner(x, 1)]]
    };
    let mut mesh = Mesh {
        points: points.iter().map(|&[x, y]| [x as f64, y as f64, x as f64]).collect(),
        triangles: (0..500).flat_map(square).collect(),
    };
    let limited = Options { memory: 3 * 278_528, ..options(Quantity::Elevation) };
    for is_back in [false, true] {
        if is_back {
            mesh.triangles.reverse();
        }
        // Centres off the borders of squares, and on them. In the second case triangles touch cells of
        // complete tiles.
        for shift in [0.0, 0.5] {
            let grid = Grid { left: -shift, top: 240.0 - shift, step: 1.0, columns: 5_000, rows: 239 };
            let stream = mesh.stream(Coordinates::F64);
            let (bytes, stats) = file(&stream, RasterFormat::GeoTiff, &grid, &limited).unwrap();
            assert_eq!((stats.known, stats.spilled), (5_000 * 239, 0), "{is_back} {shift}");
            let found = tiff_values(&bytes, &grid);
            let expected = |cell: usize| f64::from(cell as u32 % 5_000) + 0.5 - shift;
            assert!((0..found.len()).all(|cell| (f64::from(found[cell]) - expected(cell)).abs() < 1e-3));
        }
    }
}

#[test]
fn huge_rasters_of_small_meshes_are_small() {
    let mesh =
        Mesh::of(&mut Random::new(2), &[[0, 0], [300, 0], [0, 300], [59_000, 58_000], [59_000, 58_300]]);
    let mut small = mesh.clone();
    // Without the long triangles, which would touch many tiles.
    small.triangles.retain(|triangle| triangle.iter().all(|&vertex| vertex < 3));
    small.points.truncate(3);
    let grid = Grid { left: 0.0, top: 60_000.0, step: 1.0, columns: 60_000, rows: 60_000 };
    let (bytes, stats) =
        file(&small.stream(Coordinates::F64), RasterFormat::GeoTiff, &grid, &options(Quantity::Slope))
            .unwrap();
    assert_eq!((stats.cells, stats.known), (3_600_000_000, 300 * 299 / 2 + 300));
    assert!(bytes.len() < 2_000_000, "{}", bytes.len());
    // A sparse file is BigTIFF if the full file would need it.
    assert_eq!(bytes[..4], *b"II+\0");
}
