//! GeoTIFF files of one band of f32, bytes or integers, or of colours (OGC 19-008r4, GeoTIFF 1.1), with
//! overviews on request.
//!
//! Tiles arrive in any order. `compressor` encodes them by `tile_code` on a separate thread, `overviews`
//! reduces them, and `store` holds the encoded bytes until all tiles have come. `directory` writes the bytes
//! before the tiles.

mod compressor;
mod directory;
mod metadata;
mod overviews;
mod statistics;
mod store;
mod tile_code;

use std::io::{Seek, Write};

use compressor::{Compressed, Compressor};
use directory::{Directory, Size, Values};
pub use overviews::Reduction;
use overviews::{Overviews, TileName, level_sizes, tiles_of};
use statistics::Statistics;
use store::{Extent, Store};

use crate::crs::GeoKeys;
use crate::raster::{CellType, Compression, Grid, Predictor, RasterFile, RasterOptions, Samples};
use spmesh_base::error::{Error, Result};
use tile_code::{Encoded, TileCode};

/// Side of a tile in cells.
pub const TILE: usize = 256;
/// Files longer than this before compression become BigTIFF. Below 2^32, because compression may lengthen
/// some tiles.
const BIG: u64 = 4_000_000_000;

/// What wrote the file.
const WRITER: &str = concat!("spmesh ", env!("CARGO_PKG_VERSION"));

/// Numbers of compressions; that of Zstandard is one of libtiff.
const UNCOMPRESSED: u16 = 1;
const DEFLATE: u16 = 8;
const ZSTD: u16 = 50000;
const NO_PREDICTOR: u16 = 1;
const HORIZONTAL_PREDICTOR: u16 = 2;
const FLOAT_PREDICTOR: u16 = 3;
const UNSIGNED: u16 = 1;
const SIGNED: u16 = 2;
const FLOAT: u16 = 3;
const BLACK_IS_ZERO: u16 = 1;
const RGB: u16 = 2;
const UNASSOCIATED_ALPHA: u16 = 2;
const REDUCED_IMAGE: u32 = 1;

/// Tags of TIFF.
const NEW_SUBFILE_TYPE: u16 = 254;
const IMAGE_WIDTH: u16 = 256;
const IMAGE_LENGTH: u16 = 257;
const BITS_PER_SAMPLE: u16 = 258;
const COMPRESSION: u16 = 259;
const PHOTOMETRIC_INTERPRETATION: u16 = 262;
const SAMPLES_PER_PIXEL: u16 = 277;
const SOFTWARE: u16 = 305;
const DATE_TIME: u16 = 306;
const PREDICTOR: u16 = 317;
const TILE_WIDTH: u16 = 322;
const TILE_LENGTH: u16 = 323;
const TILE_OFFSETS: u16 = 324;
const TILE_BYTE_COUNTS: u16 = 325;
const EXTRA_SAMPLES: u16 = 338;
const SAMPLE_FORMAT: u16 = 339;

/// Tags of GeoTIFF, and GDAL's tags for the unit of cells and for cells without data.
pub(super) const PIXEL_SCALE: u16 = 33550;
pub(super) const TIEPOINT: u16 = 33922;
pub(super) const KEY_DIRECTORY: u16 = 34735;
pub(super) const KEY_DOUBLES: u16 = 34736;
pub(super) const KEY_TEXTS: u16 = 34737;
const GDAL_METADATA: u16 = 42112;
const GDAL_NO_DATA: u16 = 42113;

/// Takes tiles in any order.
pub struct Tiles<'a> {
    code: TileCode,
    levels: Vec<Level>,
    overviews: Option<Overviews>,
    compressor: Compressor,
    store: Store<'a>,
    /// Buffers for reuse.
    spare: Vec<f32>,
    bytes: Vec<u8>,
}

/// An image and its tiles.
struct Level {
    size: [u32; 2],
    /// Place of each tile in the store.
    tiles: Vec<Extent>,
    /// Statistics of each tile, if they are asked for.
    statistics: Vec<Option<Statistics>>,
}

