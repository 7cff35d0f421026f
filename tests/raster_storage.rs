//! The numbers and tags of GeoTIFF files, by another reader.

use std::io::{Cursor, Read};

use flate2::read::ZlibDecoder;
use spmesh_base::error::Result;
use spmesh_formats::crs::requested;
use spmesh_formats::raster::{
    CellType, Compression, Grid, Integers, Predictor, RasterFile, RasterFormat, RasterOptions, Reduction,
    Reference, Samples, Storage, TILE, Tiles, write_rows, write_tiles,
};
use spmesh_reference::sets::Random;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;

const GRID: Grid = Grid { left: 10.0, top: 250.0, step: 0.5, columns: 700, rows: 300 };

/// The value of a cell, between -3 and 97; none in some cells.
fn value(column: u32, row: u32) -> f32 {
    if (column / 9 + row) % 11 == 4 {
        return f32::NAN;
    }
    ((f64::from(column) * 0.013).sin() * 20.0 + f64::from(row) * 0.2 + 17.0) as f32
}

fn values(row: u32, cells: &mut [f32]) -> Result<()> {
    (0..).zip(cells).for_each(|(column, cell)| *cell = value(column, row));
    Ok(())
}

fn raster<'a>(options: &'a RasterOptions, reference: &'a Reference) -> RasterFile<'a> {
    RasterFile {
        options,
        grid: GRID,
        reference,
        reduction: Reduction::Mean,
        samples: Samples::Floats,
        is_staged: false,
    }
}

fn written(options: &RasterOptions) -> Result<Vec<u8>> {
    let reference = Reference::of_crs(&requested("EPSG:32610").unwrap(), true, RasterFormat::GeoTiff);
    let mut output = Cursor::new(Vec::new());
    write_rows(&mut output, &raster(options, &reference), values)?;
    Ok(output.into_inner())
}

fn decoder(bytes: &[u8]) -> Decoder<Cursor<&[u8]>> {
    Decoder::new(Cursor::new(bytes)).unwrap().with_limits(Limits::unlimited())
}

fn text(bytes: &[u8], tag: u16) -> String {
    decoder(bytes).get_tag_ascii_string(Tag::Unknown(tag)).unwrap()
}

#[test]
fn another_reader_finds_every_integer() {
    for (cell_type, [scale, offset], no_data, stated) in [
        (CellType::Byte, [1.0, -4.0], None, "255"),
        (CellType::Int16, [0.01, 20.0], None, "-32768"),
        (CellType::Int16, [0.25, 0.0], Some(-9999.0), "-9999"),
        (CellType::Int32, [0.001, 0.0], None, "-2147483648"),
    ] {
        let integers = Integers::new(cell_type, [scale, offset], no_data).unwrap();
        let no_data: i64 = stated.parse().unwrap();
        let expected: Vec<i64> = (0..GRID.rows)
            .flat_map(|row| (0..GRID.columns).map(move |column| f64::from(value(column, row))))
            .map(|value| if value.is_nan() { no_data } else { ((value - offset) / scale).round() as i64 })
            .collect();
        for (compression, predictor) in [
            (Compression::Deflate, None),
            (Compression::Deflate, Some(Predictor::None)),
            (Compression::None, None),
        ] {
            let storage = Storage { integers: Some(integers), compression, predictor };
            let bytes = written(&RasterOptions { storage, ..RasterOptions::default() }).unwrap();
            let found: Vec<i64> = match decoder(&bytes).read_image().unwrap() {
                DecodingResult::U8(found) => found.into_iter().map(i64::from).collect(),
                DecodingResult::I16(found) => found.into_iter().map(i64::from).collect(),
                DecodingResult::I32(found) => found.into_iter().map(i64::from).collect(),
                _ => panic!("integers"),
            };
            assert!(found == expected, "{cell_type} {compression:?} {predictor:?}");
            assert_eq!(text(&bytes, 42113), stated);
            let metadata = text(&bytes, 42112);
            for (name, role, value) in [("SCALE", "scale", scale), ("OFFSET", "offset", offset)] {
                let item = format!("<Item name=\"{name}\" sample=\"0\" role=\"{role}\">{value}</Item>");
                assert!(metadata.contains(&item), "{metadata}");
            }
        }
    }
}

/// The bytes of all tiles, decompressed.
fn tiles(bytes: &[u8], decompress: impl Fn(&[u8]) -> Vec<u8>) -> Vec<Vec<u8>> {
    let mut decoder = decoder(bytes);
    let [offsets, lengths] =
        [Tag::TileOffsets, Tag::TileByteCounts].map(|tag| decoder.get_tag_u64_vec(tag).unwrap());
    offsets
        .iter()
        .zip(&lengths)
        .map(|(&at, &len)| decompress(&bytes[at as usize..][..len as usize]))
        .collect()
}

