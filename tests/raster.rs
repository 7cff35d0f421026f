//! Other programs can read the rasters.

use std::io::Cursor;
use std::sync::LazyLock;

use spmesh_formats::crs::requested;
use spmesh_formats::raster::{
    Grid, NoData, RasterFile, RasterFormat, RasterOptions, Reduction, Reference, Samples, TILE, write_rows,
    write_tiles,
};
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;

const GRID: Grid = Grid { left: 10.0, top: 250.0, step: 0.5, columns: 700, rows: 300 };

/// The value of a cell: smooth, rough, missing, or extreme.
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

fn row(number: u32, values: &mut [f32]) -> spmesh_base::error::Result<()> {
    (0..).zip(values).for_each(|(column, cell)| *cell = value(column, number));
    Ok(())
}

/// The expected value in a file.
fn stored(column: u32, row: u32) -> f32 {
    let value = value(column, row);
    if value.is_nan() { -9999.0 } else { value }
}

fn file(grid: &Grid, format: RasterFormat) -> Vec<u8> {
    let options = RasterOptions { format, ..RasterOptions::default() };
    let mut output = Cursor::new(Vec::new());
    write_rows(&mut output, &of(grid, &options), row).unwrap();
    output.into_inner()
}

fn of<'a>(grid: &Grid, options: &'a RasterOptions) -> RasterFile<'a> {
    static KEYS: LazyLock<Reference> =
        LazyLock::new(|| Reference::of_crs(&requested("EPSG:32610").unwrap(), true, RasterFormat::GeoTiff));
    RasterFile {
        options,
        grid: *grid,
        reference: &KEYS,
        reduction: Reduction::Mean,
        samples: Samples::Floats,
        is_staged: false,
    }
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
    write_rows(&mut output, &of(&GRID, &RasterOptions::default()), smooth).unwrap();
    let ratio = output.get_ref().len() as f64 / (4.0 * GRID.cells() as f64);
    assert!(ratio < 0.7, "{ratio}");
}

#[test]
fn tiles_come_in_any_order_or_not_at_all() {
    let mut output = Cursor::new(Vec::new());
    write_tiles(&mut output, &of(&GRID, &RasterOptions::default()), |tiles| {
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
        5 => Err(spmesh_base::error::Error::usage("no more")),
        _ => Ok(()),
    };
    for format in [RasterFormat::Ascii, RasterFormat::GeoTiff] {
        let mut output = Cursor::new(Vec::new());
        let options = RasterOptions { format, ..RasterOptions::default() };
        let error = write_rows(&mut output, &of(&GRID, &options), failing).unwrap_err();
        assert!(error.to_string().contains("no more"), "{error}");
    }
}

/// An image of a file: the numbers of its columns and rows, and its values.
type Image = ([u32; 2], Vec<f32>);

/// All images of a file in order, and the offset of the first data byte of each.
fn images(bytes: &[u8]) -> (Vec<Image>, Vec<u64>) {
    let mut decoder = Decoder::new(Cursor::new(bytes)).unwrap().with_limits(Limits::unlimited());
    let (mut images, mut starts) = (Vec::new(), Vec::new());
    loop {
        let (columns, rows) = decoder.dimensions().unwrap();
        let DecodingResult::F32(values) = decoder.read_image().unwrap() else { panic!("32-bit numbers") };
        images.push(([columns, rows], values));
        starts.push(decoder.get_tag_u64_vec(Tag::TileOffsets).unwrap()[0]);
        if !decoder.more_images() {
            return (images, starts);
        }
        decoder.next_image().unwrap();
        assert_eq!(decoder.get_tag_u32(Tag::NewSubfileType).unwrap(), 1);
    }
}

/// An image with half as many cells along each axis. Each cell is the mean of the known values among four
/// cells, or the first of these.
fn halved(([columns, rows], values): &Image, reduction: Reduction) -> Image {
    let size = [columns.div_ceil(2), rows.div_ceil(2)];
    let cell = |x: u32, y: u32| {
        let inside = x < *columns && y < *rows;
        let value = inside.then(|| values[(y * columns + x) as usize]);
        value.filter(|&value| value != -9999.0)
    };
    let reduced = |[x, y]: [u32; 2]| {
        let four = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[i, j]| cell(2 * x + i, 2 * y + j));
        let known: Vec<f64> = four.iter().flatten().map(|&value| f64::from(value)).collect();
        match reduction {
            _ if known.is_empty() => -9999.0,
            Reduction::First => known[0] as f32,
            Reduction::Mean => (known.iter().sum::<f64>() / known.len() as f64) as f32,
        }
    };
    let cells = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| [x, y]));
    (size, cells.map(reduced).collect())
}

