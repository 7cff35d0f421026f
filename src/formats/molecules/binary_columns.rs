//! Columns of BinaryCIF: bytes behind a list of encodings, the last of which is undone first.
//!
//! Source: the specification of BinaryCIF 0.3 (molstar/BinaryCIF, encoding.md).

use std::io::Write;

use crate::molecules::decimal::Number;
use crate::molecules::msgpack::Value;
use spmesh_base::error::{Error, Result};

/// A column of a category.
#[derive(Debug)]
pub(crate) struct BinaryColumn<'b> {
    values: Values<'b>,
    /// For each row 0 if it has a value, else 1 or 2; empty if all have.
    mask: Vec<i64>,
}

#[derive(Debug)]
enum Values<'b> {
    Integers(Vec<i64>),
    /// Integers in steps of a power of ten with so many decimal places.
    Decimals(Vec<i64>, usize),
    Numbers(Vec<f64>),
    /// f32, which are written with as few digits as tell them apart.
    Short(Vec<f32>),
    Strings {
        texts: &'b str,
        offsets: Vec<i64>,
        indices: Vec<i64>,
    },
}

impl<'b> BinaryColumn<'b> {
    /// Decodes a column of so many rows.
    pub(crate) fn read(column: &Value<'b>, rows: usize) -> Result<BinaryColumn<'b>> {
        let data = column.get("data").ok_or_else(|| Error::malformed("the column has no data"))?;
        let values = decode(data, rows)?;
        let mask = match column.get("mask") {
            None | Some(Value::Nothing) => Vec::new(),
            Some(mask) => integers(decode(mask, rows)?)?,
        };
        let len = values.len();
        if len != rows || !(mask.is_empty() || mask.len() == rows) {
            return Err(Error::malformed(format!("found {len} values, expected {rows}")));
        }
        Ok(BinaryColumn { values, mask })
    }

    /// Whether a row has a value.
    pub(crate) fn has(&self, row: usize) -> bool {
        self.mask.get(row).is_none_or(|&mask| mask == 0)
    }

    /// Replaces a text by that of a row.
    pub(crate) fn text(&self, row: usize, text: &mut Vec<u8>) -> Result<()> {
        text.clear();
        match &self.values {
            Values::Integers(values) => write!(text, "{}", values[row]).expect("a vector takes all"),
            Values::Strings { texts, offsets, indices } => {
                // A negative index stands for the empty text.
                let Ok(index) = usize::try_from(indices[row]) else { return Ok(()) };
                let offset = |at: usize| usize::try_from(*offsets.get(at)?).ok();
                let found =
                    offset(index).zip(offset(index + 1)).and_then(|(start, end)| texts.get(start..end));
                let found =
                    found.ok_or_else(|| Error::malformed("a text lies beyond those of the column"))?;
                text.extend_from_slice(found.as_bytes());
            }
            _ => write!(text, "{}", self.number(row).map_or(f64::NAN, Number::value))
                .expect("a vector takes all"),
        }
        Ok(())
    }

    /// The number of a row, if it is finite.
    pub(crate) fn number(&self, row: usize) -> Option<Number> {
        const DIGITS_MAX: u64 = 1_000_000_000_000_000;
        let decimal = |value: i64, places| match value.unsigned_abs() < DIGITS_MAX {
            true => Number::Decimal { digits: value as f64, places },
            false => Number::Float(value as f64 / 10f64.powi(places as i32)),
        };
        match &self.values {
            Values::Integers(values) => Some(decimal(values[row], 0)),
            Values::Decimals(values, places) => Some(decimal(values[row], *places)),
            Values::Numbers(values) => Number::parse(values[row].to_string().as_bytes()),
            Values::Short(values) => Number::parse(values[row].to_string().as_bytes()),
            Values::Strings { .. } => {
                let mut text = Vec::new();
                self.text(row, &mut text).ok()?;
                Number::parse(&text)
            }
        }
    }
}

impl Values<'_> {
    fn len(&self) -> usize {
        match self {
            Values::Integers(values) | Values::Decimals(values, _) => values.len(),
            Values::Numbers(values) => values.len(),
            Values::Short(values) => values.len(),
            Values::Strings { indices, .. } => indices.len(),
        }
    }
}

/// Undoes the encodings of data. No result may have more than `most` values.
fn decode<'b>(data: &Value<'b>, most: usize) -> Result<Values<'b>> {
    let (encodings, bytes) = (data.items("encoding")?, data.bytes("data")?);
    undo(encodings, bytes, most)
}

