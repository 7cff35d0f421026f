//! Types of numbers in binary files.

use super::byte_order::ByteOrder;
use crate::error::{Error, Result};

/// How a number is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SampleType {
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

/// The number in `bytes`.
macro_rules! number {
    ($type:ty, $bytes:expr, $order:expr) => {{
        let bytes = $bytes.try_into().expect("its length");
        match $order {
            ByteOrder::Little => <$type>::from_le_bytes(bytes) as f64,
            ByteOrder::Big => <$type>::from_be_bytes(bytes) as f64,
        }
    }};
}

impl SampleType {
    /// Bytes of a number.
    pub(super) fn len(self) -> usize {
        match self {
            SampleType::I8 | SampleType::U8 => 1,
            SampleType::I16 | SampleType::U16 => 2,
            SampleType::I32 | SampleType::U32 | SampleType::F32 => 4,
            SampleType::I64 | SampleType::U64 | SampleType::F64 => 8,
        }
    }

    /// The number in `bytes`, which are as many as it has. Integers beyond 2^53 are rounded.
    #[inline]
    pub(super) fn number(self, bytes: &[u8], order: ByteOrder) -> f64 {
        match self {
            SampleType::I8 => number!(i8, bytes, order),
            SampleType::U8 => number!(u8, bytes, order),
            SampleType::I16 => number!(i16, bytes, order),
            SampleType::U16 => number!(u16, bytes, order),
            SampleType::I32 => number!(i32, bytes, order),
            SampleType::U32 => number!(u32, bytes, order),
            SampleType::I64 => number!(i64, bytes, order),
            SampleType::U64 => number!(u64, bytes, order),
            SampleType::F32 => number!(f32, bytes, order),
            SampleType::F64 => number!(f64, bytes, order),
        }
    }

    /// Appends the numbers in `bytes`.
    pub(super) fn decode(self, bytes: &[u8], order: ByteOrder, numbers: &mut Vec<f64>) {
        numbers.extend(bytes.chunks_exact(self.len()).map(|bytes| self.number(bytes, order)));
    }

    /// The value that is written as `text`.
    ///
    /// # Errors
    /// If it is none of this type.
    pub(super) fn parse(self, text: &[u8]) -> Result<f64> {
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
        value.ok_or_else(|| Error::malformed(format!("found {text:?}, expected a value of type {self:?}")))
    }
}
