//! The bytes of a tile: rows of cells through a predictor, then compressed.
//!
//! The floating-point predictor (Adobe Photoshop TIFF technical note 3) groups bytes of equal significance
//! and stores differences, which are small for slowly varying values. The horizontal one (TIFF 6.0, section
//! 14) stores differences of numbers.

use std::io::{Read, Write};

use flate2::Compression as Level;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;

use super::statistics::Statistics;
use crate::raster::geotiff::TILE;
use crate::raster::{CellType, Compression, Integers, NoData, Predictor, RasterFile, Samples};
use spmesh_base::error::Result;
use spmesh_base::system::{expect_deflate_memory, expect_inflate_memory};
use spmesh_stream::zstd_frame;

/// Bytes of a floating-point number.
const LEN: usize = size_of::<f32>();
/// Bytes of a row of floating-point numbers.
const ROW_LEN: usize = TILE * LEN;

/// How the cells of a tile become bytes.
#[derive(Debug, Clone, Copy)]
pub(super) struct TileCode {
    pub(super) samples: Samples,
    no_data: NoData,
    cell_type: CellType,
    integers: Option<Integers>,
    compression: Compression,
    pub(super) predictor: Predictor,
    has_statistics: bool,
}

/// The bytes of a tile, and the statistics of its numbers if they are asked for and there are any.
#[derive(Debug)]
pub(super) struct Encoded {
    pub(super) bytes: Vec<u8>,
    pub(super) statistics: Option<Statistics>,
}

impl TileCode {
    /// How the tiles of a file become bytes.
    pub(super) fn of(file: &RasterFile) -> TileCode {
        let storage = &file.options.storage;
        let cell_type = file.cell_type();
        let usual = match (storage.compression, cell_type) {
            // Readers predict nothing of what is not compressed.
            (Compression::None, _) => Predictor::None,
            (_, CellType::Float32) => Predictor::Float,
            _ => Predictor::Horizontal,
        };
        TileCode {
            samples: file.samples,
            no_data: file.no_data(),
            cell_type,
            integers: file.integers().copied(),
            compression: storage.compression,
            predictor: storage.predictor.unwrap_or(usual),
            has_statistics: file.options.has_statistics,
        }
    }

    /// Bytes of a cell.
    pub(super) fn cell_len(&self) -> usize {
        self.samples.bands() * self.cell_type.len()
    }

    /// Predicts each row, then compresses the result. NaN marks cells without data; `inside` is the number of
    /// cells along each axis that are in the image.
    ///
    /// # Errors
    /// Usage, if a value does not fit the type of stored numbers.
    pub(super) fn encode(&self, values: &[f32], inside: [usize; 2]) -> Result<Encoded> {
        let (mut bytes, mut numbers) = (Vec::with_capacity(TILE * TILE * self.cell_len()), Vec::new());
        for row in 0..TILE {
            let start = bytes.len();
            bytes.resize(start + TILE * self.cell_len(), 0);
            let into = &mut bytes[start..];
            if self.samples == Samples::Floats {
                let cells = &values[row * TILE..][..TILE];
                let known = if row < inside[1] { inside[0] } else { 0 };
                self.put_row(cells, known, into, &mut numbers)?;
            } else {
                put_bytes(values, row, into);
                self.predict(into);
            }
        }
        let statistics = if self.has_statistics { Statistics::of(&numbers) } else { None };
        Ok(Encoded { bytes: self.compress(bytes), statistics })
    }

    /// Writes a row, of which the first `known` cells are in the image; adds numbers that are data.
    fn put_row(&self, row: &[f32], known: usize, bytes: &mut [u8], numbers: &mut Vec<f64>) -> Result<()> {
        let Some(integers) = &self.integers else {
            put_floats(row, self.no_data, self.predictor, bytes);
            if self.has_statistics {
                let data = row[..known].iter().filter(|value| !value.is_nan());
                numbers.extend(data.map(|&value| f64::from(self.no_data.stored(value))));
            }
            return Ok(());
        };
        for (cell, (value, into)) in row.iter().zip(bytes.chunks_exact_mut(self.cell_type.len())).enumerate()
        {
            // Whatever is beyond the image need not fit.
            let value = if cell < known { *value } else { f32::NAN };
            let number = integers.stored(value)?;
            into.copy_from_slice(&(number as i64).to_le_bytes()[..self.cell_type.len()]);
            if self.has_statistics && !value.is_nan() {
                numbers.push(number);
            }
        }
        self.predict(bytes);
        Ok(())
    }

    /// Replaces the numbers of a row by differences, if they are to be predicted so.
    fn predict(&self, bytes: &mut [u8]) {
        if self.predictor == Predictor::Horizontal {
            subtract(bytes, self.cell_type.len(), self.samples.bands());
        }
    }

