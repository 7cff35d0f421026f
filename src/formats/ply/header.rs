//! The header of PLY: encoding, elements, and the properties of each.

use std::io::Read;

use crate::raw::byte_order::ByteOrder;
use crate::raw::sample::SampleType;
use crate::text::lines::Lines;
use crate::twin::tokens::{expect_no_field, fields, next_field, parse_integer, unexpected};
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::PLY_ITEMS_MAX;
use spmesh_stream::model::attributes::{Attribute, Attributes, with_usable_names};

/// How the values are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Encoding {
    Ascii,
    Binary(ByteOrder),
}

/// The meaning of an element's property here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    /// Coordinate of a vertex: 0, 1 or 2.
    Axis(usize),
    /// Vertices of a face.
    Corners,
    /// Vertices of triangle strips, with -1 between strips.
    Strips,
    /// Length of a list.
    Length,
    /// A single number of a vertex that is none of its coordinates, or of a face.
    Attribute,
    /// Anything else: skipped.
    Other,
}

/// A property of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Property {
    pub(crate) role: Role,
    /// For a list, the type of its length.
    pub(crate) length: Option<SampleType>,
    pub(crate) scalar: SampleType,
}

/// The type of an element's rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sort {
    Vertex,
    Face,
    /// Triangle strips.
    Strip,
    Other,
}

/// An element of the header, with its rows.
#[derive(Debug, Clone)]
pub(crate) struct ElementTable {
    pub(crate) sort: Sort,
    pub(crate) rows: u64,
    pub(crate) properties: Vec<Property>,
    /// The names of the properties.
    pub(crate) names: Vec<String>,
}

/// Encoding, and the elements in the order of the file.
#[derive(Debug, Clone)]
pub(crate) struct PlyHeader {
    pub(crate) encoding: Encoding,
    pub(crate) tables: Vec<ElementTable>,
}

impl PlyHeader {
    /// Reads up to `end_header`.
    pub(crate) fn read<R: Read>(lines: &mut Lines<R>) -> Result<PlyHeader> {
        match lines.next_line()? {
            Some(b"ply") => {}
            found => return Err(unexpected(found.unwrap_or_default(), "\"ply\"")),
        }
        let (mut encoding, mut tables, mut items) = (None, Vec::new(), 0);
        loop {
            let Some(line) = lines.next_line()? else {
                return Err(Error::malformed("truncated: the header ends without end_header"));
            };
            items += 1;
            let mut fields = fields(line);
            match fields.next().unwrap_or_default() {
                b"comment" | b"obj_info" => continue,
                b"format" => encoding = Some(parse_encoding(next_field(&mut fields)?)?),
                b"element" => tables.push(parse_element(&mut fields)?),
                b"property" => {
                    let table =
                        tables.last_mut().ok_or_else(|| Error::malformed("property of no element"))?;
                    let (property, name) = parse_property(&mut fields, table.sort)?;
                    table.properties.push(property);
                    table.names.push(name);
                }
                b"end_header" => break,
                other => return Err(unexpected(other, "a statement of a PLY header")),
            }
            if items > PLY_ITEMS_MAX {
                return Err(Error::malformed(format!("header of more than {PLY_ITEMS_MAX} lines")));
            }
        }
        let encoding = encoding.ok_or_else(|| Error::malformed("the header does not state the format"))?;
        let header = PlyHeader { encoding, tables };
        header.check()?;
        Ok(header)
    }

    /// The attributes of vertices.
    pub(crate) fn attributes(&self) -> std::result::Result<Attributes, String> {
        self.attributes_of(Sort::Vertex)
    }

    /// The attributes of vertices or of faces. Red, green and blue in this order are one attribute.
    pub(crate) fn attributes_of(&self, sort: Sort) -> std::result::Result<Attributes, String> {
        let mut attributes: Vec<Attribute> = Vec::new();
        for table in self.tables.iter().filter(|table| table.sort == sort) {
            let properties = table.properties.iter().zip(&table.names);
            let singles = properties.filter(|(property, _)| property.role == Role::Attribute);
            attributes
                .extend(singles.map(|(property, name)| Attribute::new(name, property.scalar.number_type())));
        }
        if let Some(at) = attributes.windows(3).position(is_colour) {
            let number = attributes[at].number;
            let colour = Attribute { components: 3, ..Attribute::new("rgb", number) };
            attributes.splice(at..at + 3, [colour]);
        }
        Attributes::new(with_usable_names(attributes))
    }

