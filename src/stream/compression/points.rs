//! Points of three i32 coordinates, axis by axis.
//!
//! Where an axis moves far, the next ones do, too. So the residuals of y and z are sorted by the lengths of
//! those of the axes before.

use byteorder::{ByteOrder, LittleEndian as LE};

use super::bytes::Bytes;
use super::columns::{ColumnReader, ColumnWriter, bit_length};
use super::frames::{Packer, Unpacker};
use super::order::{by_keys, segment_ends};
use super::predictors::Predictor;
use super::{Fault, Method};
use spmesh_base::limits::BLOCK_PAYLOAD_MAX;

const AXES: usize = 3;
const POINT_LEN: usize = 4 * AXES;

/// What is stated of an axis.
#[derive(Clone, Copy)]
struct Axis {
    predictor: Predictor,
    k: u8,
    first: i32,
}

/// Appends the compressed form of the points; returns whether there is one.
pub(super) fn encode(payload: &[u8], packer: &mut Packer, compressed: &mut Vec<u8>) -> bool {
    let count = payload.len() / POINT_LEN;
    if count == 0 || !payload.len().is_multiple_of(POINT_LEN) {
        return false;
    }
    compressed.push(Method::Points as u8);
    compressed.extend_from_slice(&(count as u32).to_le_bytes());
    let mut writer = ColumnWriter::default();
    let mut keys = vec![0; count];
    for axis in 0..AXES {
        let coordinates: Vec<i32> =
            payload.chunks_exact(POINT_LEN).map(|point| LE::read_i32(&point[4 * axis..])).collect();
        let (predictor, residuals) = Predictor::choose(&coordinates);
        let k = if axis == 0 { writer.column(&residuals) } else { sorted(&mut writer, &keys, &residuals) };
        compressed.extend_from_slice(&[predictor.byte(), k]);
        compressed.extend_from_slice(&coordinates[0].to_le_bytes());
        add_lengths(&mut keys, &residuals, axis);
    }
    writer.finish(packer, compressed);
    true
}

fn sorted(writer: &mut ColumnWriter, keys: &[u8], residuals: &[u32]) -> u8 {
    let sorted: Vec<u32> = by_keys(keys).iter().map(|&record| residuals[record as usize]).collect();
    writer.sorted_column(&sorted, &segment_ends(keys))
}

/// Adds the lengths of the residuals of an axis to the keys of the next one.
fn add_lengths(keys: &mut [u8], residuals: &[u32], axis: usize) {
    if axis + 1 < AXES {
        keys.iter_mut().zip(residuals).for_each(|(key, &residual)| *key += bit_length(residual) as u8);
    }
}

/// Appends the points of a compressed payload, which is given without its method.
pub(super) fn decode(body: &[u8], unpacker: &mut Unpacker, payload: &mut Vec<u8>) -> Result<(), Fault> {
    let mut bytes = Bytes(body);
    let count = bytes.count()?;
    if count == 0 || count > BLOCK_PAYLOAD_MAX / POINT_LEN {
        return Err("no points, or more than fit a block");
    }
    let axes = [axis(&mut bytes)?, axis(&mut bytes)?, axis(&mut bytes)?];
    let frame_len = bytes.count()?;
    let tokens = unpacker.unpack(bytes.take(frame_len)?, AXES * count)?;
    let mut columns = ColumnReader::new(tokens, bytes.0);
    payload.resize(POINT_LEN * count, 0);
    let mut keys = vec![0; count];
    for (number, Axis { predictor, k, first }) in axes.into_iter().enumerate() {
        let mut residuals = columns.column(count, k)?;
        if number > 0 {
            residuals = unsorted(&keys, &residuals);
        }
        add_lengths(&mut keys, &residuals, number);
        let field = 4 * number;
        let mut points = payload.chunks_exact_mut(POINT_LEN);
        predictor.restore(first, &residuals, |_, at| {
            if let Some(point) = points.next() {
                LE::write_i32(&mut point[field..], at);
            }
        });
    }
    columns.check_end()
}

fn axis(bytes: &mut Bytes) -> Result<Axis, Fault> {
    let predictor = Predictor::of_byte(bytes.u8()?).ok_or("a predictor above 1")?;
    Ok(Axis { predictor, k: bytes.u8()?, first: bytes.i32()? })
}

fn unsorted(keys: &[u8], sorted: &[u32]) -> Vec<u32> {
    let mut residuals = vec![0; sorted.len()];
    for (&record, &residual) in by_keys(keys).iter().zip(sorted) {
        residuals[record as usize] = residual;
    }
    residuals
}
