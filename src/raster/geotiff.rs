//! GeoTIFF files of one band of 32-bit numbers (OGC 19-008r4, GeoTIFF 1.1).
//!
//! Tiles are compressed by deflate after the predictor for floating-point numbers (Adobe Photoshop TIFF technical note 3): bytes
//! of equal weight stand together, as differences, which slowly varying values make small.

use std::io::{Seek, Write};

use flate2::Compression;
use flate2::write::ZlibEncoder;
use tiff::TiffError;
use tiff::encoder::{DirectoryEncoder, TiffEncoder, TiffKind, TiffKindBig};
use tiff::tags::Tag;

use super::geo_keys::GeoKeys;
use super::{Grid, NO_DATA};
use crate::error::{Error, Result};
use crate::stream::Crs;

/// Side of a tile in cells.
pub const TILE: usize = 256;
/// Bytes of a number.
const LEN: usize = 4;
/// Bytes from which a file is BigTIFF, before compression, which may lengthen some tiles.
const BIG: u64 = 4_000_000_000;

const DEFLATE: u16 = 8;
const FLOAT_PREDICTOR: u16 = 3;
const FLOAT: u16 = 3;
const BLACK_IS_ZERO: u16 = 1;

/// Tags of GeoTIFF, and of GDAL for cells without value.
const PIXEL_SCALE: u16 = 33550;
const TIEPOINT: u16 = 33922;
const KEY_DIRECTORY: u16 = 34735;
const KEY_DOUBLES: u16 = 34736;
const KEY_TEXTS: u16 = 34737;
const GDAL_NO_DATA: u16 = 42113;

/// Takes tiles in any order.
pub struct Tiles<'a> {
    grid: Grid,
    /// For each tile its offset in the file and its length; zeros, if it was not written.
    places: Vec<[u64; 2]>,
    put: &'a mut dyn FnMut(&[u8]) -> std::result::Result<u64, TiffError>,
}

/// Writes a file of the tiles that `fill` hands over; where it hands over none, nothing is known.
///
/// # Errors
/// Those of `fill`; if writing fails.
pub fn write_tiles<W: Write + Seek>(
    output: &mut W,
    grid: &Grid,
    crs: &Crs,
    fill: impl FnOnce(&mut Tiles) -> Result<()>,
) -> Result<()> {
    let keys = GeoKeys::of(crs);
    if grid.cells() * LEN as u64 > BIG {
        let mut encoder: TiffEncoder<_, TiffKindBig> = TiffEncoder::new_big(output).map_err(tiff_error)?;
        write_directory(encoder.image_directory().map_err(tiff_error)?, grid, &keys, fill)
    } else {
        let mut encoder = TiffEncoder::new(output).map_err(tiff_error)?;
        write_directory(encoder.image_directory().map_err(tiff_error)?, grid, &keys, fill)
    }
}

fn write_directory<W: Write + Seek, K: TiffKind>(
    mut directory: DirectoryEncoder<W, K>,
    grid: &Grid,
    keys: &GeoKeys,
    fill: impl FnOnce(&mut Tiles) -> Result<()>,
) -> Result<()> {
    let [across, down] = tiles_of(grid);
    let mut put = |bytes: &[u8]| directory.write_data(bytes);
    let mut tiles = Tiles { grid: *grid, places: vec![[0; 2]; across * down], put: &mut put };
    fill(&mut tiles)?;
    let places = tiles.places;
    let mut write = || {
        describe(&mut directory, grid)?;
        for (tag, part) in [(Tag::TileOffsets, 0), (Tag::TileByteCounts, 1)] {
            let numbers = places.iter().map(|place| K::convert_offset(place[part]));
            let numbers = numbers.collect::<std::result::Result<Vec<_>, TiffError>>()?;
            directory.write_tag(tag, K::convert_slice(&numbers))?;
        }
        refer(&mut directory, grid, keys)
    };
    write().map_err(tiff_error)?;
    directory.finish().map_err(tiff_error)
}

/// What the numbers are.
fn describe<W: Write + Seek, K: TiffKind>(
    directory: &mut DirectoryEncoder<W, K>,
    grid: &Grid,
) -> std::result::Result<(), TiffError> {
    directory.write_tag(Tag::ImageWidth, grid.columns)?;
    directory.write_tag(Tag::ImageLength, grid.rows)?;
    directory.write_tag(Tag::BitsPerSample, 8 * LEN as u16)?;
    directory.write_tag(Tag::Compression, DEFLATE)?;
    directory.write_tag(Tag::PhotometricInterpretation, BLACK_IS_ZERO)?;
    directory.write_tag(Tag::SamplesPerPixel, 1u16)?;
    directory.write_tag(Tag::Predictor, FLOAT_PREDICTOR)?;
    directory.write_tag(Tag::TileWidth, TILE as u32)?;
    directory.write_tag(Tag::TileLength, TILE as u32)?;
    directory.write_tag(Tag::SampleFormat, FLOAT)
}