    /// Number of rows of a type.
    pub(crate) fn rows(&self, sort: Sort) -> u64 {
        self.tables
            .iter()
            .filter(|table| table.sort == sort)
            .fold(0, |sum, table| sum.saturating_add(table.rows))
    }

    fn check(&self) -> Result<()> {
        let vertices: Vec<&ElementTable> =
            self.tables.iter().filter(|table| table.sort == Sort::Vertex).collect();
        let [vertex] = vertices[..] else {
            return Err(Error::malformed(format!("{} elements called vertex, expected 1", vertices.len())));
        };
        let has = |role: Role| vertex.properties.iter().filter(|property| property.role == role).count() == 1;
        if !(0..3).all(|axis| has(Role::Axis(axis))) {
            return Err(Error::malformed("vertices without properties x, y and z"));
        }
        for table in self.tables.iter().filter(|table| table.rows > 0) {
            let is_list = |property: &&Property| matches!(property.role, Role::Corners | Role::Strips);
            let lists = table.properties.iter().filter(is_list).count();
            if matches!(table.sort, Sort::Face | Sort::Strip) && lists != 1 {
                let what = if table.sort == Sort::Face { "faces" } else { "strips" };
                return Err(Error::malformed(format!(
                    "{what} with {lists} lists vertex_indices, expected 1"
                )));
            }
            // Rows of zero bytes could be stated 2^64 - 1 times and would never end.
            if table.properties.is_empty() {
                return Err(Error::malformed(format!("{} rows of no properties", table.rows)));
            }
        }
        Ok(())
    }
}

fn is_colour(attributes: &[Attribute]) -> bool {
    let names = attributes.iter().map(|attribute| attribute.name.as_str());
    names.eq(["red", "green", "blue"])
        && attributes.iter().all(|attribute| attribute.number == attributes[0].number)
}

fn parse_type(name: &[u8]) -> Result<SampleType> {
    match name {
        b"char" | b"int8" => Ok(SampleType::I8),
        b"uchar" | b"uint8" => Ok(SampleType::U8),
        b"short" | b"int16" => Ok(SampleType::I16),
        b"ushort" | b"uint16" => Ok(SampleType::U16),
        b"int" | b"int32" => Ok(SampleType::I32),
        b"uint" | b"uint32" => Ok(SampleType::U32),
        b"float" | b"float32" => Ok(SampleType::F32),
        b"double" | b"float64" => Ok(SampleType::F64),
        other => Err(unexpected(other, "a type of PLY")),
    }
}

fn parse_encoding(name: &[u8]) -> Result<Encoding> {
    match name {
        b"ascii" => Ok(Encoding::Ascii),
        b"binary_little_endian" => Ok(Encoding::Binary(ByteOrder::Little)),
        b"binary_big_endian" => Ok(Encoding::Binary(ByteOrder::Big)),
        other => Err(unexpected(other, "a format of PLY")),
    }
}

fn parse_element<'a>(fields: &mut impl Iterator<Item = &'a [u8]>) -> Result<ElementTable> {
    let sort = match next_field(fields)? {
        b"vertex" => Sort::Vertex,
        b"face" => Sort::Face,
        b"tristrips" => Sort::Strip,
        _ => Sort::Other,
    };
    let rows = parse_integer(next_field(fields)?)?;
    expect_no_field(fields)?;
    Ok(ElementTable { sort, rows, properties: Vec::new(), names: Vec::new() })
}

fn parse_property<'a>(fields: &mut impl Iterator<Item = &'a [u8]>, sort: Sort) -> Result<(Property, String)> {
    let first = next_field(fields)?;
    let is_list = first == b"list";
    let length = is_list.then(|| parse_type(next_field(fields)?)).transpose()?;
    let scalar = parse_type(if is_list { next_field(fields)? } else { first })?;
    let name = next_field(fields)?;
    expect_no_field(fields)?;
    let role = match (sort, is_list, name) {
        (Sort::Vertex, false, b"x") => Role::Axis(0),
        (Sort::Vertex, false, b"y") => Role::Axis(1),
        (Sort::Vertex, false, b"z") => Role::Axis(2),
        (Sort::Face, true, b"vertex_indices" | b"vertex_index") => Role::Corners,
        (Sort::Strip, true, b"vertex_indices" | b"vertex_index") => Role::Strips,
        (Sort::Vertex | Sort::Face, false, _) => Role::Attribute,
        _ => Role::Other,
    };
    Ok((Property { role, length, scalar }, String::from_utf8_lossy(name).into_owned()))
}
