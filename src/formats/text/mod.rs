//! Lines of numbers: columns, their options, and values.

pub(crate) mod columns;
pub(crate) mod copy;
pub(crate) mod decimal_grid;
pub(crate) mod labelled;
pub(crate) mod lines;
pub(crate) mod numbers;
pub(crate) mod options;
pub(crate) mod read;
pub(crate) mod values;
pub(crate) mod words;
