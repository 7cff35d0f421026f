//! The fields of point records that points can carry as attributes.
//!
//! Source: LAS specification 1.4 R15, point data record formats 0 to 10, and record 4 of LASF_Spec (extra
//! bytes).

use std::collections::HashSet;

use crate::source::row_plan::{Field, Offer};
use spmesh_stream::model::attributes::{Attribute, NAME_LEN_MAX, NumberType};

/// Length of the description of one extra field.
const DESCRIPTION_LEN: usize = 192;

/// Places in a description.
const NAME: std::ops::Range<usize> = 4..36;
const NO_DATA: usize = 40;
const SCALE: usize = 112;
const OFFSET: usize = 136;

/// Bits of its options.
const HAS_NO_DATA: u8 = 1;
const HAS_SCALE: u8 = 8;
const HAS_OFFSET: u8 = 16;

/// Degrees per step of a scan angle in formats 6 and above.
const ANGLE_STEP: f64 = 0.006;

/// The fields of records of a format, which have `record_len` bytes of which the format itself has `core_len`.
/// `extra` is the record that describes the bytes after these.
pub(crate) fn offers(format: u8, record_len: usize, core_len: usize, extra: Option<&[u8]>) -> Vec<Offer> {
    let mut fields = Fields::default();
    if format < 6 {
        fields.old_core()
    } else {
        fields.new_core()
    }
    match format {
        1 | 3 | 4 | 5 => fields.gps_time(20),
        _ => {}
    }
    match format {
        2 => fields.colour(20),
        3 | 5 => fields.colour(28),
        7 | 8 | 10 => fields.colour(30),
        _ => {}
    }
    if matches!(format, 8 | 10) {
        fields.bytes("nir", NumberType::U16, 36, "NIR");
    }
    fields.extra(core_len, record_len, extra.unwrap_or_default());
    fields.offers
}

#[derive(Default)]
struct Fields {
    offers: Vec<Offer>,
    names: HashSet<String>,
}

impl Fields {
    fn put(&mut self, attribute: Attribute, field: Field) {
        self.names.insert(attribute.name.clone());
        self.offers.push(Offer { attribute, field });
    }

    fn bits(&mut self, name: &str, at: usize, shift: u8, mask: u8, las_name: &str) {
        let attribute = Attribute { las_name: las_name.into(), ..Attribute::new(name, NumberType::U8) };
        self.put(attribute, Field::Bits { at, shift, mask });
    }

    fn bytes(&mut self, name: &str, number: NumberType, at: usize, las_name: &str) {
        let attribute = Attribute { las_name: las_name.into(), ..Attribute::new(name, number) };
        let len = attribute.width();
        self.put(attribute, Field::Bytes { at, len });
    }

    /// The first 20 bytes of formats 0 to 5.
    fn old_core(&mut self) {
        self.bytes("intensity", NumberType::U16, 12, "Intensity");
        self.bits("return_number", 14, 0, 7, "Return Number");
        self.bits("number_of_returns", 14, 3, 7, "Number of Returns");
        self.bits("scan_direction_flag", 14, 6, 1, "Scan Direction Flag");
        self.bits("edge_of_flight_line", 14, 7, 1, "Edge of Flight Line");
        self.bits("classification", 15, 0, 31, "Classification");
        self.bits("class_flags", 15, 5, 7, "Classification Flags");
        let rank = Attribute {
            unit: "degree".into(),
            las_name: "Scan Angle Rank".into(),
            ..Attribute::new("scan_angle_rank", NumberType::I8)
        };
        self.put(rank, Field::Bytes { at: 16, len: 1 });
        self.bytes("user_data", NumberType::U8, 17, "User Data");
        self.bytes("point_source_id", NumberType::U16, 18, "Point Source ID");
    }

