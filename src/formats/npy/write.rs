//! Arrays of numpy: what `numpy.load` reads.

use std::io::Write;
use std::path::Path;

use crate::sink::spool::Spool;
use crate::sink::write_error;
use spmesh_base::error::Result;

/// The numbers of an array start at a multiple of this, so that it can be mapped into memory.
const ALIGNMENT: usize = 64;
/// The type of f64, little-endian.
pub const NPY_F64: &str = "<f8";

/// The header of an array in C order.
pub fn npy_header(dtype: &str, shape: &[u64]) -> Vec<u8> {
    let numbers: Vec<String> = shape.iter().map(u64::to_string).collect();
    let comma = if shape.len() == 1 { "," } else { "" };
    let shape = format!("({}{comma})", numbers.join(", "));
    let mut text = format!("{{'descr': '{dtype}', 'fortran_order': False, 'shape': {shape}, }}");
    const START: &[u8] = b"\x93NUMPY\x01\x00";
    let len = START.len() + 2 + text.len() + 1;
    text += &" ".repeat(len.next_multiple_of(ALIGNMENT) - len);
    text.push('\n');
    let text_len = u16::try_from(text.len()).expect("shapes have a few numbers");
    [START, &text_len.to_le_bytes(), text.as_bytes()].concat()
}

/// An array whose number of rows is known at the end only. The rows wait in a temporary file.
pub struct NpyRows {
    columns: usize,
    rows: u64,
    spool: Spool,
}

impl NpyRows {
    /// An array of rows of f64, in a temporary file in `temp_dir` or in the system's folder.
    ///
    /// # Errors
    /// If the file cannot be created.
    pub fn new(columns: usize, temp_dir: Option<&Path>) -> Result<NpyRows> {
        Ok(NpyRows { columns, rows: 0, spool: Spool::new(temp_dir)? })
    }

    /// Appends a row of as many numbers as there are columns.
    ///
    /// # Errors
    /// If the temporary file cannot be written.
    pub fn push(&mut self, row: &[f64]) -> Result<()> {
        debug_assert_eq!(row.len(), self.columns);
        self.rows += 1;
        row.iter().try_for_each(|number| self.spool.bytes(&number.to_le_bytes()))
    }

    /// Writes the array: of shape (rows,) with one column, and of shape (rows, columns) with several.
    ///
    /// # Errors
    /// If writing fails.
    pub fn finish(mut self, output: &mut impl Write) -> Result<()> {
        let shape = [self.rows, self.columns as u64];
        let shape = if self.columns == 1 { &shape[..1] } else { &shape[..] };
        output.write_all(&npy_header(NPY_F64, shape)).map_err(write_error)?;
        self.spool.copy_to(output)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_are_aligned_and_say_the_shape() {
        for (shape, text) in [
            (&[][..], "'shape': (), }"),
            (&[7], "'shape': (7,), }"),
            (&[u64::MAX, 3, 2], "'shape': (18446744073709551615, 3, 2), }"),
        ] {
            let header = npy_header(NPY_F64, shape);
            assert_eq!(header.len() % ALIGNMENT, 0);
            assert_eq!(usize::from(u16::from_le_bytes([header[8], header[9]])) + 10, header.len());
            assert!(String::from_utf8_lossy(&header).contains(text) && header.ends_with(b"\n"));
        }
    }
}
