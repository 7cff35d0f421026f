//! Finds the points in a legacy file of VTK, text or big-endian binary.

use std::io;

use crate::raw::byte_order::ByteOrder;
use crate::raw::sample::SampleType;
use crate::source::origin::FileView;
use crate::source::point_arrays::{Place, PointArray};
use crate::text::lines::Lines;
use crate::text::numbers::{Writing, next_number};
use crate::twin::tokens::{expect_no_field, fields, next_field, parse_integer, unexpected};
use spmesh_base::error::{Error, Result};

/// Type of the values of an array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ValueType {
    Number(SampleType),
    /// Numbers of 4 or 8 bytes, the length of `long` on the machine that wrote the file.
    Long,
    /// One bit each, padded to whole bytes.
    Bits,
    Text,
}

/// Reads the statements up to the points, and returns the place of the points. Ignores everything after them.
pub(crate) fn read(file: &FileView, name: &str) -> Result<PointArray> {
    let mut lines = Lines::new(file.clone(), name);
    let (points, sample, writing) = read_statements(&mut lines).map_err(|e| lines.locate(e))?;
    let start = lines.byte();
    let len = PointArray::len_of(points, 3, sample).map_err(|e| lines.locate(e))?;
    let is_text = writing == Writing::Text;
    let end = if is_text { file.len() } else { start.saturating_add(len) };
    if end > file.len() {
        let left = file.len() - start;
        let message = format!("truncated: {points} points have {len} bytes, and {left} are left");
        return Err(lines.locate(Error::malformed(message)));
    }
    Ok(PointArray {
        piece: None,
        points,
        components: 3,
        sample,
        writing,
        place: Place::Plain { start, end },
        is_exact: false,
        data: Vec::new(),
    })
}

/// Number and type of the points; leaves the input at their start.
fn read_statements(lines: &mut Lines<FileView>) -> Result<(u64, SampleType, Writing)> {
    // The first line told the format; the second is a title with any content.
    for _ in 0..2 {
        lines.next_line()?.ok_or_else(truncated)?;
    }
    let writing = match next_words(lines)?[0].as_str() {
        "ascii" => Writing::Text,
        "binary" => Writing::Binary(ByteOrder::Big),
        other => return Err(unexpected(other.as_bytes(), "ASCII or BINARY")),
    };
    loop {
        let words = next_words(lines)?;
        match words[0].as_str() {
            "dataset" => check_dataset(words.get(1).map_or("", String::as_str))?,
            "dimensions" => {}
            "metadata" => skip_metadata(lines)?,
            "field" => skip_field(lines, &words, writing)?,
            "points" => {
                let mut words = words[1..].iter().map(String::as_bytes);
                let points = parse_integer(next_field(&mut words)?)?;
                let kind = next_field(&mut words)?;
                expect_no_field(&mut words)?;
                return Ok((points, number_type(kind, writing)?, writing));
            }
            other => return Err(unexpected(other.as_bytes(), "POINTS")),
        }
    }
}

fn check_dataset(name: &str) -> Result<()> {
    match name {
        "unstructured_grid" | "polydata" | "structured_grid" => Ok(()),
        "structured_points" | "rectilinear_grid" => Err(Error::usage(format!(
            "is a VTK file of a {name}: it lists no points, which lie on a lattice"
        ))),
        other => Err(unexpected(other.as_bytes(), "UNSTRUCTURED_GRID, POLYDATA or STRUCTURED_GRID")),
    }
}

/// The words of the next line that is not blank, in lower case; at least one.
fn next_words(lines: &mut Lines<FileView>) -> Result<Vec<String>> {
    loop {
        let line = lines.next_line()?.ok_or_else(truncated)?;
        let words: Vec<String> =
            fields(line).map(|word| String::from_utf8_lossy(word).to_ascii_lowercase()).collect();
        if !words.is_empty() {
            return Ok(words);
        }
    }
}

/// Skips the metadata that VTK adds to an array, which ends with a blank line.
fn skip_metadata(lines: &mut Lines<FileView>) -> Result<()> {
    while !lines.next_line()?.ok_or_else(truncated)?.trim_ascii().is_empty() {}
    Ok(())
}

