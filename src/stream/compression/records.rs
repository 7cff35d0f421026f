//! Any payload as records of one length: the first bytes of all records, then the second ones, and so on.
//! Bytes of one meaning stand together then, which zstd makes use of.

use super::bytes::Bytes;
use super::frames::{Packer, Unpacker};
use super::{Fault, Method};
use spmesh_core::limits::BLOCK_PAYLOAD_MAX;

/// Appends the compressed form of a payload as records of `record_len` bytes.
pub(super) fn encode(payload: &[u8], record_len: usize, packer: &mut Packer, compressed: &mut Vec<u8>) {
    compressed.push(Method::Records as u8);
    compressed.extend_from_slice(&(record_len as u16).to_le_bytes());
    compressed.extend_from_slice(&(payload.len() as u32).to_le_bytes());
    compressed.extend_from_slice(packer.records(&planes(payload, record_len)));
}

/// Appends the payload of its compressed form, which is given without its method.
///
/// # Errors
/// If it is malformed.
pub(super) fn decode(body: &[u8], unpacker: &mut Unpacker, payload: &mut Vec<u8>) -> Result<(), Fault> {
    let mut bytes = Bytes(body);
    let record_len = usize::from(bytes.u16()?);
    let len = bytes.count()?;
    if record_len == 0 {
        return Err("records of 0 bytes");
    }
    if len > BLOCK_PAYLOAD_MAX {
        return Err("more bytes than fit a block");
    }
    let content = unpacker.unpack(bytes.0, len)?;
    if content.len() != len {
        return Err("the zstd frame has fewer bytes than the payload");
    }
    payload.resize(len, 0);
    restore(content, record_len, payload);
    Ok(())
}

/// The payload by byte planes; bytes behind the last whole record come last.
fn planes(payload: &[u8], record_len: usize) -> Vec<u8> {
    let count = payload.len() / record_len;
    let (records, rest) = payload.split_at(count * record_len);
    let mut planes = vec![0; records.len()];
    for (place, plane) in planes.chunks_exact_mut(count.max(1)).enumerate() {
        for (byte, record) in plane.iter_mut().zip(records.chunks_exact(record_len)) {
            *byte = record[place];
        }
    }
    planes.extend_from_slice(rest);
    planes
}

/// The inverse of [`planes`]; `payload` has the length of the content.
fn restore(content: &[u8], record_len: usize, payload: &mut [u8]) {
    let count = content.len() / record_len;
    let (planes, rest) = content.split_at(count * record_len);
    let (records, tail) = payload.split_at_mut(planes.len());
    for (place, plane) in planes.chunks_exact(count.max(1)).enumerate() {
        for (&byte, record) in plane.iter().zip(records.chunks_exact_mut(record_len)) {
            record[place] = byte;
        }
    }
    tail.copy_from_slice(rest);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_are_those_of_the_format() {
        assert_eq!(planes(b"abcABC-+", 3), b"aAbBcC-+");
        assert_eq!(planes(b"ab", 3), b"ab");
        assert_eq!(planes(b"", 3), b"");
    }

    #[test]
    fn payloads_come_back() {
        for len in [0usize, 1, 23, 24, 100, 4096] {
            let payload: Vec<u8> = (0..len).map(|i| (i * 7 >> 3) as u8).collect();
            for record_len in [1, 4, 8, 20, 24, 65_535] {
                let (mut compressed, mut restored) = (Vec::new(), Vec::new());
                encode(&payload, record_len, &mut Packer::default(), &mut compressed);
                decode(&compressed[1..], &mut Unpacker::default(), &mut restored).unwrap();
                assert_eq!(restored, payload);
            }
        }
    }
}
