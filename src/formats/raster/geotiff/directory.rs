//! Directories of TIFF files, which describe the data (TIFF 6.0, section 2; BigTIFF).
//!
//! They precede the data here, so that a remote reader gets all directories with its first request. Libraries
//! write them after the data.

/// Numbers or text of a tag.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Values {
    Shorts(Vec<u16>),
    Longs(Vec<u32>),
    /// Offsets and lengths: of 64 bits in BigTIFF, otherwise of 32.
    Offsets(Vec<u64>),
    Doubles(Vec<f64>),
    Text(String),
}

/// The tags of an image; their order does not matter.
pub(super) type Directory = Vec<(u16, Values)>;

/// What differs between TIFF and BigTIFF.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Size {
    /// Offsets of 32 bits.
    Classic,
    /// Offsets of 64 bits.
    Big,
}

/// Codes of types.
const ASCII: u16 = 2;
const SHORT: u16 = 3;
const LONG: u16 = 4;
const DOUBLE: u16 = 12;
const LONG8: u16 = 16;

/// The bytes of a file before its data: header, and directories one after the other. Their length depends on
/// the number of values of each tag only, not on the values.
pub(super) fn encode(directories: &[Directory], size: Size) -> Vec<u8> {
    let mut bytes = match size {
        Size::Classic => vec![b'I', b'I', 42, 0],
        Size::Big => vec![b'I', b'I', 43, 0, 8, 0, 0, 0],
    };
    let first = (bytes.len() + size.offset_len()) as u64;
    size.put_offset(&mut bytes, first);
    for (number, directory) in directories.iter().enumerate() {
        put_directory(&mut bytes, directory, size, number + 1 == directories.len());
    }
    bytes
}

fn put_directory(bytes: &mut Vec<u8>, directory: &Directory, size: Size, is_last: bool) {
    let mut tags: Vec<&(u16, Values)> = directory.iter().collect();
    tags.sort_unstable_by_key(|(tag, _)| *tag);
    // Values that are longer than an offset follow the directory.
    let mut after = bytes.len() as u64 + size.directory_len(tags.len());
    let mut values_after = Vec::new();
    size.put_count(bytes, tags.len());
    for (tag, values) in tags {
        let mut encoded = values.encode(size);
        bytes.extend_from_slice(&tag.to_le_bytes());
        bytes.extend_from_slice(&values.type_code(size).to_le_bytes());
        size.put_offset(bytes, values.count());
        if encoded.len() <= size.offset_len() {
            encoded.resize(size.offset_len(), 0);
            bytes.append(&mut encoded);
        } else {
            size.put_offset(bytes, after);
            // Values and directories start at even offsets.
            encoded.resize(encoded.len().next_multiple_of(8), 0);
            after += encoded.len() as u64;
            values_after.append(&mut encoded);
        }
    }
    size.put_offset(bytes, if is_last { 0 } else { after });
    bytes.append(&mut values_after);
}

impl Size {
    fn offset_len(self) -> usize {
        match self {
            Size::Classic => 4,
            Size::Big => 8,
        }
    }

    /// Length in bytes of a directory, without the values that follow it.
    fn directory_len(self, tags: usize) -> u64 {
        let (count_len, tag_len) = match self {
            Size::Classic => (2, 12),
            Size::Big => (8, 20),
        };
        (count_len + tags * tag_len + self.offset_len()) as u64
    }

    fn put_offset(self, bytes: &mut Vec<u8>, offset: u64) {
        bytes.extend_from_slice(&offset.to_le_bytes()[..self.offset_len()]);
    }

    fn put_count(self, bytes: &mut Vec<u8>, count: usize) {
        match self {
            Size::Classic => bytes.extend_from_slice(&(count as u16).to_le_bytes()),
            Size::Big => bytes.extend_from_slice(&(count as u64).to_le_bytes()),
        }
    }
}

impl Values {
    fn type_code(&self, size: Size) -> u16 {
        match (self, size) {
            (Values::Shorts(_), _) => SHORT,
            (Values::Longs(_), _) | (Values::Offsets(_), Size::Classic) => LONG,
            (Values::Offsets(_), Size::Big) => LONG8,
            (Values::Doubles(_), _) => DOUBLE,
            (Values::Text(_), _) => ASCII,
        }
    }

    fn count(&self) -> u64 {
        let count = match self {
            Values::Shorts(numbers) => numbers.len(),
            Values::Longs(numbers) => numbers.len(),
            Values::Offsets(numbers) => numbers.len(),
            Values::Doubles(numbers) => numbers.len(),
            // With the terminating NUL.
            Values::Text(text) => text.len() + 1,
        };
        count as u64
    }

    fn encode(&self, size: Size) -> Vec<u8> {
        match self {
            Values::Shorts(numbers) => numbers.iter().flat_map(|number| number.to_le_bytes()).collect(),
            Values::Longs(numbers) => numbers.iter().flat_map(|number| number.to_le_bytes()).collect(),
            Values::Doubles(numbers) => numbers.iter().flat_map(|number| number.to_le_bytes()).collect(),
            Values::Text(text) => text.bytes().chain([0]).collect(),
            Values::Offsets(numbers) => {
                let mut bytes = Vec::with_capacity(numbers.len() * size.offset_len());
                numbers.iter().for_each(|&number| size.put_offset(&mut bytes, number));
                bytes
            }
        }
    }
}
