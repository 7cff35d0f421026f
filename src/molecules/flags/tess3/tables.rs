//! The format of tables.

use std::path::Path;

use crate::tess3::Product;
use spmesh_base::error::{Error, Result};
use spmesh_formats::sink::TableFormat;
use spmesh_shell::Names;

/// Values of `--format`.
pub(super) const NAMES: Names<TableFormat> =
    &[("tsv", TableFormat::Tsv), ("jsonl", TableFormat::JsonLines), ("parquet", TableFormat::Parquet)];

/// The format that `--format` asks for, or else the ending of the output.
pub(super) fn format(
    flag: Option<TableFormat>,
    output: Option<&Path>,
    product: Product,
) -> Result<TableFormat> {
    if !product.is_table() {
        let message = "--format goes with tables: --table, --contacts, --sasa, --volumes, --ses, \
                       --contact-areas, --buried-areas, --pockets or --cells";
        return if flag.is_some() { Err(Error::usage(message)) } else { Ok(TableFormat::default()) };
    }
    let of_ending = output.and_then(TableFormat::of);
    match (flag, of_ending, output) {
        (Some(flag), Some(ending), Some(output)) if flag != ending => {
            let (flag, ending) = (flag.ending(), ending.ending());
            let message = format!("the name is that of {ending}, but --format is {flag}: change one of them");
            Err(Error::usage(message).of_input(output.display().to_string()))
        }
        (flag, ending, _) => Ok(flag.or(ending).unwrap_or_default()),
    }
}
