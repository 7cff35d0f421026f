//! The attributes of points as a record of the header.

use super::header::Header;
use super::header_code::Fault;
use crate::model::attributes::{Attribute, Attributes, NumberType};

const FLAG_SCALE: u8 = 1;
const FLAG_UNKNOWN: u8 = 2;

pub(super) fn encode_attributes(header: &Header) -> Option<Vec<u8>> {
    if header.attributes.is_empty() {
        return None;
    }
    let mut bytes = Vec::new();
    for attribute in &header.attributes {
        encode(attribute, &mut bytes);
    }
    Some(bytes)
}

fn encode(attribute: &Attribute, bytes: &mut Vec<u8>) {
    let Attribute { name, number, components, unit, las_name, scale, unknown } = attribute;
    let flag = |is_set: bool, flag: u8| if is_set { flag } else { 0 };
    let flags = flag(scale.is_some(), FLAG_SCALE) | flag(unknown.is_some(), FLAG_UNKNOWN);
    bytes.extend([number.code(), *components, flags]);
    for text in [name, unit, las_name] {
        // The header was checked: no text is longer than 255 bytes.
        bytes.push(text.len() as u8);
        bytes.extend_from_slice(text.as_bytes());
    }
    scale.iter().flatten().for_each(|number| bytes.extend_from_slice(&number.to_le_bytes()));
    unknown.iter().for_each(|number| bytes.extend_from_slice(number));
}

pub(super) fn decode_attributes(header: &mut Header, payload: &[u8]) -> Result<(), Fault> {
    if payload.is_empty() {
        return Err("no attribute is listed".into());
    }
    let (mut rest, mut attributes) = (payload, Vec::new());
    while !rest.is_empty() {
        attributes.push(decode(&mut rest)?);
    }
    header.attributes = Attributes::new(attributes)?;
    Ok(())
}

fn decode(rest: &mut &[u8]) -> Result<Attribute, Fault> {
    let head = take(rest, 3)?;
    let code = head[0];
    let number =
        NumberType::from_code(code).ok_or(format!("type {code} of an attribute, expected 1 to 10"))?;
    let flags = head[2];
    if flags & !(FLAG_SCALE | FLAG_UNKNOWN) != 0 {
        return Err(format!("flags {flags:#04x} of an attribute, of which all bits but 0 and 1 must be 0"));
    }
    let mut text = || {
        let len = take(rest, 1)?[0];
        String::from_utf8(take(rest, len.into())?.to_vec()).map_err(|_| "a text is not UTF-8".to_string())
    };
    let (name, unit, las_name) = (text()?, text()?, text()?);
    let mut float =
        || Ok::<_, Fault>(f64::from_le_bytes(*take(rest, 8)?.first_chunk().expect("eight bytes")));
    let scale = if flags & FLAG_SCALE != 0 { Some([float()?, float()?]) } else { None };
    let unknown = if flags & FLAG_UNKNOWN != 0 { Some(take(rest, number.width())?.to_vec()) } else { None };
    Ok(Attribute { name, number, components: head[1], unit, las_name, scale, unknown })
}

/// The next `len` bytes.
fn take<'a>(rest: &mut &'a [u8], len: usize) -> Result<&'a [u8], Fault> {
    let (bytes, after) = rest.split_at_checked(len).ok_or("it ends within an attribute")?;
    *rest = after;
    Ok(bytes)
}
