//! Rasters are what other programs read.

use std::io::Cursor;

use spmesh::raster::{Grid, RasterFormat, TILE, write_rows, write_tiles};
use spmesh::stream::Crs;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;

const GRID: Grid = Grid { left: 10.0, top: 250.0, step: 0.5, columns: 700, rows: 300 };

/// The value of a cell: smooth, rough, not known, or extreme.
fn value(column: u32, row: u32) -> f32 {
    let x = f64::from(column);
    match row % 4 {
        0 => (x * 0.01).sin() as f32,
        1 => ((x * 12.9898 + f64::from(row)).sin() * 43758.5) as f32,
        2 if column % 7 == 3 => f32::NAN,
        2 => f32::MIN_POSITIVE / 8.0,
        _ => -f32::MAX,
    }
}

fn row(number: u32, values: &mut [f32]) -> spmesh::error::Result<()> {
    (0..).zip(values).for_each(|(column, cell)| *cell = value(column, number));
    Ok(())
}

/// What is expected in a file.
fn stored(column: u32, row: u32) -> f32 {
    let value = value(column, row);
    if value.is_nan() { -9999.0 } else { value }
}

fn file(grid: &Grid, format: RasterFormat) -> Vec<u8> {
    let mut output = Cursor::new(Vec::new());
    write_rows(&mut output, format, grid, &Crs::Unknown, row).unwrap();
    output.into_inner()
}

fn decoded(bytes: &[u8]) -> (Decoder<Cursor<&[u8]>>, Vec<f32>) {
    let mut decoder = Decoder::new(Cursor::new(bytes)).unwrap().with_limits(Limits::unlimited());
    let DecodingResult::F32(values) = decoder.read_image().unwrap() else { panic!("32-bit numbers") };
    (decoder, values)
}

#[test]
fn another_reader_finds_every_cell() {
    for [columns, rows] in [[700, 300], [1, 1], [256, 256], [257, 5]] {
        let grid = Grid { columns, rows, ..GRID };
        let bytes = file(&grid, RasterFormat::GeoTiff);
        let (mut decoder, values) = decoded(&bytes);
        assert_eq!(decoder.dimensions().unwrap(), (columns, rows));
        let expected = (0..rows).flat_map(|row| (0..columns).map(move |column| stored(column, row)));
        assert!(
            values.iter().map(|value| value.to_bits()).eq(expected.map(f32::to_bits)),
            "{columns} by {rows}"
        );
        let mut numbers = |tag: u16| decoder.get_tag_f64_vec(Tag::Unknown(tag)).unwrap();
        assert_eq!(numbers(33550), [0.5, 0.5, 0.0]);
        assert_eq!(numbers(33922), [0.0, 0.0, 0.0, 10.0, 250.0, 0.0]);
        assert_eq!(decoder.get_tag_ascii_string(Tag::Unknown(42113)).unwrap(), "-9999");
    }
}

#[test]
fn smooth_values_become_short() {
    let mut output = Cursor::new(Vec::new());
    let smooth = |number: u32, values: &mut [f32]| {
        let height = |column: usize| (f64::from(number) * 0.01).cos() + (column as f64 * 0.01).sin();
        values.iter_mut().enumerate().for_each(|(column, cell)| *cell = height(column) as f32);
        Ok(())
    };
    write_rows(&mut output, RasterFormat::GeoTiff, &GRID, &Crs::Unknown, smooth).unwrap();
    let ratio = output.get_ref().len() as f64 / (4.0 * GRID.cells() as f64);
    assert!(ratio < 0.7, "{ratio}");
}

#[test]
fn tiles_come_in_any_order_or_not_at_all() {
    let mut output = Cursor::new(Vec::new());
    write_tiles(&mut output, &GRID, &Crs::Unknown, |tiles| {
        for (column, row) in [(2, 1), (0, 0), (1, 0)] {
            tiles.tile(column, row, &vec![(10 * row + column) as f32; TILE * TILE])?;
        }
        Ok(())
    })
    .unwrap();
    let mut decoder = Decoder::new(Cursor::new(&output.get_ref()[..])).unwrap();
    let offsets = decoder.get_tag_u64_vec(Tag::TileOffsets).unwrap();
    let lengths = decoder.get_tag_u64_vec(Tag::TileByteCounts).unwrap();
    let is_written = [true, true, false, false, false, true];
    assert!(offsets.iter().zip(is_written).all(|(&offset, is_written)| (offset > 0) == is_written));
    assert!(lengths.iter().zip(is_written).all(|(&length, is_written)| (length > 0) == is_written));
    for (chunk, value) in [(0, 0.0), (1, 1.0), (5, 12.0)] {
        let DecodingResult::F32(values) = decoder.read_chunk(chunk).unwrap() else {
            panic!("32-bit numbers")
        };
        assert!(values.iter().all(|&found| found == value), "{chunk}");
    }
}

#[test]
fn texts_have_rows_from_the_top() {
    let grid = Grid { columns: 9, rows: 4, ..GRID };
    let text = String::from_utf8(file(&grid, RasterFormat::Ascii)).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let header =
        ["ncols 9", "nrows 4", "xllcorner 10", "yllcorner 248", "cellsize 0.5", "NODATA_value -9999"];
    assert_eq!(lines[..6], header);
    for (row, line) in (0..).zip(&lines[6..]) {
        let values: Vec<f32> = line.split(' ').map(|word| word.parse().unwrap()).collect();
        let expected: Vec<f32> = (0..9).map(|column| stored(column, row)).collect();
        assert_eq!(values, expected);
    }
    assert_eq!(lines.len(), 10);
}

#[test]
fn failures_stop_the_file() {
    let failing = |number: u32, _: &mut [f32]| match number {
        5 => Err(spmesh::error::Error::usage("no more")),
        _ => Ok(()),
    };
    for format in [RasterFormat::Ascii, RasterFormat::GeoTiff] {
        let mut output = Cursor::new(Vec::new());
        let error = write_rows(&mut output, format, &GRID, &Crs::Unknown, failing).unwrap_err();
        assert!(error.to_string().contains("no more"), "{error}");
    }
}
