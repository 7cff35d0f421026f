//! Tags of the first image of a TIFF file, classic or BigTIFF, in either order of bytes. Pixels are not read.
//!
//! Source: TIFF 6.0, section 2; <https://www.awaresystems.be/imaging/tiff/bigtiff.html>.

use std::collections::BTreeMap;
use std::fs::File;
use std::io;
use std::os::unix::fs::FileExt;

use byteorder::{BigEndian, ByteOrder, LittleEndian};

use spmesh_base::limits::TIFF_TAG_BYTES_MAX;

pub(crate) const WIDTH: u16 = 256;
pub(crate) const HEIGHT: u16 = 257;

const BYTE: u16 = 1;
const ASCII: u16 = 2;
const SHORT: u16 = 3;
const LONG: u16 = 4;
const FLOAT: u16 = 11;
const DOUBLE: u16 = 12;
const LONG8: u16 = 16;

/// The tags of an image.
pub(crate) struct Tags(BTreeMap<u16, Value>);

struct Value {
    kind: u16,
    /// The values, each widened to eight bytes, the least byte first.
    items: Vec<[u8; 8]>,
}

impl Tags {
    /// # Errors
    /// What is wrong with the file.
    pub(crate) fn read(file: &File) -> Result<Tags, String> {
        let mut head = [0; 16];
        let read = file.read_at(&mut head, 0).map_err(|error| error.to_string())?;
        if read < 8 {
            return Err("it ends in its header".to_string());
        }
        match &head[..2] {
            b"II" => Directory::<LittleEndian>::open(file, &head)?.tags(),
            b"MM" => Directory::<BigEndian>::open(file, &head)?.tags(),
            _ => Err("it does not begin with II or MM".to_string()),
        }
    }

    /// The numbers of a tag; none if it is missing, or of a type that is not read.
    pub(crate) fn numbers(&self, tag: u16) -> Vec<f64> {
        let Some(Value { kind, items }) = self.0.get(&tag) else { return Vec::new() };
        let number = |item: &[u8; 8]| match *kind {
            DOUBLE => f64::from_le_bytes(*item),
            FLOAT => f64::from(f32::from_le_bytes([item[0], item[1], item[2], item[3]])),
            _ => u64::from_le_bytes(*item) as f64,
        };
        items.iter().map(number).collect()
    }

    /// The numbers of a tag of 16 bits; none if it is missing or of another type.
    pub(crate) fn shorts(&self, tag: u16) -> Vec<u16> {
        let value = self.0.get(&tag).filter(|value| value.kind == SHORT);
        value.map_or_else(Vec::new, |value| {
            value.items.iter().map(|&[a, b, ..]| u16::from_le_bytes([a, b])).collect()
        })
    }

    /// The text of a tag up to its zero; empty if it is missing or not text.
    pub(crate) fn text(&self, tag: u16) -> String {
        let value = self.0.get(&tag).filter(|value| value.kind == ASCII);
        let bytes = value.iter().flat_map(|value| &value.items).map(|item| item[0]);
        let bytes: Vec<u8> = bytes.take_while(|&byte| byte != 0).collect();
        String::from_utf8_lossy(&bytes).into_owned()
    }

    /// The one number of a tag that is an integer.
    pub(crate) fn integer(&self, tag: u16) -> Option<u32> {
        match self.numbers(tag)[..] {
            [number] if number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&number) => {
                Some(number as u32)
            }
            _ => None,
        }
    }
}

/// Where the tags of the first image are.
struct Directory<'a, O> {
    file: &'a File,
    is_big: bool,
    start: u64,
    order: std::marker::PhantomData<O>,
}

impl<'a, O: ByteOrder> Directory<'a, O> {
    fn open(file: &'a File, head: &[u8; 16]) -> Result<Self, String> {
        let (is_big, start) = match O::read_u16(&head[2..]) {
            42 => (false, u64::from(O::read_u32(&head[4..]))),
            43 => (true, O::read_u64(&head[8..])),
            version => return Err(format!("version {version}, expected 42 or 43")),
        };
        Ok(Directory { file, is_big, start, order: std::marker::PhantomData })
    }

    fn bytes(&self, start: u64, len: usize) -> Result<Vec<u8>, String> {
        let mut bytes = vec![0; len];
        let end = |error: io::Error| match error.kind() {
            io::ErrorKind::UnexpectedEof => format!("it ends before {len} bytes at byte {start}"),
            _ => error.to_string(),
        };
        self.file.read_exact_at(&mut bytes, start).map_err(end)?;
        Ok(bytes)
    }

    fn tags(&self) -> Result<Tags, String> {
        let (count_len, entry_len) = if self.is_big { (8, 20) } else { (2, 12) };
        let count = self.bytes(self.start, count_len)?;
        let count = if self.is_big { O::read_u64(&count) } else { u64::from(O::read_u16(&count)) };
        // Numbers of tags have 16 bits.
        let count = usize::try_from(count).ok().filter(|&count| count <= usize::from(u16::MAX));
        let count = count.ok_or("it states too many tags")?;
        let entries = self.bytes(self.start.saturating_add(count_len as u64), count * entry_len)?;
        let mut tags = BTreeMap::new();
        for entry in entries.chunks_exact(entry_len) {
            if let Some(value) = self.value(entry)? {
                tags.insert(O::read_u16(entry), value);
            }
        }
        Ok(Tags(tags))
    }

    /// The value of an entry; `None` if it is of another type, or longer than what is asked for here.
    fn value(&self, entry: &[u8]) -> Result<Option<Value>, String> {
        let kind = O::read_u16(&entry[2..]);
        let width = match kind {
            BYTE | ASCII => 1,
            SHORT => 2,
            LONG | FLOAT => 4,
            DOUBLE | LONG8 => 8,
            _ => return Ok(None),
        };
        let (count, place) = match self.is_big {
            true => (O::read_u64(&entry[4..]), &entry[12..]),
            false => (u64::from(O::read_u32(&entry[4..])), &entry[8..]),
        };
        let Some(len) = usize::try_from(count).ok().and_then(|count| count.checked_mul(width)) else {
            return Ok(None);
        };
        if len > TIFF_TAG_BYTES_MAX {
            return Ok(None);
        }
        // Short values stand where the place of longer ones would be.
        let bytes = match () {
            () if len <= place.len() => place[..len].to_vec(),
            () if self.is_big => self.bytes(O::read_u64(place), len)?,
            () => self.bytes(u64::from(O::read_u32(place)), len)?,
        };
        let item = |bytes: &[u8]| match width {
            1 => u64::from(bytes[0]),
            2 => u64::from(O::read_u16(bytes)),
            4 => u64::from(O::read_u32(bytes)),
            _ => O::read_u64(bytes),
        };
        let items = bytes.chunks_exact(width).map(|bytes| item(bytes).to_le_bytes()).collect();
        Ok(Some(Value { kind, items }))
    }
}
