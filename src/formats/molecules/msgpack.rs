//! Values of MessagePack, as far as BinaryCIF has them.
//!
//! Source: the specification of MessagePack.

use spmesh_base::error::{Error, Result};

/// Deepest arrays and maps: BinaryCIF needs ten levels.
const DEPTH_MAX: usize = 32;

/// A value; texts and bytes are those of the input.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Value<'b> {
    Nothing,
    Integer(i64),
    Number(f64),
    Text(&'b str),
    Bytes(&'b [u8]),
    Array(Vec<Value<'b>>),
    Map(Vec<(Value<'b>, Value<'b>)>),
}

impl<'b> Value<'b> {
    /// The value that is all of `bytes`. Memory: 56 bytes for each value, which takes one or more.
    ///
    /// # Errors
    /// Malformed, with the byte.
    pub(crate) fn read(bytes: &'b [u8]) -> Result<Value<'b>> {
        let mut reader = Reader { bytes, at: 0 };
        let value = reader.value(DEPTH_MAX).map_err(|e| e.at(format!("byte {}", reader.at)))?;
        match bytes.len() - reader.at {
            0 => Ok(value),
            rest => {
                Err(Error::malformed(format!("{rest} bytes follow the value"))
                    .at(format!("byte {}", reader.at)))
            }
        }
    }

    /// The value of a key of a map.
    pub(crate) fn get(&self, key: &str) -> Option<&Value<'b>> {
        let Value::Map(entries) = self else { return None };
        entries.iter().find(|(name, _)| *name == Value::Text(key)).map(|(_, value)| value)
    }

    /// The items of an array at a key of a map.
    pub(crate) fn items(&self, key: &str) -> Result<&[Value<'b>]> {
        match self.get(key) {
            Some(Value::Array(items)) => Ok(items),
            _ => Err(lacks("an array", key)),
        }
    }

    pub(crate) fn text(&self, key: &str) -> Result<&'b str> {
        match self.get(key) {
            Some(Value::Text(text)) => Ok(text),
            _ => Err(lacks("a text", key)),
        }
    }

    pub(crate) fn bytes(&self, key: &str) -> Result<&'b [u8]> {
        match self.get(key) {
            Some(Value::Bytes(bytes)) => Ok(bytes),
            _ => Err(lacks("bytes", key)),
        }
    }

    pub(crate) fn integer(&self, key: &str) -> Result<i64> {
        match self.get(key) {
            Some(Value::Integer(value)) => Ok(*value),
            Some(Value::Number(value)) if value.fract() == 0.0 => Ok(*value as i64),
            _ => Err(lacks("an integer", key)),
        }
    }

    pub(crate) fn number(&self, key: &str) -> Result<f64> {
        match self.get(key) {
            Some(Value::Integer(value)) => Ok(*value as f64),
            Some(Value::Number(value)) => Ok(*value),
            _ => Err(lacks("a number", key)),
        }
    }
}

fn lacks(what: &str, key: &str) -> Error {
    Error::malformed(format!("expected {what} with the key {key:?}"))
}

struct Reader<'b> {
    bytes: &'b [u8],
    at: usize,
}

impl<'b> Reader<'b> {
    fn take(&mut self, len: u64) -> Result<&'b [u8]> {
        let rest = &self.bytes[self.at..];
        let taken = usize::try_from(len).ok().and_then(|len| rest.get(..len));
        let taken = taken.ok_or_else(|| Error::malformed(format!("truncated: expected {len} bytes more")))?;
        self.at += taken.len();
        Ok(taken)
    }

    /// A big-endian number of up to eight bytes.
    fn unsigned(&mut self, len: u64) -> Result<u64> {
        Ok(self.take(len)?.iter().fold(0, |number, &byte| number << 8 | u64::from(byte)))
    }

    fn value(&mut self, depth: usize) -> Result<Value<'b>> {
        let first = self.take(1)?[0];
        Ok(match first {
            0x00..=0x7f => Value::Integer(i64::from(first)),
            0x80..=0x8f => self.map(u64::from(first & 0xf), depth)?,
            0x90..=0x9f => self.array(u64::from(first & 0xf), depth)?,
            0xa0..=0xbf => self.text(u64::from(first & 0x1f))?,
            0xc0 => Value::Nothing,
            0xc2 | 0xc3 => Value::Integer(i64::from(first & 1)),
            0xc4..=0xc6 => {
                let len = self.unsigned(1 << (first - 0xc4))?;
                Value::Bytes(self.take(len)?)
            }
            0xca => Value::Number(f64::from(f32::from_bits(self.unsigned(4)? as u32))),
            0xcb => Value::Number(f64::from_bits(self.unsigned(8)?)),
            0xcc..=0xcf => {
                let number = self.unsigned(1 << (first - 0xcc))?;
                i64::try_from(number).map_or(Value::Number(number as f64), Value::Integer)
            }
            0xd0 => Value::Integer(i64::from(self.unsigned(1)? as i8)),
            0xd1 => Value::Integer(i64::from(self.unsigned(2)? as i16)),
            0xd2 => Value::Integer(i64::from(self.unsigned(4)? as i32)),
            0xd3 => Value::Integer(self.unsigned(8)?.cast_signed()),
            0xd9..=0xdb => {
                let len = self.unsigned(1 << (first - 0xd9))?;
                self.text(len)?
            }
            0xdc | 0xdd => {
                let len = self.unsigned(2 << (first - 0xdc))?;
                self.array(len, depth)?
            }
            0xde | 0xdf => {
                let len = self.unsigned(2 << (first - 0xde))?;
                self.map(len, depth)?
            }
            0xe0..=0xff => Value::Integer(i64::from(first.cast_signed())),
            _ => return Err(Error::malformed(format!("found {first:#04x} as the type of a value"))),
        })
    }

    fn text(&mut self, len: u64) -> Result<Value<'b>> {
        let bytes = self.take(len)?;
        std::str::from_utf8(bytes)
            .map(Value::Text)
            .map_err(|_| Error::malformed("found a text that is not UTF-8"))
    }

    /// Items are pushed as they come: the length is not trusted.
    fn array(&mut self, len: u64, depth: usize) -> Result<Value<'b>> {
        let inner = deeper(depth)?;
        let mut items = Vec::new();
        for _ in 0..len {
            items.push(self.value(inner)?);
        }
        Ok(Value::Array(items))
    }

    fn map(&mut self, len: u64, depth: usize) -> Result<Value<'b>> {
        let inner = deeper(depth)?;
        let mut entries = Vec::new();
        for _ in 0..len {
            entries.push((self.value(inner)?, self.value(inner)?));
        }
        Ok(Value::Map(entries))
    }
}

fn deeper(depth: usize) -> Result<usize> {
    depth
        .checked_sub(1)
        .ok_or_else(|| Error::malformed(format!("more than {DEPTH_MAX} levels of arrays and maps")))
}
