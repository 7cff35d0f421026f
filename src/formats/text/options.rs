//! How lines of text are read, if the user says so.

use std::io::Read;
use std::str::FromStr;

use crate::text::lines::Lines;
use crate::text::read::{Delimiter, without_comment};
use spmesh_base::error::Result;

/// How points in text are laid out, as far as the text does not tell.
#[derive(Debug, Clone, Default)]
pub struct TextOptions {
    /// The columns of x, y and, if points have one, z.
    pub columns: Vec<Column>,
    /// What is between fields.
    pub separator: Option<Separator>,
    /// Number of lines before the text proper.
    pub skip_lines: u64,
    /// Lines that start with this are comments, as are those that start with `#` or `//`.
    pub comment: Option<String>,
    /// Whether points need a value in the third place.
    pub needs_z: bool,
}

impl TextOptions {
    /// Whether the user said anything.
    pub(crate) fn is_given(&self) -> bool {
        let TextOptions { columns, separator, skip_lines, comment, needs_z: _ } = self;
        !columns.is_empty() || separator.is_some() || *skip_lines > 0 || comment.is_some()
    }

    /// Reads the lines before the text proper.
    pub(crate) fn skip(&self, lines: &mut Lines<impl Read>) -> Result<()> {
        for _ in 0..self.skip_lines {
            if lines.next_line()?.is_none() {
                break;
            }
        }
        Ok(())
    }

    /// What a line says without comments.
    pub(crate) fn content<'a>(&self, line: &'a [u8]) -> &'a [u8] {
        match &self.comment {
            Some(start) if line.starts_with(start.as_bytes()) => &[],
            _ => without_comment(line),
        }
    }

    /// What a comment says; `None` if the line is no comment.
    pub(crate) fn comment<'a>(&self, line: &'a [u8]) -> Option<&'a [u8]> {
        let start = self.comment.as_deref().unwrap_or("#");
        let rest = [start, "#", "//"].into_iter().find_map(|start| line.strip_prefix(start.as_bytes()))?;
        let marks = rest.iter().take_while(|&&byte| byte == b'#' || byte == b'/').count();
        Some(rest[marks..].trim_ascii())
    }
}

/// A column of a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Column {
    /// Its number, counted from 1.
    Number(usize),
    /// Its name in the line of names.
    Name(String),
}

impl FromStr for Column {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Column, String> {
        match text.trim() {
            "" => Err("the name of a column is missing".to_string()),
            "0" => Err("columns are counted from 1".to_string()),
            text => Ok(text.parse().map_or_else(|_| Column::Name(text.to_string()), Column::Number)),
        }
    }
}

/// What is between the fields of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Separator(pub(crate) Delimiter);

impl FromStr for Separator {
    type Err = String;

    /// `comma`, `semicolon`, `tab`, `space` (any white space), or one character.
    fn from_str(text: &str) -> std::result::Result<Separator, String> {
        Ok(Separator(match text {
            "comma" => Delimiter::Byte(b','),
            "semicolon" => Delimiter::Byte(b';'),
            "tab" => Delimiter::Byte(b'\t'),
            "space" | " " => Delimiter::WhiteSpace,
            _ => match text.as_bytes() {
                [byte] if byte.is_ascii() && !byte.is_ascii_alphanumeric() => Delimiter::Byte(*byte),
                _ => {
                    let expected = "expected comma, semicolon, tab, space or one character";
                    return Err(format!("{text:?} is no separator, {expected}"));
                }
            },
        }))
    }
}
