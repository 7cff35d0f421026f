//! Names of the types of raw numbers.

use std::fmt;
use std::str::FromStr;

use crate::raw::byte_order::ByteOrder;
use crate::raw::sample::SampleType;

/// Type and byte order of raw numbers, such as `f32le`: i, u or f for signed, unsigned or floating point, the
/// number of bits, and le or be for little-endian or big-endian, which types of one byte omit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RawType {
    pub(crate) sample: SampleType,
    pub(crate) order: ByteOrder,
}

const TYPES: [(&str, SampleType); 10] = [
    ("i8", SampleType::I8),
    ("u8", SampleType::U8),
    ("i16", SampleType::I16),
    ("u16", SampleType::U16),
    ("i32", SampleType::I32),
    ("u32", SampleType::U32),
    ("i64", SampleType::I64),
    ("u64", SampleType::U64),
    ("f32", SampleType::F32),
    ("f64", SampleType::F64),
];

impl FromStr for RawType {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<RawType, String> {
        let (name, order) = match (text.strip_suffix("le"), text.strip_suffix("be")) {
            (Some(name), _) => (name, Some(ByteOrder::Little)),
            (_, Some(name)) => (name, Some(ByteOrder::Big)),
            _ => (text, None),
        };
        let Some(&(_, sample)) = TYPES.iter().find(|(known, _)| *known == name) else {
            return Err(format!("unknown type {text:?}, expected i8, u8, i16le, u16be, ... or f64be"));
        };
        let order = match order {
            None if sample.len() > 1 => {
                return Err(format!("the byte order of {text} is missing: {text}le or {text}be"));
            }
            order => order.unwrap_or(ByteOrder::Little),
        };
        Ok(RawType { sample, order })
    }
}

impl fmt::Display for RawType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = TYPES.iter().find(|(_, sample)| *sample == self.sample).map_or("", |(name, _)| name);
        let order = match (self.sample.len(), self.order) {
            (1, _) => "",
            (_, ByteOrder::Little) => "le",
            (_, ByteOrder::Big) => "be",
        };
        write!(f, "{name}{order}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_are_read_and_written() {
        for text in ["i8", "u8", "i16le", "u16be", "i32be", "u32le", "i64le", "u64be", "f32le", "f64be"] {
            assert_eq!(text.parse::<RawType>().unwrap().to_string(), text);
        }
        for (text, part) in [("f32", "f32le or f32be"), ("f16le", "unknown type \"f16le\""), ("", "unknown")]
        {
            let message = text.parse::<RawType>().unwrap_err();
            assert!(message.contains(part), "{message}");
        }
    }
}