/// Writes a file of the tiles that `fill` supplies; cells of missing tiles have no data. Returns what `fill`
/// does.
///
/// Memory: some tiles, and for each tile of the file 16 bytes, with statistics 64.
///
/// # Errors
/// Those of `fill`; usage, if a value does not fit the type of stored numbers; if writing fails.
pub fn write_tiles<W: Write + Seek, T>(
    output: &mut W,
    file: &RasterFile,
    fill: impl FnOnce(&mut Tiles) -> Result<T>,
) -> Result<T> {
    let Grid { columns, rows, .. } = file.grid;
    let sizes = level_sizes([columns, rows], file.options.has_overviews);
    let mut levels: Vec<Level> = sizes.iter().map(|&size| Level::new(size)).collect();
    if file.options.has_statistics {
        levels[0].statistics = vec![None; levels[0].tiles.len()];
    }
    let cells: u64 = sizes.iter().map(|&[columns, rows]| u64::from(columns) * u64::from(rows)).sum();
    let code = TileCode::of(file);
    let size = if cells * code.cell_len() as u64 > BIG { Size::Big } else { Size::Classic };
    let head_len = directory::encode(&directories(file, &levels), size).len() as u64;
    let RasterOptions { has_overviews, temp_dir, .. } = file.options;
    let temp_dir = temp_dir.as_deref();
    let is_staged = file.is_staged || *has_overviews || output.stream_position().is_err();
    let store = if is_staged { Store::staged(output, temp_dir)? } else { Store::direct(output, head_len)? };
    let mut tiles = Tiles {
        code,
        overviews: has_overviews
            .then(|| Overviews::new(file.reduction, file.samples.bands(), sizes, temp_dir)),
        levels,
        compressor: Compressor::start(code)?,
        store,
        spare: Vec::new(),
        bytes: Vec::new(),
    };
    let filled = fill(&mut tiles)?;
    tiles.put_rest_of_overviews()?;
    tiles.store_all()?;
    let Tiles { mut levels, store, .. } = tiles;
    // The smallest image first, as in cloud-optimised files.
    let staged = store.arrange(levels.iter_mut().rev().flat_map(|level| &mut level.tiles), head_len);
    store.finish(&directory::encode(&directories(file, &levels), size), &staged)?;
    Ok(filled)
}

impl Level {
    fn new(size: [u32; 2]) -> Level {
        let [across, down] = tiles_of(size);
        Level { size, tiles: vec![[0; 2]; across * down], statistics: Vec::new() }
    }

    fn number(&self, [column, row]: [usize; 2]) -> usize {
        row * tiles_of(self.size)[0] + column
    }

    /// Number of cells of a tile that are in the image, along each axis.
    fn inside(&self, at: [usize; 2]) -> [usize; 2] {
        [0, 1].map(|axis| (self.size[axis] as usize - at[axis] * TILE).min(TILE))
    }

    /// Statistics of all tiles, in an order that does not depend on that in which they came.
    fn summary(&self) -> Option<Statistics> {
        self.statistics.iter().flatten().copied().reduce(Statistics::and)
    }
}

