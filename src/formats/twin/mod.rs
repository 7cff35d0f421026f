//! The text twin of a stream (`formats/text.md`).

pub(crate) mod header;
pub(crate) mod read;
pub(crate) mod read4;
pub(crate) mod read_configurations;
pub(crate) mod read_functions;
pub(crate) mod regions;
pub(crate) mod rows;
pub(crate) mod statements;
pub(crate) mod tokens;
pub(crate) mod write;
pub(crate) mod write4;
pub(crate) mod write_configurations;
pub(crate) mod write_constraints;
pub(crate) mod write_functions;