fn undo<'b>(encodings: &[Value<'b>], bytes: &'b [u8], most: usize) -> Result<Values<'b>> {
    let Some((last, before)) = encodings.split_last() else {
        return Err(Error::malformed("the data have no encoding"));
    };
    let mut values = match last.text("kind")? {
        "ByteArray" => of_bytes(bytes, last.integer("type")?)?,
        "StringArray" => of_strings(last, bytes, most)?,
        kind => return Err(Error::malformed(format!("found {kind} as the encoding of bytes"))),
    };
    for encoding in before.iter().rev() {
        values = undo_one(encoding, values, most)?;
    }
    Ok(values)
}

fn of_bytes<'b>(bytes: &[u8], kind: i64) -> Result<Values<'b>> {
    macro_rules! words {
        ($kind:ty, $len:literal) => {{
            let (words, rest) = bytes.as_chunks::<$len>();
            if !rest.is_empty() {
                return Err(Error::malformed(format!("found {} bytes for numbers of {}", bytes.len(), $len)));
            }
            words.iter().map(|&word| <$kind>::from_le_bytes(word))
        }};
    }
    Ok(match kind {
        1 => Values::Integers(words!(i8, 1).map(i64::from).collect()),
        2 => Values::Integers(words!(i16, 2).map(i64::from).collect()),
        3 => Values::Integers(words!(i32, 4).map(i64::from).collect()),
        4 => Values::Integers(words!(u8, 1).map(i64::from).collect()),
        5 => Values::Integers(words!(u16, 2).map(i64::from).collect()),
        6 => Values::Integers(words!(u32, 4).map(i64::from).collect()),
        32 => Values::Short(words!(f32, 4).collect()),
        33 => Values::Numbers(words!(f64, 8).collect()),
        _ => return Err(Error::malformed(format!("found {kind} as the type of numbers"))),
    })
}

fn of_strings<'b>(encoding: &Value<'b>, bytes: &'b [u8], most: usize) -> Result<Values<'b>> {
    let texts = encoding.text("stringData")?;
    // Texts differ, so that there are as many as bytes, and an empty one.
    let offsets = undo(encoding.items("offsetEncoding")?, encoding.bytes("offsets")?, texts.len() + 3)?;
    let indices = undo(encoding.items("dataEncoding")?, bytes, most)?;
    Ok(Values::Strings { texts, offsets: integers(offsets)?, indices: integers(indices)? })
}

fn undo_one<'b>(encoding: &Value<'b>, values: Values<'b>, most: usize) -> Result<Values<'b>> {
    let values = integers(values)?;
    let size = || {
        let size = encoding.integer("srcSize")?;
        let found = usize::try_from(size).ok().filter(|&size| size <= most);
        found
            .ok_or_else(|| Error::malformed(format!("found {size} as the number of values, expected {most}")))
    };
    Ok(match encoding.text("kind")? {
        "FixedPoint" => {
            let factor = encoding.number("factor")?;
            match (0..=9).find(|&places| 10f64.powi(places) == factor) {
                Some(places) => Values::Decimals(values, places as usize),
                None => Values::Numbers(values.into_iter().map(|value| value as f64 / factor).collect()),
            }
        }
        "IntervalQuantization" => {
            let (min, max, steps) =
                (encoding.number("min")?, encoding.number("max")?, encoding.number("numSteps")?);
            let step = (max - min) / (steps - 1.0);
            Values::Numbers(values.into_iter().map(|value| min + step * value as f64).collect())
        }
        "Delta" => {
            let mut last = encoding.integer("origin")?;
            let sum = |value: i64| {
                last = last.wrapping_add(value);
                last
            };
            Values::Integers(values.into_iter().map(sum).collect())
        }
        "RunLength" => Values::Integers(runs(&values, size()?)?),
        "IntegerPacking" => {
            let (bits, is_unsigned) =
                (8 * encoding.integer("byteCount")?, encoding.integer("isUnsigned")? != 0);
            if !matches!(bits, 8 | 16) {
                return Err(Error::malformed(format!("found {bits} bits of packed integers")));
            }
            let range = if is_unsigned { (1 << bits) - 1 } else { (1 << (bits - 1)) - 1 };
            let least = if is_unsigned { -1 } else { -range - 1 };
            Values::Integers(unpacked(&values, [least, range], size()?)?)
        }
        kind => return Err(Error::malformed(format!("found {kind} as an encoding of numbers"))),
    })
}

fn integers(values: Values<'_>) -> Result<Vec<i64>> {
    match values {
        Values::Integers(values) => Ok(values),
        _ => Err(Error::malformed("found other data where integers are encoded")),
    }
}

/// Repeats each value as often as the number behind it says.
fn runs(pairs: &[i64], size: usize) -> Result<Vec<i64>> {
    let mut values = Vec::with_capacity(size);
    for &[value, count] in pairs.as_chunks().0 {
        let count = usize::try_from(count).ok().filter(|&count| count <= size - values.len());
        let count = count.ok_or_else(|| wrong_size(size))?;
        values.resize(values.len() + count, value);
    }
    if values.len() < size { Err(wrong_size(size)) } else { Ok(values) }
}