/// Where cells are on the earth.
fn refer<W: Write + Seek, K: TiffKind>(
    directory: &mut DirectoryEncoder<W, K>,
    grid: &Grid,
    keys: &GeoKeys,
) -> std::result::Result<(), TiffError> {
    directory.write_tag(Tag::Unknown(PIXEL_SCALE), &[grid.step, grid.step, 0.0][..])?;
    directory.write_tag(Tag::Unknown(TIEPOINT), &[0.0, 0.0, 0.0, grid.left, grid.top, 0.0][..])?;
    directory.write_tag(Tag::Unknown(KEY_DIRECTORY), &keys.directory[..])?;
    if !keys.doubles.is_empty() {
        directory.write_tag(Tag::Unknown(KEY_DOUBLES), &keys.doubles[..])?;
    }
    if !keys.texts.is_empty() {
        directory.write_tag(Tag::Unknown(KEY_TEXTS), &keys.texts[..])?;
    }
    directory.write_tag(Tag::Unknown(GDAL_NO_DATA), &NO_DATA.to_string()[..])
}

/// Number of tiles in a row and in a column.
fn tiles_of(grid: &Grid) -> [usize; 2] {
    [grid.columns, grid.rows].map(|count| (count as usize).div_ceil(TILE))
}

impl Tiles<'_> {
    /// Writes the tile at a place in rows of tiles from the top; NaN is a cell where nothing is known.
    ///
    /// Domain: 256 by 256 values, row by row; those beyond the grid do not count.
    ///
    /// # Errors
    /// If writing fails.
    pub fn tile(&mut self, column: usize, row: usize, values: &[f32]) -> Result<()> {
        debug_assert_eq!(values.len(), TILE * TILE);
        let bytes = compressed(values);
        let offset = (self.put)(&bytes).map_err(tiff_error)?;
        let [across, _] = tiles_of(&self.grid);
        self.places[row * across + column] = [offset, bytes.len() as u64];
        Ok(())
    }

    /// Writes all rows, as [`super::write_rows`].
    pub(super) fn rows(&mut self, row: &mut impl FnMut(u32, &mut [f32]) -> Result<()>) -> Result<()> {
        let ([across, down], columns) = (tiles_of(&self.grid), self.grid.columns as usize);
        // A row of tiles, with what is beyond the last column.
        let width = across * TILE;
        let mut band = vec![f32::NAN; width * TILE];
        let mut tile = vec![f32::NAN; TILE * TILE];
        for at in 0..down {
            let rows = (at * TILE) as u32..self.grid.rows.min(((at + 1) * TILE) as u32);
            for (number, values) in rows.zip(band.chunks_exact_mut(width)) {
                row(number, &mut values[..columns])?;
            }
            for column in 0..across {
                for (into, from) in tile.chunks_exact_mut(TILE).zip(band.chunks_exact(width)) {
                    into.copy_from_slice(&from[column * TILE..][..TILE]);
                }
                self.tile(column, at, &tile)?;
            }
        }
        Ok(())
    }
}

/// Rows through the predictor, then deflated.
fn compressed(values: &[f32]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(6));
    let mut bytes = [0; TILE * LEN];
    for row in values.chunks_exact(TILE) {
        predicted(row, &mut bytes);
        encoder.write_all(&bytes).expect("memory takes all that is written");
    }
    encoder.finish().expect("memory takes all that is written")
}

/// The first bytes of all values, then the second ones and so on, each less the one before.
fn predicted(row: &[f32], bytes: &mut [u8; TILE * LEN]) {
    for (i, value) in row.iter().enumerate() {
        let value = if value.is_nan() { NO_DATA } else { *value };
        for (place, byte) in value.to_be_bytes().into_iter().enumerate() {
            bytes[place * TILE + i] = byte;
        }
    }
    for i in (1..bytes.len()).rev() {
        bytes[i] = bytes[i].wrapping_sub(bytes[i - 1]);
    }
}

fn tiff_error(error: TiffError) -> Error {
    match error {
        TiffError::IoError(error) => Error::io("writing", error),
        other => Error::io("writing", std::io::Error::other(other)),
    }
}
