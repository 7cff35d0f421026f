//! NRRD: a header of lines `field: description`, then the values or the names of the files that hold them
//! (Teem, "Definition of NRRD File Format").
//!
//! Reads volumes of scalars in three or four dimensions, in the encodings raw, gzip and text. The axis of
//! kind `time` is t; without one, a single axis of kind `list`; without that, the fourth axis. The others are
//! x, y and z in the order of the file.

mod axes;
mod fields;
mod files;

use std::path::Path;

use self::fields::Fields;
use crate::raw::byte_order::ByteOrder;
use crate::raw::sample::SampleType;
use crate::source::origin::Origin;
use crate::volumes::data::{Data, Encoding, Skip};
use crate::volumes::volume::{Volume, units_of};
use spmesh_base::error::{Error, Result};

/// Reads the header of a volume; `path` is the file's path, if it has one.
pub(crate) fn open(origin: Origin, path: Option<&Path>, warnings: &mut Vec<String>) -> Result<Volume> {
    let fields = Fields::read(&origin)?;
    warnings.extend(fields.unknown());
    let lattice = axes::lattice(&fields, warnings)?;
    let world = axes::world(&fields);
    let sample = fields.parse("type", parse_type)?;
    let encoding = fields.parse("encoding", |text| parse_encoding(text, &fields, sample))?;
    let line_skip = fields.parse_or("line skip", 0, |text| fields::integer(text, "a number of lines"))?;
    let byte_skip = fields.parse_or("byte skip", Skip::Bytes(0), parse_byte_skip)?;
    let parts = files::parts(&fields, origin, path, lattice.sites())?;
    if byte_skip == Skip::ToEnd
        && (!matches!(encoding, Encoding::Raw(_)) || parts.iter().any(|part| part.is_gzip))
    {
        let message = "-1 is for values that are raw and not compressed only";
        return Err(fields.locate("byte skip", Error::malformed(message)));
    }
    let data = Data { parts, sample, encoding, line_skip, byte_skip, is_exact: false };
    let [lengths, times] = axes::units(&fields)?;
    Ok(Volume { lattice, data, scaling: None, world, units: units_of(lengths, &times) })
}

fn parse_type(text: &str) -> Result<SampleType> {
    Ok(match text.to_ascii_lowercase().as_str() {
        "signed char" | "int8" | "int8_t" => SampleType::I8,
        "uchar" | "unsigned char" | "uint8" | "uint8_t" => SampleType::U8,
        "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => SampleType::I16,
        "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => SampleType::U16,
        "int" | "signed int" | "int32" | "int32_t" => SampleType::I32,
        "uint" | "unsigned int" | "uint32" | "uint32_t" => SampleType::U32,
        "longlong"
        | "long long"
        | "long long int"
        | "signed long long"
        | "signed long long int"
        | "int64"
        | "int64_t" => SampleType::I64,
        "ulonglong" | "unsigned long long" | "unsigned long long int" | "uint64" | "uint64_t" => {
            SampleType::U64
        }
        "float" => SampleType::F32,
        "double" => SampleType::F64,
        _ => {
            let message = format!("found {text:?}, expected an integer type, float or double");
            return Err(Error::malformed(message));
        }
    })
}

fn parse_encoding(text: &str, fields: &Fields, sample: SampleType) -> Result<Encoding> {
    let order = || match fields.get("endian") {
        None if sample.len() == 1 => Ok(ByteOrder::Little),
        None => Err(Error::malformed("values have several bytes, but there is no field endian")),
        Some(order) if order.eq_ignore_ascii_case("little") => Ok(ByteOrder::Little),
        Some(order) if order.eq_ignore_ascii_case("big") => Ok(ByteOrder::Big),
        Some(order) => {
            let message = format!("found {order:?}, expected little or big");
            Err(fields.locate("endian", Error::malformed(message)))
        }
    };
    match text.to_ascii_lowercase().as_str() {
        "raw" => Ok(Encoding::Raw(order()?)),
        "gz" | "gzip" => Ok(Encoding::Gzip(order()?)),
        "txt" | "text" | "ascii" => Ok(Encoding::Text),
        "hex" | "bz2" | "bzip2" => {
            let message =
                format!("encoding {text} is not read: write it as raw or gzip first, as with unu save");
            Err(Error::malformed(message))
        }
        _ => Err(Error::malformed(format!("found {text:?}, expected raw, gzip or text"))),
    }
}

fn parse_byte_skip(text: &str) -> Result<Skip> {
    match text {
        "-1" => Ok(Skip::ToEnd),
        _ => Ok(Skip::Bytes(fields::integer(text, "a number of bytes, or -1")?)),
    }
}