impl Tiles<'_> {
    /// Writes the tile at this column and row of tiles, counted from the top left. NaN marks cells without
    /// data.
    ///
    /// Domain: 256 by 256 values, row by row, for each band; values beyond the grid are ignored.
    ///
    /// # Errors
    /// If writing fails.
    pub fn tile(&mut self, column: usize, row: usize, values: &[f32]) -> Result<()> {
        debug_assert_eq!(values.len(), self.code.samples.bands() * TILE * TILE);
        let mut copy = std::mem::take(&mut self.spare);
        copy.clear();
        copy.extend_from_slice(values);
        self.put((0, [column, row]), copy)
    }

    /// Reads back a tile of a staged file of floating-point numbers; false if the tile was not written.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn read(&mut self, column: usize, row: usize, values: &mut [f32]) -> Result<bool> {
        self.store_all()?;
        let extent = self.levels[0].tiles[self.levels[0].number([column, row])];
        self.store.read(extent, &mut self.bytes)?;
        if self.bytes.is_empty() {
            return Ok(false);
        }
        let decoded = self.code.decode(&self.bytes, values);
        decoded.map_err(|error| Error::io("reading tiles back", error)).map(|()| true)
    }

    /// Writes all rows, as [`crate::raster::write_rows`].
    pub(super) fn rows(&mut self, row: &mut impl FnMut(u32, &mut [f32]) -> Result<()>) -> Result<()> {
        let [columns, rows] = self.levels[0].size;
        let [across, down] = tiles_of([columns, rows]);
        // A row of tiles, padded beyond the last column.
        let width = across * TILE;
        let mut band = vec![f32::NAN; width * TILE];
        let mut tile = vec![f32::NAN; TILE * TILE];
        for at in 0..down {
            let numbers = (at * TILE) as u32..rows.min(((at + 1) * TILE) as u32);
            for (number, values) in numbers.zip(band.chunks_exact_mut(width)) {
                row(number, &mut values[..columns as usize])?;
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

    /// Passes a tile to the compressor, and then each overview tile that it completes.
    fn put(&mut self, name: TileName, values: Vec<f32>) -> Result<()> {
        let mut next = Some((name, values));
        while let Some((name, values)) = next {
            next = match &mut self.overviews {
                Some(overviews) => overviews.add(name, &values)?,
                None => None,
            };
            let inside = self.levels[name.0].inside(name.1);
            if let Some(done) = self.compressor.push(name, inside, values) {
                self.store(done)?;
            }
        }
        Ok(())
    }

    /// Passes the remaining overview tiles, which lack some quarters, to the compressor.
    fn put_rest_of_overviews(&mut self) -> Result<()> {
        for level in 1..self.levels.len() {
            let names = self.overviews.as_ref().map(|overviews| overviews.rest(level)).unwrap_or_default();
            for name in names {
                let Some(overviews) = &mut self.overviews else { continue };
                let (name, values) = overviews.take(name)?;
                self.put(name, values)?;
            }
        }
        Ok(())
    }

    /// Waits for all tiles under way.
    fn store_all(&mut self) -> Result<()> {
        while let Some(done) = self.compressor.next() {
            self.store(done)?;
        }
        Ok(())
    }

    fn store(&mut self, Compressed { name: (level, at), encoded, values }: Compressed) -> Result<()> {
        let Encoded { bytes, statistics } = encoded?;
        let level = &mut self.levels[level];
        let number = level.number(at);
        level.tiles[number] = self.store.put(&bytes)?;
        if let Some(of_tile) = level.statistics.get_mut(number) {
            *of_tile = statistics;
        }
        self.spare = values;
        Ok(())
    }
}

/// The directories of the image and its overviews.
fn directories(file: &RasterFile, levels: &[Level]) -> Vec<Directory> {
    let mut directories: Vec<Directory> = levels.iter().map(|level| describe(level, file)).collect();
    directories[0].extend(refer(&file.grid, &file.reference.keys));
    directories[0].extend(metadata::tag(file, levels[0].summary().as_ref()));
    directories[0].push((SOFTWARE, Values::Text(WRITER.to_string())));
    directories[0].extend(file.options.date.map(|date| (DATE_TIME, Values::Text(date.of_tiff()))));
    let overviews = directories.iter_mut().skip(1);
    overviews.for_each(|directory| directory.push((NEW_SUBFILE_TYPE, Values::Longs(vec![REDUCED_IMAGE]))));
    directories
}

/// The tags that describe the samples and where the tiles are.
fn describe(level: &Level, file: &RasterFile) -> Directory {
    let bands = file.samples.bands();
    let cell_type = file.cell_type();
    let format = match cell_type {
        CellType::Float32 => FLOAT,
        CellType::Byte => UNSIGNED,
        CellType::Int16 | CellType::Int32 => SIGNED,
    };
    let predictor = match TileCode::of(file).predictor {
        Predictor::None => NO_PREDICTOR,
        Predictor::Horizontal => HORIZONTAL_PREDICTOR,
        Predictor::Float => FLOAT_PREDICTOR,
    };
    let compression = match file.options.storage.compression {
        Compression::Deflate => DEFLATE,
        Compression::Zstd => ZSTD,
        Compression::None => UNCOMPRESSED,
    };
    let each = |number: u16| Values::Shorts(vec![number; bands]);
    let short = |number: u16| Values::Shorts(vec![number]);
    let long = |number: u32| Values::Longs(vec![number]);
    let part = |part: usize| Values::Offsets(level.tiles.iter().map(|extent| extent[part]).collect());
    let mut tags = vec![
        (IMAGE_WIDTH, long(level.size[0])),
        (IMAGE_LENGTH, long(level.size[1])),
        (BITS_PER_SAMPLE, each(8 * cell_type.len() as u16)),
        (COMPRESSION, short(compression)),
        (PHOTOMETRIC_INTERPRETATION, short(if bands == 1 { BLACK_IS_ZERO } else { RGB })),
        (SAMPLES_PER_PIXEL, short(bands as u16)),
        (PREDICTOR, short(predictor)),
        (TILE_WIDTH, long(TILE as u32)),
        (TILE_LENGTH, long(TILE as u32)),
        (TILE_OFFSETS, part(0)),
        (TILE_BYTE_COUNTS, part(1)),
        (SAMPLE_FORMAT, each(format)),
    ];
    // What is transparent has no data.
    tags.push(match file.samples {
        Samples::Colours => (EXTRA_SAMPLES, short(UNASSOCIATED_ALPHA)),
        _ => (GDAL_NO_DATA, Values::Text(file.no_data_text())),
    });
    tags
}

/// The tags that georeference the cells.
fn refer(grid: &Grid, keys: &GeoKeys) -> Directory {
    let mut tags = vec![
        (PIXEL_SCALE, Values::Doubles(vec![grid.step, grid.step, 0.0])),
        (TIEPOINT, Values::Doubles(vec![0.0, 0.0, 0.0, grid.left, grid.top, 0.0])),
    ];
    if !keys.directory.is_empty() {
        tags.push((KEY_DIRECTORY, Values::Shorts(keys.directory.clone())));
    }
    if !keys.doubles.is_empty() {
        tags.push((KEY_DOUBLES, Values::Doubles(keys.doubles.clone())));
    }
    if !keys.texts.is_empty() {
        tags.push((KEY_TEXTS, Values::Text(keys.texts.clone())));
    }
    tags
}
