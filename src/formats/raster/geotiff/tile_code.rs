//! The bytes of a tile: floating-point predictor (Adobe Photoshop TIFF technical note 3), or differences of bytes
//! (TIFF 6.0, section 14), then deflate.
//!
//! The floating-point predictor groups bytes of equal significance and stores differences, which are small for slowly
//! varying values.

use std::io::{Read, Write};

use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;

use crate::raster::geotiff::TILE;
use crate::raster::{NoData, Samples};
use spmesh_base::system::{expect_deflate_memory, expect_inflate_memory};

/// Bytes of a number.
const LEN: usize = size_of::<f32>();
/// Bytes of a row of numbers.
const ROW_LEN: usize = TILE * LEN;

/// How the cells of a tile become bytes.
#[derive(Debug, Clone, Copy)]
pub(super) struct TileCode {
    pub(super) samples: Samples,
    pub(super) no_data: NoData,
}

impl TileCode {
    /// Bytes of a cell.
    pub(super) fn cell_len(self) -> usize {
        if self.samples == Samples::Floats { LEN } else { self.samples.bands() }
    }

    /// Predicts each row, then deflates the result. NaN marks cells without data.
    pub(super) fn encode(self, values: &[f32]) -> Vec<u8> {
        expect_deflate_memory();
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(6));
        let mut put = |bytes: &[u8]| encoder.write_all(bytes).expect("memory takes all that is written");
        if self.samples == Samples::Floats {
            let mut bytes = [0; ROW_LEN];
            for row in values.chunks_exact(TILE) {
                predict(row, self.no_data, &mut bytes);
                put(&bytes);
            }
        } else {
            let mut bytes = vec![0; TILE * self.samples.bands()];
            (0..TILE).for_each(|row| {
                predict_bytes(values, row, &mut bytes);
                put(&bytes);
            });
        }
        encoder.finish().expect("memory takes all that is written")
    }

    /// Decodes the values of a tile of floating-point numbers.
    pub(super) fn decode(self, bytes: &[u8], values: &mut [f32]) -> std::io::Result<()> {
        debug_assert_eq!(self.samples, Samples::Floats);
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

/// Writes the bytes of a row of cells, band by band for each cell, as differences from the cell before. No data
/// becomes 0.
fn predict_bytes(planes: &[f32], row: usize, bytes: &mut [u8]) {
    let bands = bytes.len() / TILE;
    for (band, plane) in planes.chunks_exact(TILE * TILE).enumerate() {
        let mut before = 0u8;
        for (cell, value) in plane[row * TILE..][..TILE].iter().enumerate() {
            // Conversion saturates, and NaN becomes 0.
            let byte = value.round() as u8;
            bytes[cell * bands + band] = byte.wrapping_sub(before);
            before = byte;
        }
    }
}

/// Writes the first bytes of all values, then the second bytes and so on, each as the difference from the
/// byte before.
fn predict(row: &[f32], no_data: NoData, bytes: &mut [u8; ROW_LEN]) {
    for (i, value) in row.iter().enumerate() {
        for (place, byte) in no_data.stored(*value).to_be_bytes().into_iter().enumerate() {
            bytes[place * TILE + i] = byte;
        }
    }
    for i in (1..bytes.len()).rev() {
        bytes[i] = bytes[i].wrapping_sub(bytes[i - 1]);
    }
}

/// Inverts [`predict`].
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
            let code = TileCode { samples: Samples::Floats, no_data };
            let bytes = code.encode(&values);
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
