//! Stored numbers and their types.

use std::fmt;

use crate::model::decimal::Decimal;

/// The type of a stored number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NumberType {
    /// Unsigned, 8 bits.
    U8,
    /// Signed, 8 bits.
    I8,
    /// Unsigned, 16 bits.
    U16,
    /// Signed, 16 bits.
    I16,
    /// Unsigned, 32 bits.
    U32,
    /// Signed, 32 bits.
    I32,
    /// Unsigned, 64 bits.
    U64,
    /// Signed, 64 bits.
    I64,
    /// Floating point, 32 bits.
    F32,
    /// Floating point, 64 bits.
    F64,
}

/// All types, in the order of their codes, which start at 1.
const TYPES: [(NumberType, &str, usize); 10] = [
    (NumberType::U8, "u8", 1),
    (NumberType::I8, "i8", 1),
    (NumberType::U16, "u16", 2),
    (NumberType::I16, "i16", 2),
    (NumberType::U32, "u32", 4),
    (NumberType::I32, "i32", 4),
    (NumberType::U64, "u64", 8),
    (NumberType::I64, "i64", 8),
    (NumberType::F32, "f32", 4),
    (NumberType::F64, "f64", 8),
];

impl NumberType {
    /// The code in a stream.
    pub fn code(self) -> u8 {
        self as u8 + 1
    }

    /// The type with this code, if there is one.
    pub fn from_code(code: u8) -> Option<Self> {
        TYPES.get(usize::from(code).checked_sub(1)?).map(|row| row.0)
    }

    /// The name in texts, such as `u16`.
    pub fn name(self) -> &'static str {
        TYPES[self as usize].1
    }

    /// The type with this name, if there is one.
    pub fn from_name(name: &str) -> Option<Self> {
        TYPES.iter().find(|row| row.1 == name).map(|row| row.0)
    }

    /// Bytes of a number.
    pub fn width(self) -> usize {
        TYPES[self as usize].2
    }

    /// The number in the first bytes of `bytes`.
    ///
    /// # Panics
    /// If there are fewer bytes than the type has.
    pub fn read(self, bytes: &[u8]) -> Number {
        fn first<const N: usize>(bytes: &[u8]) -> [u8; N] {
            *bytes.first_chunk().expect("all bytes of a number")
        }
        match self {
            NumberType::U8 => Number::Unsigned(bytes[0].into()),
            NumberType::I8 => Number::Signed(i8::from_le_bytes(first(bytes)).into()),
            NumberType::U16 => Number::Unsigned(u16::from_le_bytes(first(bytes)).into()),
            NumberType::I16 => Number::Signed(i16::from_le_bytes(first(bytes)).into()),
            NumberType::U32 => Number::Unsigned(u32::from_le_bytes(first(bytes)).into()),
            NumberType::I32 => Number::Signed(i32::from_le_bytes(first(bytes)).into()),
            NumberType::U64 => Number::Unsigned(u64::from_le_bytes(first(bytes))),
            NumberType::I64 => Number::Signed(i64::from_le_bytes(first(bytes))),
            NumberType::F32 => Number::F32(f32::from_le_bytes(first(bytes))),
            NumberType::F64 => Number::F64(f64::from_le_bytes(first(bytes))),
        }
    }

    /// Appends the number that `text` says: an integer, or for types of floating point a decimal, `inf`,
    /// `-inf`, or the bits of a NaN as `0x` and hexadecimal digits. `None` if it is none of this type.
    pub fn parse(self, text: &str, bytes: &mut Vec<u8>) -> Option<()> {
        match self {
            NumberType::U8 => bytes.extend(text.parse::<u8>().ok()?.to_le_bytes()),
            NumberType::I8 => bytes.extend(text.parse::<i8>().ok()?.to_le_bytes()),
            NumberType::U16 => bytes.extend(text.parse::<u16>().ok()?.to_le_bytes()),
            NumberType::I16 => bytes.extend(text.parse::<i16>().ok()?.to_le_bytes()),
            NumberType::U32 => bytes.extend(text.parse::<u32>().ok()?.to_le_bytes()),
            NumberType::I32 => bytes.extend(text.parse::<i32>().ok()?.to_le_bytes()),
            NumberType::U64 => bytes.extend(text.parse::<u64>().ok()?.to_le_bytes()),
            NumberType::I64 => bytes.extend(text.parse::<i64>().ok()?.to_le_bytes()),
            NumberType::F32 => bytes.extend(parse_f32(text)?.to_le_bytes()),
            NumberType::F64 => bytes.extend(parse_f64(text)?.to_le_bytes()),
        }
        Some(())
    }
}