#[test]
fn overviews_are_halves_and_stand_before_the_image() {
    let options = RasterOptions { has_overviews: true, ..RasterOptions::default() };
    for [columns, rows] in [[700, 300], [1, 1], [1025, 513], [3, 600]] {
        for reduction in [Reduction::Mean, Reduction::First] {
            let grid = Grid { columns, rows, ..GRID };
            let mut output = Cursor::new(Vec::new());
            let smooth = |number: u32, values: &mut [f32]| {
                row(number, values)?;
                // A hole that covers whole cells of the first overviews.
                let hole = values.len() / 3..values.len() / 2;
                values[hole].iter_mut().filter(|_| number > 8).for_each(|value| *value = f32::NAN);
                Ok(())
            };
            write_rows(&mut output, &RasterFile { reduction, ..of(&grid, &options) }, smooth).unwrap();
            let (images, starts) = images(output.get_ref());
            for (image, half) in images.iter().zip(&images[1..]) {
                assert!(*half == halved(image, reduction), "{:?} of {:?}", half.0, image.0);
            }
            assert!(images.last().unwrap().0.iter().all(|&count| count as usize <= TILE));
            assert!(starts.windows(2).all(|pair| pair[0] > pair[1]), "the least image has its data first");
        }
    }
}

#[test]
fn staged_files_have_the_same_cells_in_rows() {
    let options = RasterOptions { no_data: NoData(7.0), ..RasterOptions::default() };
    let staged = RasterFile { is_staged: true, ..of(&GRID, &options) };
    let mut output = Cursor::new(Vec::new());
    write_tiles(&mut output, &staged, |tiles| {
        let mut values = vec![0.0; TILE * TILE];
        for (column, row) in [(2, 1), (0, 0), (1, 0)] {
            // Values that equal the no-data value by chance are kept apart from missing ones.
            tiles.tile(column, row, &vec![7.0; TILE * TILE])?;
            assert!(tiles.read(column, row, &mut values)?);
            assert!(values.iter().all(|value| (*value - 7.0).abs() < 1e-5), "{column} {row}");
        }
        assert!(!tiles.read(1, 1, &mut values)?);
        Ok(())
    })
    .unwrap();
    let mut decoder = Decoder::new(Cursor::new(&output.get_ref()[..])).unwrap();
    let offsets = decoder.get_tag_u64_vec(Tag::TileOffsets).unwrap();
    let written: Vec<u64> = offsets.iter().copied().filter(|&offset| offset > 0).collect();
    assert_eq!(written.len(), 3);
    assert!(written.is_sorted() && offsets[2] == 0);
    assert_eq!(decoder.get_tag_ascii_string(Tag::Unknown(42113)).unwrap(), "7");
}

#[test]
fn grids_are_read_from_files() {
    let folder = crate::programs::Folder::new();
    let path = folder.write("a.tif", file(&GRID, RasterFormat::GeoTiff));
    assert_eq!(Grid::of_file(path.as_ref()).unwrap(), GRID);
    // The file again, with the position of a cell's centre instead of its corner.
    let mut bytes = file(&GRID, RasterFormat::GeoTiff);
    let key = [1025u16, 0, 1, 1].map(u16::to_le_bytes);
    let place = bytes.windows(8).position(|window| window == key.as_flattened()).unwrap();
    bytes[place + 6] = 2;
    let path = folder.write("points.tif", bytes);
    let shifted = Grid { left: GRID.left - 0.25, top: GRID.top + 0.25, ..GRID };
    assert_eq!(Grid::of_file(path.as_ref()).unwrap(), shifted);
    let text = folder.write("a.asc", file(&GRID, RasterFormat::Ascii));
    let message = Grid::of_file(text.as_ref()).unwrap_err().to_string();
    assert!(message.contains("a.asc") && message.contains("cannot be read as TIFF"), "{message}");
}