    /// The first 30 bytes of formats 6 to 10.
    fn new_core(&mut self) {
        self.bytes("intensity", NumberType::U16, 12, "Intensity");
        self.bits("return_number", 14, 0, 15, "Return Number");
        self.bits("number_of_returns", 14, 4, 15, "Number of Returns");
        self.bits("class_flags", 15, 0, 15, "Classification Flags");
        self.bits("scanner_channel", 15, 4, 3, "Scanner Channel");
        self.bits("scan_direction_flag", 15, 6, 1, "Scan Direction Flag");
        self.bits("edge_of_flight_line", 15, 7, 1, "Edge of Flight Line");
        self.bytes("classification", NumberType::U8, 16, "Classification");
        self.bytes("user_data", NumberType::U8, 17, "User Data");
        let angle = Attribute {
            unit: "degree".into(),
            las_name: "Scan Angle".into(),
            scale: Some([ANGLE_STEP, 0.0]),
            ..Attribute::new("scan_angle", NumberType::I16)
        };
        self.put(angle, Field::Bytes { at: 18, len: 2 });
        self.bytes("point_source_id", NumberType::U16, 20, "Point Source ID");
        self.gps_time(22);
    }

    fn gps_time(&mut self, at: usize) {
        let time = Attribute {
            unit: "second".into(),
            las_name: "GPS Time".into(),
            ..Attribute::new("gps_time", NumberType::F64)
        };
        self.put(time, Field::Bytes { at, len: 8 });
    }

    fn colour(&mut self, at: usize) {
        let colour = Attribute {
            components: 3,
            las_name: "Red, Green, Blue".into(),
            ..Attribute::new("rgb", NumberType::U16)
        };
        self.put(colour, Field::Bytes { at, len: 6 });
    }

    /// The bytes from `at` to `end`, of which `descriptions` tell; the rest are bytes without a meaning.
    fn extra(&mut self, mut at: usize, end: usize, descriptions: &[u8]) {
        for description in descriptions.chunks_exact(DESCRIPTION_LEN) {
            let Some(attributes) = described(description) else { break };
            if attributes.iter().map(Attribute::width).sum::<usize>() > end - at {
                break;
            }
            for attribute in attributes {
                let len = attribute.width();
                let name = self.unused_name(&attribute.name);
                self.put(Attribute { name, ..attribute }, Field::Bytes { at, len });
                at += len;
            }
        }
        if let Ok(components @ 1..) = u8::try_from(end - at) {
            let name = self.unused_name("extra_bytes");
            let rest = Attribute { components, ..Attribute::new(name, NumberType::U8) };
            self.put(rest, Field::Bytes { at, len: end - at });
        }
    }

    /// A name like this one that no field has.
    fn unused_name(&self, name: &str) -> String {
        let name = if name.is_empty() { "extra" } else { name };
        let numbered = (2..).map(|number| format!("{name}_{number}"));
        let unused =
            std::iter::once(name.to_string()).chain(numbered).find(|name| !self.names.contains(name));
        unused.unwrap_or_default()
    }
}

/// The field that a description tells of; `None` if it is unknown. An array whose components have different
/// scales, offsets or unknown values is several fields, called `name_1`, `name_2` and so on.
fn described(description: &[u8]) -> Option<Vec<Attribute>> {
    let (kind, options) = (description[2], description[3]);
    let name = description[NAME].split(|&byte| byte == 0).next().unwrap_or_default();
    let name: String = String::from_utf8_lossy(name).chars().filter(|char| !char.is_control()).collect();
    let name = name.trim().to_string();
    debug_assert!(name.len() <= NAME_LEN_MAX / 2);
    let (number, components) = match kind {
        // As many bytes as the options say.
        0 if options > 0 => (NumberType::U8, options),
        1..=30 => (NumberType::from_code((kind - 1) % 10 + 1)?, (kind - 1) / 10 + 1),
        _ => return None,
    };
    let array = Attribute { components, las_name: name.clone(), ..Attribute::new(&name, number) };
    if kind == 0 {
        return Some(vec![array]);
    }
    let parts: Vec<Attribute> =
        (0..usize::from(components)).map(|part| scaled(&array, part, description)).collect();
    if parts.iter().all(|part| *part == parts[0]) {
        return Some(parts[..1].to_vec());
    }
    let single = |(number, part): (usize, Attribute)| Attribute {
        name: format!("{}_{}", if name.is_empty() { "extra" } else { &name }, number + 1),
        components: 1,
        ..part
    };
    Some(parts.into_iter().enumerate().map(single).collect())
}

