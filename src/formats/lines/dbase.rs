//! The table beside a Shapefile (`.dbf`), of which few columns have a meaning here.
//!
//! Source: dBASE III, as the ESRI Shapefile Technical Description, 1998, uses it: records of text of fixed
//! length, in the order of the shapes.

use std::fs::File;
use std::io::{BufReader, ErrorKind, Read};
use std::path::Path;

use crate::lines::Properties;
use spmesh_base::error::{Error, Result};
use spmesh_base::inputs;

const HEADER_LEN: usize = 32;
const FIELD_LEN: usize = 32;
/// Ends the list of fields.
const FIELDS_END: u8 = 0x0d;
/// First byte of a record that was deleted, and whose place is not yet used again.
const DELETED: u8 = b'*';

/// A column: its name, and its bytes in a record.
struct Column {
    name: String,
    bytes: std::ops::Range<usize>,
}

/// A table that is read record by record.
pub(crate) struct Table {
    name: String,
    /// Number of its records.
    pub(crate) len: u64,
    input: BufReader<File>,
    columns: Vec<Column>,
    record: Vec<u8>,
    /// The properties of a record that states none.
    none: Properties,
}

impl Table {
    /// The table beside a Shapefile; `None` if there is none. `none` are the properties of a record that
    /// states none.
    pub(crate) fn beside(path: &Path, none: Properties) -> Result<Option<Table>> {
        let Some((file, beside)) = inputs::open_beside(path, &["dbf", "DBF"])? else { return Ok(None) };
        let name = beside.display().to_string();
        let table = Table::read_header(BufReader::new(file), name.clone(), none);
        table.map(Some).map_err(|error| error.of_input(name))
    }

    fn read_header(mut input: BufReader<File>, name: String, none: Properties) -> Result<Table> {
        let mut header = [0; HEADER_LEN];
        fill(&mut input, &mut header)?;
        let number = |at: usize| usize::from(u16::from_le_bytes([header[at], header[at + 1]]));
        let (header_len, record_len) = (number(8), number(10));
        let len = (number(4) | number(6) << 16) as u64;
        let mut fields = vec![0; header_len.saturating_sub(HEADER_LEN)];
        fill(&mut input, &mut fields)?;
        let (mut columns, mut start) = (Vec::new(), 1);
        for field in fields.chunks_exact(FIELD_LEN).take_while(|field| field[0] != FIELDS_END) {
            let bytes = start..start + usize::from(field[16]);
            start = bytes.end;
            let name: Vec<u8> = field[..11].iter().copied().take_while(|&byte| byte != 0).collect();
            let name = String::from_utf8_lossy(&name).into_owned();
            if none.clone().of_name(&name).is_some() {
                columns.push(Column { name, bytes });
            }
        }
        if start > record_len.max(1) {
            let message = format!("fields of {start} bytes in records of {record_len}");
            return Err(Error::malformed(message));
        }
        Ok(Table { name, len, input, columns, record: vec![0; record_len], none })
    }

    /// The properties of the next record; `None` if it was deleted, and its shape with it.
    pub(crate) fn next(&mut self) -> Result<Option<Properties>> {
        fill(&mut self.input, &mut self.record).map_err(|error| error.of_input(&self.name))?;
        if self.record.first() == Some(&DELETED) {
            return Ok(None);
        }
        let mut found = self.none.clone();
        for column in &self.columns {
            let text = text(&self.record[column.bytes.clone()]);
            let text = text.trim_matches([' ', '\0']);
            // Asterisks stand for a number that is not known.
            let is_known = !text.is_empty() && !text.bytes().all(|byte| byte == b'*');
            if let Some(property) = found.of_name(&column.name) {
                *property = is_known.then(|| text.to_string());
            }
        }
        Ok(Some(found))
    }
}

/// Text of any code page: different bytes stay different.
fn text(bytes: &[u8]) -> String {
    str::from_utf8(bytes)
        .map_or_else(|_| bytes.iter().map(|&byte| char::from(byte)).collect(), str::to_string)
}

fn fill(input: &mut impl Read, bytes: &mut [u8]) -> Result<()> {
    input.read_exact(bytes).map_err(|error| match error.kind() {
        ErrorKind::UnexpectedEof => Error::malformed("the table of attributes is cut off: copy it again"),
        _ => Error::io("reading", error),
    })
}
