//! Flags that say how points as text are laid out.

use std::fmt;

use clap::Args;

use spmesh_formats::source::{Column, Separator, TextOptions};

/// How lines of text are laid out.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Points as text")]
pub struct TextFlags {
    /// Columns of x, y and, if there is one, z: numbers counted from 1, or names in the line of names or in the
    /// last comment before the points [default: those called x, y and z, or the first three]
    #[arg(long, value_name = "X,Y[,Z]", value_delimiter = ',')]
    columns: Vec<Column>,

    /// What is between columns: comma, semicolon, tab, space (any white space), or one character [default: as
    /// the first line of points shows]
    #[arg(long, value_name = "SEPARATOR")]
    separator: Option<Separator>,

    /// Skip so many lines at the start of each file
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    skip_lines: u64,

    /// Skip lines that start with PREFIX, as those that start with # or // always are
    #[arg(long, value_name = "PREFIX", allow_hyphen_values = true, value_parser = clap::builder::NonEmptyStringValueParser::new())]
    comment: Option<String>,
}

/// The flags that are given, each after a blank.
impl fmt::Display for TextFlags {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let TextFlags { columns, separator, skip_lines, comment } = self;
        if !columns.is_empty() {
            write!(f, " --columns {columns:?}")?;
        }
        if let Some(separator) = separator {
            write!(f, " --separator {separator:?}")?;
        }
        if *skip_lines > 0 {
            write!(f, " --skip-lines {skip_lines}")?;
        }
        comment.iter().try_for_each(|comment| write!(f, " --comment {comment}"))
    }
}

impl TextFlags {
    /// What the flags ask for.
    pub fn options(&self) -> TextOptions {
        TextOptions {
            columns: self.columns.clone(),
            separator: self.separator,
            skip_lines: self.skip_lines,
            comment: self.comment.clone(),
            needs_z: false,
        }
    }
}
