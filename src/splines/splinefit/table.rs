//! The form of all tables: numbers with blanks between them, after one line of `#` and the names of columns.
//!
//! `numpy.loadtxt` skips this line as a comment, and `numpy.genfromtxt(names=True)` takes the names from it.

use std::io::Write;

use spmesh_base::error::{Error, Result};

/// Writes the line of names.
pub(super) fn write_title<'a>(
    output: &mut (impl Write + ?Sized),
    columns: impl IntoIterator<Item = &'a &'a str>,
) -> Result<()> {
    let names: String = columns.into_iter().map(|name| format!(" {name}")).collect();
    writeln!(output, "#{names}").map_err(write_error)
}

pub(super) fn write_error(error: std::io::Error) -> Error {
    Error::io("writing the table", error)
}
