//! Types of the values of volumes.

use crate::error::{Error, Result};
use crate::source::byte_order::ByteOrder;

/// How a value is stored.
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

/// The next numbers of `bytes`.
macro_rules! decode {
    ($type:ty, $bytes:expr, $order:expr, $values:expr) => {{
        let numbers =
            $bytes.chunks_exact(size_of::<$type>()).map(|bytes| bytes.try_into().expect("its length"));
        match $order {
            ByteOrder::Little => $values.extend(numbers.map(|bytes| <$type>::from_le_bytes(bytes) as f64)),
            ByteOrder::Big => $values.extend(numbers.map(|bytes| <$type>::from_be_bytes(bytes) as f64)),
        }
    }};
}

impl SampleType {
    /// Bytes of a value.
    pub(super) fn len(self) -> usize {
        match self {
            SampleType::I8 | SampleType::U8 => 1,
            SampleType::I16 | SampleType::U16 => 2,
            SampleType::I32 | SampleType::U32 | SampleType::F32 => 4,
            SampleType::I64 | SampleType::U64 | SampleType::F64 => 8,
        }
    }

    /// Appends the values that `bytes` holds. Integers beyond 2^53 are rounded.
    pub(super) fn decode(self, bytes: &[u8], order: ByteOrder, values: &mut Vec<f64>) {
        match self {
            SampleType::I8 => decode!(i8, bytes, order, values),
            SampleType::U8 => decode!(u8, bytes, order, values),
            SampleType::I16 => decode!(i16, bytes, order, values),
            SampleType::U16 => decode!(u16, bytes, order, values),
            SampleType::I32 => decode!(i32, bytes, order, values),
            SampleType::U32 => decode!(u32, bytes, order, values),
            SampleType::I64 => decode!(i64, bytes, order, values),
            SampleType::U64 => decode!(u64, bytes, order, values),
            SampleType::F32 => decode!(f32, bytes, order, values),
            SampleType::F64 => decode!(f64, bytes, order, values),
        }
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