/// Skips `FIELD name count` and its `count` arrays.
fn skip_field(lines: &mut Lines<FileView>, words: &[String], writing: Writing) -> Result<()> {
    let arrays = words
        .get(2)
        .map_or(Err(Error::malformed("FIELD without a count")), |count| parse_integer(count.as_bytes()))?;
    for _ in 0..arrays {
        let mut words = next_words(lines)?;
        // The metadata belongs to the array before.
        while words[0] == "metadata" {
            skip_metadata(lines)?;
            words = next_words(lines)?;
        }
        let mut words = words[1..].iter().map(String::as_bytes);
        let components = parse_integer(next_field(&mut words)?)?;
        let tuples = parse_integer(next_field(&mut words)?)?;
        let kind = next_field(&mut words)?;
        let values = components.checked_mul(tuples);
        let values = values.ok_or_else(|| Error::malformed(format!("{tuples} times {components} values")))?;
        skip_values(lines, values, value_type(kind)?, writing)?;
    }
    Ok(())
}

fn skip_values(lines: &mut Lines<FileView>, values: u64, kind: ValueType, writing: Writing) -> Result<()> {
    let bytes = match (kind, writing) {
        (ValueType::Text, Writing::Text) => {
            return (0..values).try_for_each(|_| lines.next_line()?.map(|_| ()).ok_or_else(truncated));
        }
        (_, Writing::Text) => {
            let mut number = Vec::new();
            return (0..values).try_for_each(|_| {
                next_number(lines.input(), &mut number)?;
                if number.is_empty() { Err(truncated()) } else { Ok(()) }
            });
        }
        (ValueType::Text, Writing::Binary(_)) => {
            return (0..values).try_for_each(|_| skip_binary_text(lines));
        }
        (ValueType::Number(sample), _) => values.checked_mul(sample.len() as u64),
        (ValueType::Bits, _) => Some(values.div_ceil(8)),
        (ValueType::Long, _) => return Err(ambiguous()),
    };
    skip_bytes(lines, bytes.ok_or_else(truncated)?)
}

/// Skips a text and the length before it: two bits for the number of bytes of the length, then the length,
/// big-endian.
fn skip_binary_text(lines: &mut Lines<FileView>) -> Result<()> {
    let mut bytes = [0; 8];
    read_bytes(lines, &mut bytes[..1])?;
    let len_len = 1 << (3 - (bytes[0] >> 6));
    bytes[0] &= 0x3f;
    read_bytes(lines, &mut bytes[1..len_len])?;
    let len = bytes[..len_len].iter().fold(0, |len: u64, &byte| len << 8 | u64::from(byte));
    skip_bytes(lines, len)
}

fn read_bytes(lines: &mut Lines<FileView>, bytes: &mut [u8]) -> Result<()> {
    io::Read::read_exact(lines.input(), bytes).map_err(|e| match e.kind() {
        io::ErrorKind::UnexpectedEof => truncated(),
        _ => Error::io("reading", e),
    })
}

fn skip_bytes(lines: &mut Lines<FileView>, bytes: u64) -> Result<()> {
    let mut skipped = io::Read::take(lines.input(), bytes);
    let found = io::copy(&mut skipped, &mut io::sink()).map_err(|e| Error::io("reading", e))?;
    if found < bytes { Err(truncated()) } else { Ok(()) }
}

/// The type of coordinates.
fn number_type(name: &[u8], writing: Writing) -> Result<SampleType> {
    match (value_type(name)?, writing) {
        (ValueType::Number(sample), _) => Ok(sample),
        (ValueType::Long, Writing::Text) => Ok(SampleType::I64),
        (ValueType::Long, Writing::Binary(_)) => Err(ambiguous()),
        (ValueType::Bits | ValueType::Text, _) => Err(unexpected(name, "a type of coordinates")),
    }
}

fn value_type(name: &[u8]) -> Result<ValueType> {
    Ok(ValueType::Number(match name {
        b"char" | b"signed_char" => SampleType::I8,
        b"unsigned_char" => SampleType::U8,
        b"short" => SampleType::I16,
        b"unsigned_short" => SampleType::U16,
        // VTK writes identifiers as int, whatever their type in memory.
        b"int" | b"vtkidtype" => SampleType::I32,
        b"unsigned_int" => SampleType::U32,
        b"vtktypeint64" => SampleType::I64,
        b"vtktypeuint64" => SampleType::U64,
        b"float" => SampleType::F32,
        b"double" => SampleType::F64,
        b"long" | b"unsigned_long" => return Ok(ValueType::Long),
        b"bit" => return Ok(ValueType::Bits),
        b"string" | b"utf8_string" => return Ok(ValueType::Text),
        other => return Err(unexpected(other, "a type of VTK")),
    }))
}

fn ambiguous() -> Error {
    Error::usage(
        "binary values of type long have 4 or 8 bytes, the file does not tell: write it as text, or as VTU",
    )
}

fn truncated() -> Error {
    Error::malformed("truncated: the file ends before its points")
}
