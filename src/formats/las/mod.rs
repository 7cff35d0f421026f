//! LAS and LAZ files as they are: their records with all fields, and the same file written again with changed
//! records and one more field. Source: LAS specification 1.4 R15.

pub(crate) mod chunks;
pub(crate) mod copy;
pub(crate) mod field;
pub(crate) mod fields;
pub(crate) mod file;
pub(crate) mod header;
pub(crate) mod index;
pub(crate) mod laz;
pub(crate) mod laz_chunks;
pub(crate) mod laz_codec;
pub(crate) mod laz_salvage;
pub(crate) mod laz_table;
pub(crate) mod raw;
pub(crate) mod records;

pub use copy::{Changes, LasCopy};
pub use field::ExtraField;
pub use file::{LasFile, LasRecords, RecordClasses};
