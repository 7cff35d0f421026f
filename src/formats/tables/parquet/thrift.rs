//! Structures of Thrift in its compact protocol, which the metadata of Parquet is written in.
//!
//! Specification: doc/specs/thrift-compact-protocol.md of apache/thrift.

/// Types of fields and of elements of lists.
const I32: u8 = 5;
const I64: u8 = 6;
const BINARY: u8 = 8;
const LIST: u8 = 9;
const STRUCT: u8 = 12;
/// Ends a structure.
const STOP: u8 = 0;
/// Lists of fewer elements have their length in the byte of the type.
const SHORT_LIST_END: usize = 15;

/// The fields of a structure, which are written in ascending order of their numbers.
pub(crate) struct Fields {
    bytes: Vec<u8>,
    /// The field written last in the innermost structure; the next one is stated by the difference.
    last: u8,
}

/// The bytes of the structure that has the fields that `write` writes.
pub(crate) fn structure(write: impl FnOnce(&mut Fields)) -> Vec<u8> {
    let mut fields = Fields { bytes: Vec::new(), last: 0 };
    fields.body(write);
    fields.bytes
}

impl Fields {
    pub(crate) fn i32(&mut self, field: u8, value: i32) {
        self.head(field, I32);
        self.integer(value.into());
    }

    pub(crate) fn i64(&mut self, field: u8, value: u64) {
        self.head(field, I64);
        // Counts and offsets of a file are far below 2^63.
        self.integer(value as i64);
    }

    pub(crate) fn text(&mut self, field: u8, text: &str) {
        self.head(field, BINARY);
        self.string(text);
    }

    pub(crate) fn structure(&mut self, field: u8, write: impl FnOnce(&mut Fields)) {
        self.head(field, STRUCT);
        self.body(write);
    }

    /// A list of structures, one for each item.
    pub(crate) fn structures<T>(
        &mut self,
        field: u8,
        items: impl ExactSizeIterator<Item = T>,
        mut write: impl FnMut(&mut Fields, T),
    ) {
        self.list(field, STRUCT, items.len());
        items.for_each(|item| self.body(|fields| write(fields, item)));
    }

    pub(crate) fn i32s(&mut self, field: u8, values: &[i32]) {
        self.list(field, I32, values.len());
        values.iter().for_each(|&value| self.integer(value.into()));
    }

    pub(crate) fn texts(&mut self, field: u8, texts: &[&str]) {
        self.list(field, BINARY, texts.len());
        texts.iter().for_each(|text| self.string(text));
    }

    fn body(&mut self, write: impl FnOnce(&mut Fields)) {
        let outer = std::mem::take(&mut self.last);
        write(self);
        self.bytes.push(STOP);
        self.last = outer;
    }

    fn head(&mut self, field: u8, kind: u8) {
        let step = field - self.last;
        // Greater steps have another form, which no structure of Parquet needs here.
        debug_assert!((1..16).contains(&step), "field {field} follows field {}", self.last);
        self.bytes.push(step << 4 | kind);
        self.last = field;
    }

    fn list(&mut self, field: u8, kind: u8, len: usize) {
        self.head(field, LIST);
        self.bytes.push((len.min(SHORT_LIST_END) as u8) << 4 | kind);
        if len >= SHORT_LIST_END {
            varint(&mut self.bytes, len as u64);
        }
    }

    /// The sign goes to the lowest bit, so that small numbers of either sign are short.
    fn integer(&mut self, value: i64) {
        varint(&mut self.bytes, (value << 1 ^ value >> 63) as u64);
    }

    fn string(&mut self, text: &str) {
        varint(&mut self.bytes, text.len() as u64);
        self.bytes.extend_from_slice(text.as_bytes());
    }
}

/// Writes an integer in groups of seven bits, the lowest first (ULEB128).
pub(crate) fn varint(bytes: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn structures_have_the_bytes_of_the_specification() {
        let bytes = structure(|fields| {
            fields.i32(1, -1);
            fields.i64(3, 150);
            fields.structure(4, |inner| inner.text(15, "é"));
            fields.i32s(5, &[0, 3]);
            fields.structures(6, 0..15, |_, _| ());
        });
        let expected = [
            &[0x15, 1, 0x26, 0xac, 2, 0x1c, 0xf8, 2, 0xc3, 0xa9, 0, 0x19, 0x25, 0, 6, 0x19, 0xfc, 15][..],
            &[0; 16],
        ];
        assert_eq!(bytes, expected.concat());
    }
}