/// Adds up values as long as they are at a limit of their type.
fn unpacked(packed: &[i64], limits: [i64; 2], size: usize) -> Result<Vec<i64>> {
    let mut values = Vec::with_capacity(size.min(packed.len()));
    let mut sum = 0i64;
    for &value in packed {
        sum = sum.wrapping_add(value);
        if !limits.contains(&value) {
            values.push(std::mem::take(&mut sum));
        }
    }
    if values.len() == size { Ok(values) } else { Err(wrong_size(size)) }
}

fn wrong_size(size: usize) -> Error {
    Error::malformed(format!("the encoded values are not {size}, as their encoding states"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An encoding with these entries.
    fn encoding(kind: &'static str, entries: &[(&'static str, f64)]) -> Value<'static> {
        let number = |&(key, value): &(&'static str, f64)| (Value::Text(key), Value::Number(value));
        let kind = (Value::Text("kind"), Value::Text(kind));
        Value::Map(std::iter::once(kind).chain(entries.iter().map(number)).collect())
    }

    fn integers_of(encoding: &Value<'_>, values: &[i64], most: usize) -> Result<Vec<i64>> {
        undo_one(encoding, Values::Integers(values.to_vec()), most).and_then(integers)
    }

    /// The examples of the specification.
    #[test]
    fn encodings_are_those_of_the_specification() {
        let runs = encoding("RunLength", &[("srcSize", 6.0)]);
        assert_eq!(integers_of(&runs, &[1, 3, 2, 1, 3, 2], 6).unwrap(), [1, 1, 1, 2, 3, 3]);
        let delta = encoding("Delta", &[("origin", 1000.0)]);
        assert_eq!(integers_of(&delta, &[0, 3, 2, 1], 4).unwrap(), [1000, 1003, 1005, 1006]);
        let packing = |size, is_unsigned| {
            encoding("IntegerPacking", &[("srcSize", size), ("byteCount", 1.0), ("isUnsigned", is_unsigned)])
        };
        assert_eq!(integers_of(&packing(4.0, 0.0), &[1, 2, -3, 127, 1], 4).unwrap(), [1, 2, -3, 128]);
        assert_eq!(integers_of(&packing(2.0, 0.0), &[-128, -128, 0, 5], 2).unwrap(), [-256, 5]);
        assert_eq!(integers_of(&packing(2.0, 1.0), &[255, 0, 7], 2).unwrap(), [255, 7]);
        let steps = encoding("IntervalQuantization", &[("min", 1.0), ("max", 2.0), ("numSteps", 3.0)]);
        let numbers = undo_one(&steps, Values::Integers(vec![0, 0, 1, 2, 2, 1]), 6).unwrap();
        assert!(matches!(numbers, Values::Numbers(found) if found == [1.0, 1.0, 1.5, 2.0, 2.0, 1.5]));
        let fixed = undo_one(&encoding("FixedPoint", &[("factor", 100.0)]), Values::Integers(vec![120]), 1);
        let fixed = BinaryColumn { values: fixed.unwrap(), mask: Vec::new() };
        assert_eq!(fixed.number(0), Some(Number::Decimal { digits: 120.0, places: 2 }));
        let strings = Values::Strings { texts: "aAB", offsets: vec![0, 1, 3], indices: vec![0, 1, 0, -1, 7] };
        let (strings, mut text) = (BinaryColumn { values: strings, mask: vec![0, 0, 0, 2, 0] }, Vec::new());
        for (row, expected) in ["a", "AB", "a", ""].iter().enumerate() {
            strings.text(row, &mut text).unwrap();
            assert_eq!(text, expected.as_bytes());
        }
        assert!(strings.has(2) && !strings.has(3) && strings.text(4, &mut text).is_err());
    }

    #[test]
    fn sizes_are_not_trusted() {
        for (values, most) in [(&[1, 4_000_000_000][..], 10), (&[1, 5], 10), (&[1, -1], 10), (&[1, 6], 5)] {
            assert!(integers_of(&encoding("RunLength", &[("srcSize", 6.0)]), values, most).is_err());
        }
        let shorts = of_bytes(&1.234f32.to_le_bytes(), 32).unwrap();
        let shorts = BinaryColumn { values: shorts, mask: Vec::new() };
        assert_eq!(shorts.number(0), Some(Number::Decimal { digits: 1234.0, places: 3 }));
        assert!(of_bytes(&[0; 5], 3).is_err() && of_bytes(&[0; 4], 7).is_err());
    }
}
