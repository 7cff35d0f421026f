//! Attributes of points in a text twin: their lines in the header, and the rows of points.

use crate::twin::tokens::{expect_no_field, fields, next_field, parse_decimal, parse_integer, unexpected};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::attributes::{Attribute, Attributes, NumberType};

/// The attribute that a line of the header states.
pub(crate) fn parse_attribute(line: &[u8]) -> Result<Attribute> {
    let mut rest = line;
    let name = take_string(&mut rest)?;
    let mut values = fields(rest);
    let (number, components) = (next_field(&mut values)?, next_field(&mut values)?);
    let number = std::str::from_utf8(number)
        .ok()
        .and_then(NumberType::from_name)
        .ok_or_else(|| unexpected(number, "a type such as u16 or f64"))?;
    let components = u8::try_from(parse_integer(components)?)
        .map_err(|_| unexpected(components, "at most 255 components"))?;
    rest = after_fields(rest, 2);
    let (unit, las_name) = (take_string(&mut rest)?, take_string(&mut rest)?);
    let mut values = fields(rest);
    let scale = match (next_field(&mut values)?, next_field(&mut values)?) {
        (b"-", b"-") => None,
        (scale, offset) => Some([parse_decimal(scale)?, parse_decimal(offset)?]),
    };
    let unknown = match next_field(&mut values)? {
        b"-" => None,
        field => {
            let mut bytes = Vec::new();
            parse_number(number, field, &mut bytes)?;
            Some(bytes)
        }
    };
    expect_no_field(&mut values)?;
    Ok(Attribute { name, number, components, unit, las_name, scale, unknown })
}

/// The row that a line states.
pub(crate) fn parse_row<'a>(
    fields: &mut impl Iterator<Item = &'a [u8]>,
    attributes: &Attributes,
) -> Result<Vec<u8>> {
    let mut row = Vec::with_capacity(attributes.row_len());
    for attribute in attributes {
        for _ in 0..attribute.components {
            parse_number(attribute.number, next_field(fields)?, &mut row)?;
        }
    }
    Ok(row)
}

/// Appends a stored number.
fn parse_number(number: NumberType, field: &[u8], bytes: &mut Vec<u8>) -> Result<()> {
    let text = std::str::from_utf8(field).ok();
    text.and_then(|text| number.parse(text, bytes))
        .ok_or_else(|| unexpected(field, &format!("a number of type {}", number.name())))
}

/// Takes a JSON string from the front.
fn take_string(rest: &mut &[u8]) -> Result<String> {
    let mut values = serde_json::Deserializer::from_slice(rest).into_iter::<String>();
    match values.next() {
        Some(Ok(text)) => {
            *rest = &rest[values.byte_offset()..];
            Ok(text)
        }
        Some(Err(_)) => Err(unexpected(rest, "a JSON string")),
        None => Err(Error::malformed("the line ends early: a field is missing")),
    }
}

/// The rest of a line behind its first `count` fields.
fn after_fields(line: &[u8], count: usize) -> &[u8] {
    let is_space = |byte: &u8| matches!(byte, b' ' | b'\t');
    (0..count).fold(line, |rest, _| {
        let start = rest.iter().position(|byte| !is_space(byte)).unwrap_or(rest.len());
        let end = rest[start..].iter().position(is_space).map_or(rest.len(), |len| start + len);
        &rest[end..]
    })
}
