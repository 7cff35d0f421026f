//! LAS and LAZ files as they are: their records with all fields, and the same file written again with changed
//! records and one more field. Source: LAS specification 1.4 R15.

mod chunks;
mod copy;
mod field;
mod file;
mod records;

pub use copy::{Changes, LasCopy};
pub use field::ExtraField;
pub use file::{LasFile, LasRecords};
