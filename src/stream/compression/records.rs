//! Any payload as records of one length: the first bytes of all records, then the second ones, and so on.
//! Bytes of one meaning then stand together, which zstd makes use of. Before that, words may be replaced by
//! their differences from the words of the record before.

use super::bytes::Bytes;
use super::frames::{Packer, Unpacker};
use super::{Fault, Method};
use spmesh_base::limits::BLOCK_PAYLOAD_MAX;

/// How a payload is taken as records.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Shape {
    /// Bytes of a record; 1 leaves the payload as it is.
    pub(super) record_len: u16,
    pub(super) words: Words,
}

/// Whether words are replaced by differences.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Words {
    Kept,
    /// u32 by differences.
    U32,
    /// u64 by differences.
    U64,
}

impl Words {
    fn of_byte(byte: u8) -> Option<Words> {
        [Words::Kept, Words::U32, Words::U64].into_iter().find(|words| words.width() == byte)
    }

    /// Bytes of a word that is replaced; 0 if none is.
    fn width(self) -> u8 {
        match self {
            Words::Kept => 0,
            Words::U32 => 4,
            Words::U64 => 8,
        }
    }

    fn fit(self, record_len: u16) -> bool {
        self == Words::Kept || record_len.is_multiple_of(self.width().into())
    }
}

impl Shape {
    /// Whole payloads, with their bytes in their order.
    const BYTES: Shape = Shape { record_len: 1, words: Words::Kept };

    /// Shapes that may suit a payload of such records.
    pub(super) fn candidates(self) -> [Shape; 3] {
        [self, Shape { words: Words::Kept, ..self }, Shape::BYTES]
    }
}

/// Appends the compressed form of a payload as records of a shape.
pub(super) fn encode(payload: &[u8], shape: Shape, packer: &mut Packer, compressed: &mut Vec<u8>) {
    compressed.push(Method::Records as u8);
    compressed.extend_from_slice(&shape.record_len.to_le_bytes());
    compressed.push(shape.words.width());
    compressed.extend_from_slice(&(payload.len() as u32).to_le_bytes());
    let record_len = usize::from(shape.record_len);
    let frame = match shape.words {
        _ if record_len == 1 => packer.records(payload),
        Words::Kept => packer.records(&planes(payload, record_len)),
        Words::U32 => packer.records(&planes(&differences(payload, record_len, difference32), record_len)),
        Words::U64 => packer.records(&planes(&differences(payload, record_len, difference64), record_len)),
    };
    compressed.extend_from_slice(frame);
}

/// Appends the payload of its compressed form, which is given without its method.
pub(super) fn decode(body: &[u8], unpacker: &mut Unpacker, payload: &mut Vec<u8>) -> Result<(), Fault> {
    let mut bytes = Bytes(body);
    let record_len = bytes.u16()?;
    let words = Words::of_byte(bytes.u8()?).ok_or("words of another width than 0, 4 or 8")?;
    let len = bytes.count()?;
    if record_len == 0 || !words.fit(record_len) {
        return Err("records of 0 bytes, or of no whole number of words");
    }
    if len > BLOCK_PAYLOAD_MAX {
        return Err("more bytes than fit a block");
    }
    let content = unpacker.unpack(bytes.0, len)?;
    if content.len() != len {
        return Err("the zstd frame has fewer bytes than the payload");
    }
    payload.resize(len, 0);
    let record_len = usize::from(record_len);
    restore_planes(content, record_len, payload);
    let records = &mut payload[..len / record_len * record_len];
    match words {
        Words::Kept => {}
        Words::U32 => restore_words(records, record_len, sum32),
        Words::U64 => restore_words(records, record_len, sum64),
    }
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
fn restore_planes(content: &[u8], record_len: usize, payload: &mut [u8]) {
    if record_len == 1 {
        return payload.copy_from_slice(content);
    }
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

/// The payload with words of `WIDTH` bytes replaced by what `difference` makes of them and of the words
/// before.
fn differences<const WIDTH: usize>(
    payload: &[u8],
    record_len: usize,
    difference: impl Fn([u8; WIDTH], [u8; WIDTH]) -> [u8; WIDTH],
) -> Vec<u8> {
    let mut differences = payload.to_vec();
    let records = payload.len() / record_len * record_len;
    let (words, _) = payload[..records].as_chunks::<WIDTH>();
    let (replaced, _) = differences[..records].as_chunks_mut::<WIDTH>();
    let before = std::iter::repeat_n(&[0; WIDTH], record_len / WIDTH).chain(words);
    for ((to, &word), &before) in replaced.iter_mut().zip(words).zip(before) {
        *to = difference(word, before);
    }
    differences
}

/// The inverse of [`differences`], in place.
fn restore_words<const WIDTH: usize>(
    records: &mut [u8],
    record_len: usize,
    sum: impl Fn([u8; WIDTH], [u8; WIDTH]) -> [u8; WIDTH],
) {
    let (words, _) = records.as_chunks_mut::<WIDTH>();
    let per_record = record_len / WIDTH;
    for at in 0..words.len() {
        let before = at.checked_sub(per_record).map_or([0; WIDTH], |before| words[before]);
        words[at] = sum(words[at], before);
    }
}

fn difference32(word: [u8; 4], before: [u8; 4]) -> [u8; 4] {
    let signed = u32::from_le_bytes(word).wrapping_sub(u32::from_le_bytes(before)) as i32;
    ((signed << 1) ^ (signed >> 31)).to_le_bytes()
}

fn difference64(word: [u8; 8], before: [u8; 8]) -> [u8; 8] {
    let signed = u64::from_le_bytes(word).wrapping_sub(u64::from_le_bytes(before)) as i64;
    ((signed << 1) ^ (signed >> 63)).to_le_bytes()
}

fn sum32(difference: [u8; 4], before: [u8; 4]) -> [u8; 4] {
    let code = u32::from_le_bytes(difference);
    u32::from_le_bytes(before).wrapping_add((code >> 1) ^ (code & 1).wrapping_neg()).to_le_bytes()
}

fn sum64(difference: [u8; 8], before: [u8; 8]) -> [u8; 8] {
    let code = u64::from_le_bytes(difference);
    u64::from_le_bytes(before).wrapping_add((code >> 1) ^ (code & 1).wrapping_neg()).to_le_bytes()
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
    fn differences_are_those_of_the_format() {
        let payload = [5u32, 1 << 31, 4, 1, 7].map(u32::to_le_bytes).concat();
        let replaced = [10, u32::MAX, 1, u32::MAX - 2, 7].map(u32::to_le_bytes).concat();
        assert_eq!(differences(&payload, 8, difference32), replaced);
    }

    #[test]
    fn payloads_come_back() {
        for len in [0usize, 1, 23, 24, 100, 4096] {
            let payload: Vec<u8> = (0..len).map(|i| (i * i * 7 / 8) as u8).collect();
            for record_len in [1, 4, 8, 20, 24, 65_528] {
                for words in [Words::Kept, Words::U32, Words::U64].into_iter().filter(|w| w.fit(record_len)) {
                    let (mut compressed, mut restored) = (Vec::new(), Vec::new());
                    encode(&payload, Shape { record_len, words }, &mut Packer::default(), &mut compressed);
                    decode(&compressed[1..], &mut Unpacker::default(), &mut restored).unwrap();
                    assert_eq!(restored, payload);
                }
            }
        }
    }
}
