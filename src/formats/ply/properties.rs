//! Attributes of points as properties of the vertices of a PLY file.

use std::collections::HashSet;

use spmesh_base::error::Result;
use spmesh_stream::model::attributes::{Attribute, Attributes, Number, NumberType};

/// The properties behind x, y and z.
pub(crate) struct Properties {
    lines: String,
    /// Attributes of 64-bit integers, which PLY does not have.
    rounded: Vec<String>,
}

impl Properties {
    pub(crate) fn of(attributes: &Attributes) -> Self {
        let mut names: HashSet<String> = ["x", "y", "z"].map(String::from).into();
        let (mut lines, mut rounded) = (String::new(), Vec::new());
        for attribute in attributes {
            for component in 0..usize::from(attribute.components) {
                let mut name = name_of(attribute, component);
                while !names.insert(name.clone()) {
                    name.push('_');
                }
                lines += &format!("property {} {name}\n", type_of(attribute.number));
            }
            if is_rounded(attribute.number) {
                rounded.push(attribute.name.clone());
            }
        }
        Properties { lines, rounded }
    }

    /// Their lines in the header.
    pub(crate) fn lines(&self) -> &str {
        &self.lines
    }

    /// The notice about attributes that are written as doubles.
    pub(crate) fn rounded(&self) -> Option<String> {
        let names = self.rounded.join(", ");
        (!names.is_empty())
            .then(|| format!("PLY has no integers of 64 bits: {names} rounded to the nearest double"))
    }
}

/// PLY separates words by spaces, and many programs look for the colour under these names.
fn name_of(attribute: &Attribute, component: usize) -> String {
    let name = attribute.name.replace(char::is_whitespace, "_");
    match (name.as_str(), attribute.components) {
        ("rgb", 3) | ("rgba", 4) => ["red", "green", "blue", "alpha"][component].to_string(),
        (_, 1) => name,
        _ => format!("{name}_{component}"),
    }
}

fn type_of(number: NumberType) -> &'static str {
    match number {
        NumberType::U8 => "uchar",
        NumberType::I8 => "char",
        NumberType::U16 => "ushort",
        NumberType::I16 => "short",
        NumberType::U32 => "uint",
        NumberType::I32 => "int",
        NumberType::F32 => "float",
        NumberType::U64 | NumberType::I64 | NumberType::F64 => "double",
    }
}

fn is_rounded(number: NumberType) -> bool {
    matches!(number, NumberType::U64 | NumberType::I64)
}

/// Calls `put` with the numbers of a row.
pub(crate) fn text(
    attributes: &Attributes,
    row: &[u8],
    mut put: impl FnMut(&str) -> Result<()>,
) -> Result<()> {
    for (attribute, place) in attributes.places() {
        for number in attribute.numbers(&row[place]) {
            put(&match number {
                // Readers of PLY know no bits of NaN.
                Number::F32(value) => value.to_string(),
                Number::F64(value) => value.to_string(),
                number if is_rounded(attribute.number) => number.to_f64().to_string(),
                number => number.to_string(),
            })?;
        }
    }
    Ok(())
}

/// Calls `put` with the numbers of a row.
pub(crate) fn bytes(
    attributes: &Attributes,
    row: &[u8],
    mut put: impl FnMut(&[u8]) -> Result<()>,
) -> Result<()> {
    for (attribute, place) in attributes.places() {
        if is_rounded(attribute.number) {
            let mut numbers = attribute.numbers(&row[place]);
            numbers.try_for_each(|number| put(&number.to_f64().to_le_bytes()))?;
        } else {
            put(&row[place])?;
        }
    }
    Ok(())
}
