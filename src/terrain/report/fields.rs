//! What points carry that a report counts.

use spmesh_stream::model::attributes::{Attributes, Column};

/// The attributes that a report asks for, as LAS files and tables of them call these.
pub const ATTRIBUTES: [&str; 4] = ["classification", "point_source_id", "return_number", "number_of_returns"];

/// Where the attributes are in rows.
#[derive(Debug)]
pub(super) struct Fields {
    pub(super) class: Option<Column>,
    pub(super) source: Option<Column>,
    /// Number of the return, and of all returns of its pulse.
    pub(super) returns: Option<[Column; 2]>,
}

/// What a point carries. A point that does not say which return it is counts as the only one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Carried {
    pub(super) class: Option<u8>,
    pub(super) source: Option<u16>,
    pub(super) is_first: bool,
    pub(super) is_last: bool,
    pub(super) is_single: bool,
}

impl Fields {
    pub(super) fn of(attributes: &Attributes) -> Fields {
        let [class, source, number, count] = ATTRIBUTES.map(|name| attributes.column(name).ok());
        Fields { class, source, returns: number.zip(count).map(|(number, count)| [number, count]) }
    }

    /// What the point of a row carries. Numbers that are no integers of the type are unknown.
    pub(super) fn read(&self, rows: &[u8], point: usize) -> Carried {
        let value = |column: &Column| column.of(rows, point);
        let byte = |value: f64| Some(value as u8).filter(|&byte| f64::from(byte) == value);
        let word = |value: f64| Some(value as u16).filter(|&word| f64::from(word) == value);
        let known = |value: f64| if value.is_nan() { 1.0 } else { value };
        let [number, count] = self
            .returns
            .as_ref()
            .map_or([1.0; 2], |columns| columns.each_ref().map(|column| known(value(column))));
        Carried {
            class: self.class.as_ref().and_then(|column| byte(value(column))),
            source: self.source.as_ref().and_then(|column| word(value(column))),
            is_first: number <= 1.0,
            is_last: number >= count || number == 0.0,
            is_single: count <= 1.0,
        }
    }
}
