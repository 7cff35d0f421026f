//! The fields of an NRRD header.

use std::io::Read;

use crate::source::origin::Origin;
use crate::text::lines::{Lines, quote};
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::{NRRD_FILES_MAX, NRRD_HEADER_MAX};

/// Names of fields with their alternative forms, the usual form first.
const KNOWN: [&[&str]; 28] = [
    &["dimension"],
    &["type"],
    &["encoding"],
    &["endian"],
    &["sizes"],
    &["spacings"],
    &["axis mins", "axismins"],
    &["axis maxs", "axismaxs"],
    &["centers", "centerings"],
    &["kinds"],
    &["space"],
    &["space dimension"],
    &["space directions"],
    &["space origin"],
    &["space units"],
    &["measurement frame"],
    &["data file", "datafile"],
    &["line skip", "lineskip"],
    &["byte skip", "byteskip"],
    &["labels"],
    &["units"],
    &["thicknesses"],
    &["content"],
    &["sample units", "sampleunits"],
    &["block size", "blocksize"],
    &["min", "max"],
    &["old min", "oldmin", "old max", "oldmax"],
    &["number"],
];

/// The fields of a header, and where it ends.
#[derive(Debug)]
pub(crate) struct Fields {
    fields: Vec<Field>,
    /// Names of data files, from the lines after `data file: LIST`.
    pub listed: Vec<String>,
    /// Length of the header in bytes, with the empty line.
    pub len: u64,
    /// Whether the file is compressed as a whole.
    pub is_gzip: bool,
    /// Whether an empty line ends the header, so that values may follow.
    pub is_ended: bool,
}

#[derive(Debug)]
pub(crate) struct Field {
    /// The usual form of the field's name.
    name: String,
    description: String,
    line: u64,
    is_known: bool,
}

impl Fields {
    /// Reads the header.
    ///
    /// # Errors
    /// If a line is not part of a header, a field occurs twice, or the header is longer than
    /// [`NRRD_HEADER_MAX`].
    pub(crate) fn read(origin: &Origin) -> Result<Fields> {
        let plain = origin.plain()?;
        let is_gzip = plain.is_compressed();
        let mut fields = Fields { fields: Vec::new(), listed: Vec::new(), len: 0, is_gzip, is_ended: false };
        fields.read_lines(&mut Lines::with_longest(
            plain.take(NRRD_HEADER_MAX + 1),
            "",
            NRRD_HEADER_MAX as usize + 1,
        ))?;
        Ok(fields)
    }

    fn read_lines(&mut self, lines: &mut Lines<impl Read>) -> Result<()> {
        let mut is_list = false;
        loop {
            let is_line = lines.next_line()?.is_some();
            let number = lines.number();
            let at = |e: Error| e.at(format!("line {number}"));
            self.len = lines.bytes();
            if self.len > NRRD_HEADER_MAX {
                let message = format!("the header has more than {NRRD_HEADER_MAX} bytes");
                return Err(at(Error::malformed(message)));
            }
            let text = lines.current();
            if text.is_empty() {
                self.is_ended = is_line;
                return Ok(());
            }
            let Ok(text) = std::str::from_utf8(text) else {
                let message = format!(
                    "found {}, expected a line of text, or the empty line that ends the header",
                    quote(text)
                );
                return Err(at(Error::malformed(message)));
            };
            match text {
                magic if number == 1 => check_magic(magic).map_err(at)?,
                comment if comment.starts_with('#') => {}
                name if is_list => self.listed.push(name.to_string()),
                field => is_list = self.take(field, number).map_err(at)?,
            }
            if self.listed.len() > NRRD_FILES_MAX {
                return Err(at(Error::malformed(format!("more than {NRRD_FILES_MAX} data files"))));
            }
        }
    }

    /// Adds a line. True if the following lines are names of files.
    fn take(&mut self, text: &str, line: u64) -> Result<bool> {
        let found = || {
            Error::malformed(format!("found {}, expected a field: name: description", quote(text.as_bytes())))
        };
        let at = text.find(':').ok_or_else(found)?;
        let (name, rest) = (&text[..at], &text[at + 1..]);
        if rest.starts_with('=') {
            // A key/value pair, which has no meaning in the format.
            return Ok(false);
        }
        let name = name.trim().to_ascii_lowercase();
        let known = KNOWN.iter().find(|forms| forms.contains(&name.as_str()));
        // Rows of minima and maxima, which are not needed here, hold several fields each.
        let is_one = |forms: &&&[&str]| !matches!(forms[0], "min" | "old min");
        let name = known.filter(is_one).map_or(name, |forms| forms[0].to_string());
        if let Some(first) = self.fields.iter().find(|field| field.name == name) {
            return Err(Error::malformed(format!(
                "field {name} is there twice, first in line {}",
                first.line
            )));
        }
        let description = rest.trim().to_string();
        let is_list = name == "data file" && description.split_whitespace().next() == Some("LIST");
        self.fields.push(Field { name, description, line, is_known: known.is_some() });
        Ok(is_list)
    }

    /// The description of the field with this name, if there is one.
    pub(crate) fn get(&self, name: &str) -> Option<&str> {
        self.fields.iter().find(|field| field.name == name).map(|field| field.description.as_str())
    }

    /// Adds line and field to an error about the field with this name.
    pub(crate) fn locate(&self, name: &str, error: Error) -> Error {
        match self.fields.iter().find(|field| field.name == name) {
            Some(field) => error.at(format!("line {}, field {name}", field.line)),
            None => error.at("header"),
        }
    }

    /// The result of `parse` for a field.
    pub(crate) fn parse<T>(&self, name: &str, parse: impl Fn(&str) -> Result<T>) -> Result<T> {
        let text =
            self.get(name).ok_or_else(|| Error::malformed(format!("has no field {name}")).at("header"))?;
        parse(text).map_err(|e| self.locate(name, e))
    }

    /// As [`Fields::parse`], but `default` if the field is missing.
    pub(crate) fn parse_or<T>(&self, name: &str, default: T, parse: impl Fn(&str) -> Result<T>) -> Result<T> {
        self.get(name).map_or(Ok(default), |text| parse(text).map_err(|e| self.locate(name, e)))
    }

    /// A warning for each field that is not part of the format.
    pub(crate) fn unknown(&self) -> impl Iterator<Item = String> {
        let unknown = self.fields.iter().filter(|field| !field.is_known);
        unknown.map(|Field { line, name, .. }| format!("line {line}: unknown field {name} is ignored"))
    }
}

fn check_magic(magic: &str) -> Result<()> {
    let version = magic.trim_end().strip_prefix("NRRD").unwrap_or("");
    match version.strip_prefix("000").and_then(|digit| digit.parse::<u8>().ok()) {
        Some(1..=9) => Ok(()),
        _ if version == "00.01" => Ok(()),
        _ => {
            Err(Error::malformed(format!("found {}, expected NRRD0001 to NRRD0009", quote(magic.as_bytes()))))
        }
    }
}

/// The integer that `text` denotes.
pub(crate) fn integer(text: &str, what: &str) -> Result<u64> {
    let is_integer = text.bytes().all(|byte| byte.is_ascii_digit());
    let number = text.parse().ok().filter(|_| is_integer);
    number.ok_or_else(|| Error::malformed(format!("found {}, expected {what}", quote(text.as_bytes()))))
}