#[test]
fn compressions_hold_the_same_bytes() {
    let inflate = |bytes: &[u8]| {
        let mut found = Vec::new();
        ZlibDecoder::new(bytes).read_to_end(&mut found).unwrap();
        found
    };
    let of = |compression, predictor| {
        let storage = Storage { integers: None, compression, predictor };
        written(&RasterOptions { storage, ..RasterOptions::default() }).unwrap()
    };
    for predictor in [None, Some(Predictor::None), Some(Predictor::Horizontal)] {
        let [deflated, zstd] = [Compression::Deflate, Compression::Zstd].map(|method| of(method, predictor));
        assert!(
            tiles(&deflated, inflate) == tiles(&zstd, |bytes| zstd::decode_all(bytes).unwrap()),
            "{predictor:?}"
        );
        let tags = [&deflated, &zstd].map(|bytes| decoder(bytes).get_tag_u32(Tag::Compression).unwrap());
        assert_eq!(tags, [8, 50000]);
    }
    let plain = of(Compression::None, None);
    assert!(
        tiles(&of(Compression::Deflate, Some(Predictor::None)), inflate) == tiles(&plain, <[u8]>::to_vec)
    );
    // Differences of words within a row; the first one is whole.
    let differences = tiles(&of(Compression::Deflate, Some(Predictor::Horizontal)), inflate);
    let summed: Vec<Vec<u8>> = differences
        .iter()
        .map(|tile| {
            let rows = tile.chunks_exact(4 * TILE).flat_map(|row| {
                row.as_chunks::<4>().0.iter().scan(0u32, |sum, word| {
                    *sum = sum.wrapping_add(u32::from_le_bytes(*word));
                    Some(sum.to_le_bytes())
                })
            });
            rows.flatten().collect()
        })
        .collect();
    assert!(summed == tiles(&plain, <[u8]>::to_vec));
}

#[test]
fn statistics_are_those_of_all_cells_in_any_order_of_tiles() {
    let options = RasterOptions {
        has_statistics: true,
        date: Some("2021-06-15T12:30:00Z".parse().unwrap()),
        ..RasterOptions::default()
    };
    let bytes = written(&options).unwrap();
    let metadata = text(&bytes, 42112);
    let stated = |name: &str| -> f64 {
        let (_, rest) = metadata.split_once(&format!("name=\"STATISTICS_{name}\" sample=\"0\">")).unwrap();
        rest.split_once('<').unwrap().0.parse().unwrap()
    };
    let known: Vec<f64> = (0..GRID.rows)
        .flat_map(|row| (0..GRID.columns).map(move |column| f64::from(value(column, row))))
        .filter(|value| !value.is_nan())
        .collect();
    let mean = known.iter().sum::<f64>() / known.len() as f64;
    let variance = known.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / known.len() as f64;
    for (name, expected) in [
        ("MINIMUM", known.iter().copied().fold(f64::INFINITY, f64::min)),
        ("MAXIMUM", known.iter().copied().fold(f64::NEG_INFINITY, f64::max)),
        ("MEAN", mean),
        ("STDDEV", variance.sqrt()),
        ("VALID_PERCENT", 100.0 * known.len() as f64 / GRID.cells() as f64),
    ] {
        assert!((stated(name) - expected).abs() <= 1e-12 * expected.abs(), "{name}: {metadata}");
    }
    assert_eq!(text(&bytes, 306), "2021:06:15 12:30:00");
    assert!(text(&bytes, 305).starts_with("spmesh "));

    let reference = Reference::default();
    let shuffled = |seed: u64| {
        let mut places: Vec<[usize; 2]> = (0..6).map(|at| [at % 3, at / 3]).collect();
        Random::new(seed).shuffle(&mut places);
        let mut output = Cursor::new(Vec::new());
        let fill = |tiles: &mut Tiles| {
            places.iter().try_for_each(|&[column, row]| {
                let cell =
                    |at: usize| value((column * TILE + at % TILE) as u32, (row * TILE + at / TILE) as u32);
                tiles.tile(column, row, &(0..TILE * TILE).map(cell).collect::<Vec<f32>>())
            })
        };
        write_tiles(&mut output, &raster(&options, &reference), fill).unwrap();
        text(&output.into_inner(), 42112)
    };
    let texts: Vec<String> = (1..5).map(shuffled).collect();
    assert!(texts.iter().all(|text| *text == texts[0]), "{texts:?}");
}

#[test]
fn values_that_do_not_fit_are_errors() {
    for (cell_type, transform, part) in [
        (CellType::Byte, [1.0, 0.0], "becomes -"),
        (
            CellType::Int16,
            [0.001, 0.0],
            "int16 holds -32768 to 32767: give another --type, --scale or --offset",
        ),
    ] {
        let integers = Some(Integers::new(cell_type, transform, None).unwrap());
        let storage = Storage { integers, ..Storage::default() };
        let error = written(&RasterOptions { storage, ..RasterOptions::default() }).unwrap_err();
        assert!(error.to_string().contains(part) && error.exit_code() == 2, "{error}");
    }
    // Cells beyond the image do not count.
    let storage = Storage {
        integers: Some(Integers::new(CellType::Int16, [0.01, 0.0], None).unwrap()),
        ..Storage::default()
    };
    let options = RasterOptions { storage, ..RasterOptions::default() };
    let mut output = Cursor::new(Vec::new());
    let tile: Vec<f32> =
        (0..TILE * TILE).map(|at| if at % TILE < 700 - 2 * TILE { 1.0 } else { f32::INFINITY }).collect();
    write_tiles(&mut output, &raster(&options, &Reference::default()), |tiles| tiles.tile(2, 0, &tile))
        .unwrap();
}