fn parse_f32(text: &str) -> Option<f32> {
    match text.strip_prefix("0x") {
        Some(bits) => Some(f32::from_bits(u32::from_str_radix(bits, 16).ok()?)),
        None => text.parse().ok().filter(|value: &f32| !value.is_nan()),
    }
}

fn parse_f64(text: &str) -> Option<f64> {
    match text.strip_prefix("0x") {
        Some(bits) => Some(f64::from_bits(u64::from_str_radix(bits, 16).ok()?)),
        None => text.parse().ok().filter(|value: &f64| !value.is_nan()),
    }
}

/// A stored number. It is shown so that [`NumberType::parse`] reads the same bits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Number {
    /// An integer without sign.
    Unsigned(u64),
    /// An integer.
    Signed(i64),
    /// A binary32 number.
    F32(f32),
    /// A binary64 number.
    F64(f64),
}

impl Number {
    /// The nearest f64.
    pub fn to_f64(self) -> f64 {
        match self {
            Number::Unsigned(value) => value as f64,
            Number::Signed(value) => value as f64,
            Number::F32(value) => value.into(),
            Number::F64(value) => value,
        }
    }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Number::Unsigned(value) => value.fmt(f),
            Number::Signed(value) => value.fmt(f),
            Number::F32(value) if value.is_nan() => write!(f, "{:#010x}", value.to_bits()),
            Number::F64(value) if value.is_nan() => write!(f, "{:#018x}", value.to_bits()),
            Number::F32(value) => Decimal(*value).fmt(f),
            Number::F64(value) => Decimal(*value).fmt(f),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_shown_as_they_are_read() {
        let cases: [(NumberType, &str, &[u8]); 9] = [
            (NumberType::U8, "255", &[255]),
            (NumberType::I8, "-1", &[255]),
            (NumberType::I16, "-32768", &[0, 128]),
            (NumberType::U64, "18446744073709551615", &[255; 8]),
            (NumberType::F32, "0.1", &0.1f32.to_le_bytes()),
            (NumberType::F32, "0x7fc00001", &0x7fc0_0001u32.to_le_bytes()),
            (NumberType::F64, "-0", &(-0.0f64).to_le_bytes()),
            (NumberType::F64, "-inf", &f64::NEG_INFINITY.to_le_bytes()),
            (NumberType::F64, "0xfff8000000000000", &(-f64::NAN).to_bits().to_le_bytes()),
        ];
        for (number, text, bytes) in cases {
            let mut read = Vec::new();
            number.parse(text, &mut read).expect("a number of this type");
            assert_eq!(read, bytes, "{text}");
            assert_eq!(number.read(bytes).to_string(), text);
        }
        for (number, text) in [(NumberType::U8, "256"), (NumberType::I64, "1.5"), (NumberType::F64, "nan")] {
            assert_eq!(number.parse(text, &mut Vec::new()), None, "{text}");
        }
    }

    #[test]
    fn codes_and_names_stand_for_types() {
        for (number, name, _) in TYPES {
            assert_eq!(NumberType::from_code(number.code()), Some(number));
            assert_eq!(NumberType::from_name(name), Some(number));
        }
        assert_eq!(NumberType::from_code(0), None);
        assert_eq!(NumberType::from_code(11), None);
    }
}