    fn compress(&self, bytes: Vec<u8>) -> Vec<u8> {
        match self.compression {
            Compression::None => bytes,
            Compression::Zstd => zstd_frame(&bytes),
            Compression::Deflate => {
                expect_deflate_memory();
                let mut encoder = ZlibEncoder::new(Vec::new(), Level::new(6));
                encoder.write_all(&bytes).expect("memory takes all that is written");
                encoder.finish().expect("memory takes all that is written")
            }
        }
    }

    /// Decodes the values of a tile of floating-point numbers, as they are stored by default.
    pub(super) fn decode(&self, bytes: &[u8], values: &mut [f32]) -> std::io::Result<()> {
        debug_assert!(self.samples == Samples::Floats && self.integers.is_none());
        debug_assert!(self.compression == Compression::Deflate && self.predictor == Predictor::Float);
        expect_inflate_memory();
        let mut decoder = ZlibDecoder::new(bytes);
        let mut row_bytes = [0; ROW_LEN];
        for row in values.chunks_exact_mut(TILE) {
            decoder.read_exact(&mut row_bytes)?;
            restore(&mut row_bytes, self.no_data, row);
        }
        Ok(())
    }
}

/// Writes the bytes of a row of cells, band by band for each cell. No data becomes 0.
fn put_bytes(planes: &[f32], row: usize, bytes: &mut [u8]) {
    let bands = bytes.len() / TILE;
    for (band, plane) in planes.chunks_exact(TILE * TILE).enumerate() {
        for (cell, value) in plane[row * TILE..][..TILE].iter().enumerate() {
            // Conversion saturates, and NaN becomes 0.
            bytes[cell * bands + band] = value.round() as u8;
        }
    }
}

/// Writes the bytes of a row of floating-point numbers.
fn put_floats(row: &[f32], no_data: NoData, predictor: Predictor, bytes: &mut [u8]) {
    for (i, value) in row.iter().enumerate() {
        let stored = no_data.stored(*value);
        if predictor == Predictor::Float {
            // The first bytes of all values, then the second bytes and so on.
            for (place, byte) in stored.to_be_bytes().into_iter().enumerate() {
                bytes[place * TILE + i] = byte;
            }
        } else {
            bytes[i * LEN..][..LEN].copy_from_slice(&stored.to_le_bytes());
        }
    }
    match predictor {
        Predictor::None => {}
        Predictor::Horizontal => subtract(bytes, LEN, 1),
        Predictor::Float => subtract(bytes, 1, 1),
    }
}

/// Replaces numbers of `len` bytes by the difference to the one `bands` before, modulo their range.
fn subtract(bytes: &mut [u8], len: usize, bands: usize) {
    let before = len * bands;
    if len == 1 {
        return (before..bytes.len())
            .rev()
            .for_each(|at| bytes[at] = bytes[at].wrapping_sub(bytes[at - before]));
    }
    let number = |bytes: &[u8]| {
        let mut all = [0; LEN];
        all[..len].copy_from_slice(bytes);
        u32::from_le_bytes(all)
    };
    for at in (before..bytes.len()).step_by(len).rev() {
        let difference = number(&bytes[at..at + len]).wrapping_sub(number(&bytes[at - before..][..len]));
        bytes[at..at + len].copy_from_slice(&difference.to_le_bytes()[..len]);
    }
}

/// Inverts the floating-point predictor.
fn restore(bytes: &mut [u8; ROW_LEN], no_data: NoData, row: &mut [f32]) {
    for i in 1..bytes.len() {
        bytes[i] = bytes[i].wrapping_add(bytes[i - 1]);
    }
    for (i, value) in row.iter_mut().enumerate() {
        *value = no_data.known(f32::from_be_bytes([0, 1, 2, 3].map(|place| bytes[place * TILE + i])));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::{Grid, RasterOptions, Reduction, Reference};

    #[test]
    fn tiles_come_back() {
        let values: Vec<f32> = (0..TILE * TILE)
            .map(|i| match i % 5 {
                0 => f32::NAN,
                1 => -f32::MAX,
                _ => (i as f32 * 0.37).sin(),
            })
            .collect();
        for no_data in [NoData::default(), NoData(f32::NAN)] {
            let options = RasterOptions { no_data, ..RasterOptions::default() };
            let code = TileCode::of(&RasterFile {
                options: &options,
                grid: Grid { left: 0.0, top: 0.0, step: 1.0, columns: 256, rows: 256 },
                reference: &Reference::default(),
                reduction: Reduction::Mean,
                samples: Samples::Floats,
                is_staged: true,
            });
            let Encoded { bytes, statistics } = code.encode(&values, [TILE; 2]).unwrap();
            assert_eq!(statistics, None);
            let mut found = vec![0.0; values.len()];
            code.decode(&bytes, &mut found).unwrap();
            assert!(
                found
                    .iter()
                    .zip(&values)
                    .all(|(a, b)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()))
            );
            assert!(code.decode(&bytes[..bytes.len() / 2], &mut found).is_err());
        }
    }
}
