//! The format of tables.

use std::path::Path;

use clap::ValueEnum;

use crate::tess3::Product;
use spmesh_base::error::{Error, Result};
use spmesh_formats::sink::TableFormat;

/// Endings of tables. Lines of JSON are no JSON, and tabs no commas, so `.json` and `.csv` are none of them.
pub(super) const ENDINGS: &[&str] = &["tsv", "txt", "xyz", "jsonl", "ndjson", "parquet"];

/// Values of `--format`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum TableFlag {
    Tsv,
    Jsonl,
    Parquet,
}

impl From<TableFlag> for TableFormat {
    fn from(flag: TableFlag) -> Self {
        match flag {
            TableFlag::Tsv => TableFormat::Tsv,
            TableFlag::Jsonl => TableFormat::JsonLines,
            TableFlag::Parquet => TableFormat::Parquet,
        }
    }
}

/// The format that `--format` asks for, or else the ending of the output.
pub(super) fn format(
    flag: Option<TableFlag>,
    output: Option<&Path>,
    product: Product,
) -> Result<TableFormat> {
    if !product.is_table() {
        let message = "--format goes with tables: --table, --contacts, --sasa, --volumes, --ses, \
                       --contact-areas or --pockets";
        return if flag.is_some() { Err(Error::usage(message)) } else { Ok(TableFormat::default()) };
    }
    let of_ending = output.and_then(TableFormat::of);
    match (flag.map(TableFormat::from), of_ending, output) {
        (Some(flag), Some(ending), Some(output)) if flag != ending => {
            let (flag, ending) = (flag.ending(), ending.ending());
            let message = format!("the name is that of {ending}, but --format is {flag}: change one of them");
            Err(Error::usage(message).of_input(output.display().to_string()))
        }
        (flag, ending, _) => Ok(flag.or(ending).unwrap_or_default()),
    }
}