/// The array with the scale, the offset and the unknown value that a description states for one component.
fn scaled(array: &Attribute, component: usize, description: &[u8]) -> Attribute {
    let (options, at) = (description[3], 8 * component);
    let float =
        |field: usize| f64::from_le_bytes(*description[field + at..].first_chunk().expect("eight bytes"));
    let scale = if options & HAS_SCALE != 0 { float(SCALE) } else { 1.0 };
    let offset = if options & HAS_OFFSET != 0 { float(OFFSET) } else { 0.0 };
    let is_scaled = options & (HAS_SCALE | HAS_OFFSET) != 0;
    let is_valid = scale != 0.0 && scale.is_finite() && offset.is_finite();
    let has_unknown = options & HAS_NO_DATA != 0;
    Attribute {
        scale: (is_scaled && is_valid).then_some([scale, offset]),
        unknown: if has_unknown { no_data(array.number, &description[NO_DATA + at..]) } else { None },
        ..array.clone()
    }
}

/// The number of this type that is stored as one of 64 bits; `None` if it is none of the type.
fn no_data(number: NumberType, bytes: &[u8]) -> Option<Vec<u8>> {
    let wide: [u8; 8] = *bytes.first_chunk()?;
    let signed = i64::from_le_bytes(wide);
    let narrow = wide[..number.width()].to_vec();
    match number {
        NumberType::F32 => Some((f64::from_le_bytes(wide) as f32).to_le_bytes().to_vec()),
        NumberType::F64 => Some(wide.to_vec()),
        NumberType::U8 | NumberType::U16 | NumberType::U32 | NumberType::U64 => {
            wide[number.width()..].iter().all(|&byte| byte == 0).then_some(narrow)
        }
        NumberType::I8 => i8::try_from(signed).ok().map(|_| narrow),
        NumberType::I16 => i16::try_from(signed).ok().map(|_| narrow),
        NumberType::I32 => i32::try_from(signed).ok().map(|_| narrow),
        NumberType::I64 => Some(narrow),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn description(kind: u8, options: u8, name: &str) -> Vec<u8> {
        let mut bytes = vec![0; DESCRIPTION_LEN];
        (bytes[2], bytes[3]) = (kind, options);
        bytes[NAME][..name.len()].copy_from_slice(name.as_bytes());
        bytes[NO_DATA..][..8].copy_from_slice(&(-1i64).to_le_bytes());
        bytes[SCALE..][..8].copy_from_slice(&0.5f64.to_le_bytes());
        bytes
    }

    #[test]
    fn extra_bytes_have_their_descriptions() {
        let all = [
            description(4, HAS_NO_DATA | HAS_SCALE, "height"),
            description(13, 0, "intensity"),
            description(0, 3, ""),
            description(10, 0, "too long"),
        ];
        let offers = offers(0, 20 + 2 + 4 + 3 + 2, 20, Some(&all.concat()));
        let extra = &offers[offers.len() - 4..];
        let found: Vec<_> = extra
            .iter()
            .map(|Offer { attribute, field }| (attribute.name.as_str(), attribute.components, field.clone()))
            .collect();
        assert_eq!(
            found,
            [
                ("height", 1, Field::Bytes { at: 20, len: 2 }),
                ("intensity_2", 2, Field::Bytes { at: 22, len: 4 }),
                ("extra", 3, Field::Bytes { at: 26, len: 3 }),
                ("extra_bytes", 2, Field::Bytes { at: 29, len: 2 }),
            ]
        );
        assert_eq!(extra[0].attribute.scale, Some([0.5, 0.0]));
        assert_eq!(extra[0].attribute.unknown, Some(vec![255, 255]));
    }

    #[test]
    fn fields_fit_the_records_of_each_format() {
        for (format, len) in (0..).zip([20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67]) {
            for Offer { attribute, field } in offers(format, len, len, None) {
                let end = match field {
                    Field::Bytes { at, len } => at + len,
                    Field::Bits { at, .. } => at + 1,
                };
                assert!(end <= len, "format {format}: {}", attribute.name);
            }
        }
    }
}
