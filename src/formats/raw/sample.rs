//! Types of numbers in binary files.

use std::fmt;

use crate::raw::byte_order::ByteOrder;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::attributes::NumberType;

/// How a number is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SampleType {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

/// The name of the type in Rust and in `--raw`.
impl fmt::Display for SampleType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            SampleType::I8 => "i8",
            SampleType::U8 => "u8",
            SampleType::I16 => "i16",
            SampleType::U16 => "u16",
            SampleType::I32 => "i32",
            SampleType::U32 => "u32",
            SampleType::I64 => "i64",
            SampleType::U64 => "u64",
            SampleType::F32 => "f32",
            SampleType::F64 => "f64",
        })
    }
}

/// Appends the numbers in `bytes`. Each type and order gets its own loop, so that no loop branches on them
/// per number.
macro_rules! decode {
    ($type:ty, $bytes:expr, $order:expr, $numbers:expr) => {{
        let numbers =
            $bytes.chunks_exact(size_of::<$type>()).map(|bytes| bytes.try_into().expect("its length"));
        match $order {
            ByteOrder::Little => $numbers.extend(numbers.map(|bytes| <$type>::from_le_bytes(bytes) as f64)),
            ByteOrder::Big => $numbers.extend(numbers.map(|bytes| <$type>::from_be_bytes(bytes) as f64)),
        }
    }};
}

/// Keeps only the last number.
struct Last(f64);

impl Extend<f64> for Last {
    fn extend<I: IntoIterator<Item = f64>>(&mut self, numbers: I) {
        numbers.into_iter().for_each(|number| self.0 = number);
    }
}

impl SampleType {
    /// Whether numbers are integers, so that none is NaN.
    pub(crate) fn is_integer(self) -> bool {
        !matches!(self, SampleType::F32 | SampleType::F64)
    }

    /// The type of an attribute of such numbers.
    pub(crate) fn number_type(self) -> NumberType {
        match self {
            SampleType::I8 => NumberType::I8,
            SampleType::U8 => NumberType::U8,
            SampleType::I16 => NumberType::I16,
            SampleType::U16 => NumberType::U16,
            SampleType::I32 => NumberType::I32,
            SampleType::U32 => NumberType::U32,
            SampleType::I64 => NumberType::I64,
            SampleType::U64 => NumberType::U64,
            SampleType::F32 => NumberType::F32,
            SampleType::F64 => NumberType::F64,
        }
    }

    /// Length of a number in bytes.
    pub(crate) fn len(self) -> usize {
        match self {
            SampleType::I8 | SampleType::U8 => 1,
            SampleType::I16 | SampleType::U16 => 2,
            SampleType::I32 | SampleType::U32 | SampleType::F32 => 4,
            SampleType::I64 | SampleType::U64 | SampleType::F64 => 8,
        }
    }

    /// Appends the numbers in `bytes`. Integers beyond 2^53 are rounded.
    pub(crate) fn decode(self, bytes: &[u8], order: ByteOrder, numbers: &mut impl Extend<f64>) {
        match self {
            SampleType::I8 => decode!(i8, bytes, order, numbers),
            SampleType::U8 => decode!(u8, bytes, order, numbers),
            SampleType::I16 => decode!(i16, bytes, order, numbers),
            SampleType::U16 => decode!(u16, bytes, order, numbers),
            SampleType::I32 => decode!(i32, bytes, order, numbers),
            SampleType::U32 => decode!(u32, bytes, order, numbers),
            SampleType::I64 => decode!(i64, bytes, order, numbers),
            SampleType::U64 => decode!(u64, bytes, order, numbers),
            SampleType::F32 => decode!(f32, bytes, order, numbers),
            SampleType::F64 => decode!(f64, bytes, order, numbers),
        }
    }

    /// The number in `bytes`, which must be exactly [`SampleType::len`] bytes.
    pub(crate) fn number(self, bytes: &[u8], order: ByteOrder) -> f64 {
        let mut last = Last(0.0);
        self.decode(bytes, order, &mut last);
        last.0
    }

    /// Appends the number that `text` denotes, as an attribute stores it. Any NaN becomes the usual one.
    pub(crate) fn parse_stored(self, text: &[u8], stored: &mut Vec<u8>) -> Result<()> {
        let number = self.number_type();
        let words = std::str::from_utf8(text).unwrap_or_default();
        let is_nan = words.trim_start_matches(['+', '-']).eq_ignore_ascii_case("nan");
        match number {
            NumberType::F32 if is_nan => stored.extend(f32::NAN.to_le_bytes()),
            NumberType::F64 if is_nan => stored.extend(f64::NAN.to_le_bytes()),
            _ => number.parse(words, stored).ok_or_else(|| {
                Error::malformed(format!("found {words:?}, expected a number of type {}", number.name()))
            })?,
        }
        Ok(())
    }

    /// The number that `text` denotes.
    pub(crate) fn parse(self, text: &[u8]) -> Result<f64> {
        let text = std::str::from_utf8(text).unwrap_or("");
        let integer = |least: i128, most: i128| {
            text.parse().ok().filter(|value| (least..=most).contains(value)).map(|value: i128| value as f64)
        };
        let value = match self {
            SampleType::I8 => integer(i8::MIN.into(), i8::MAX.into()),
            SampleType::U8 => integer(0, u8::MAX.into()),
            SampleType::I16 => integer(i16::MIN.into(), i16::MAX.into()),
            SampleType::U16 => integer(0, u16::MAX.into()),
            SampleType::I32 => integer(i32::MIN.into(), i32::MAX.into()),
            SampleType::U32 => integer(0, u32::MAX.into()),
            SampleType::I64 => integer(i64::MIN.into(), i64::MAX.into()),
            SampleType::U64 => integer(0, u64::MAX.into()),
            SampleType::F32 | SampleType::F64 => text.parse().ok(),
        };
        value.ok_or_else(|| Error::malformed(format!("found {text:?}, expected a value of type {self}")))
    }
}
