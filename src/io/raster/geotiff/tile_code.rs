//! The bytes of a tile: floating-point predictor, then deflate (Adobe Photoshop TIFF technical note 3).
//!
//! The predictor groups bytes of equal significance and stores differences, which are small for slowly
//! varying values.

use std::io::{Read, Write};

use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;

use super::TILE;
use crate::raster::NoData;
use spmesh_core::system::{expect_deflate_memory, expect_inflate_memory};

/// Bytes of a number.
pub(super) const LEN: usize = size_of::<f32>();
/// Bytes of a row.
const ROW_LEN: usize = TILE * LEN;

/// Predicts each row, then deflates the result. NaN marks cells without data.
pub(super) fn encode(values: &[f32], no_data: NoData) -> Vec<u8> {
    expect_deflate_memory();
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(6));
    let mut bytes = [0; ROW_LEN];
    for row in values.chunks_exact(TILE) {
        predict(row, no_data, &mut bytes);
        encoder.write_all(&bytes).expect("memory takes all that is written");
    }
    encoder.finish().expect("memory takes all that is written")
}

/// Decodes the values of a tile.
///
/// # Errors
/// If `bytes` are not an encoded tile.
pub(super) fn decode(bytes: &[u8], no_data: NoData, values: &mut [f32]) -> std::io::Result<()> {
    expect_inflate_memory();
    let mut decoder = ZlibDecoder::new(bytes);
    let mut row_bytes = [0; ROW_LEN];
    for row in values.chunks_exact_mut(TILE) {
        decoder.read_exact(&mut row_bytes)?;
        restore(&mut row_bytes, no_data, row);
    }
    Ok(())
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
            let bytes = encode(&values, no_data);
            let mut found = vec![0.0; values.len()];
            decode(&bytes, no_data, &mut found).unwrap();
            assert!(
                found
                    .iter()
                    .zip(&values)
                    .all(|(a, b)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()))
            );
            assert!(decode(&bytes[..bytes.len() / 2], no_data, &mut found).is_err());
        }
    }
}
