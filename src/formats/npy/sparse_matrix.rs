//! Sparse matrices, as `scipy.io.mmread` and `scipy.sparse.load_npz` read them.

use std::io::Write;
use std::path::Path;

use rawzip::{ZipArchiveWriter, ZipDataWriter};

use crate::npy::write::{NPY_F64, npy_header};
use crate::sink::spool::Spool;
use crate::sink::write_error;
use spmesh_base::error::{Error, Result};

/// Formats of sparse matrices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MatrixFormat {
    /// MatrixMarket: text, `coordinate real general`, with indices from 1.
    MatrixMarket,
    /// The arrays of a matrix in compressed rows (CSR), in a zip archive of numpy. They are not compressed.
    Npz,
}

/// A sparse matrix, which is given row by row.
///
/// Both formats state the number of entries before the entries, so the rows wait in temporary files. Memory:
/// buffers. Disk: 12 bytes per entry and 8 per row, beside the output.
pub struct SparseRows {
    rows: u64,
    columns: u64,
    entries: u64,
    /// The number of entries in all rows up to each, a u64.
    ends: Spool,
    /// Columns, a u32 each.
    places: Spool,
    /// An f64 each.
    values: Spool,
}

impl SparseRows {
    /// A matrix without rows. Temporary files are in `temp_dir`, or in the system's folder.
    ///
    /// # Errors
    /// If the files cannot be created.
    pub fn new(columns: u64, temp_dir: Option<&Path>) -> Result<SparseRows> {
        let spool = || Spool::new(temp_dir);
        let (ends, places, values) = (spool()?, spool()?, spool()?);
        Ok(SparseRows { rows: 0, columns, entries: 0, ends, places, values })
    }

    /// Number of entries so far.
    pub fn entries(&self) -> u64 {
        self.entries
    }

    /// Appends a row: columns in increasing order with their values. Zeros are left out.
    ///
    /// # Errors
    /// If a temporary file cannot be written.
    pub fn push(&mut self, row: &[(u32, f64)]) -> Result<()> {
        for &(column, value) in row.iter().filter(|(_, value)| *value != 0.0) {
            self.places.bytes(&column.to_le_bytes())?;
            self.values.bytes(&value.to_le_bytes())?;
            self.entries += 1;
        }
        self.rows += 1;
        self.ends.bytes(&self.entries.to_le_bytes())
    }

    /// Writes the matrix.
    ///
    /// # Errors
    /// If writing fails.
    pub fn finish(self, format: MatrixFormat, output: &mut impl Write) -> Result<()> {
        match format {
            MatrixFormat::MatrixMarket => self.write_text(output),
            MatrixFormat::Npz => self.write_arrays(output),
        }
    }

    fn write_text(mut self, output: &mut impl Write) -> Result<()> {
        let SparseRows { rows, columns, entries, .. } = self;
        let head = format!("%%MatrixMarket matrix coordinate real general\n{rows} {columns} {entries}\n");
        output.write_all(head.as_bytes()).map_err(write_error)?;
        let (mut ends, mut places) = (self.ends.records()?, self.places.records()?);
        let (mut values, mut done) = (self.values.records()?, 0);
        for row in 1..=rows {
            let end = u64::from_le_bytes(ends.next()?);
            for _ in done..end {
                let column = u64::from(u32::from_le_bytes(places.next()?)) + 1;
                let value = f64::from_le_bytes(values.next()?);
                writeln!(output, "{row} {column} {value:e}").map_err(write_error)?;
            }
            done = end;
        }
        Ok(())
    }

    /// Writes the arrays that `scipy.sparse.save_npz` writes, in its order.
    fn write_arrays(mut self, output: &mut impl Write) -> Result<()> {
        let SparseRows { rows, columns, entries, .. } = self;
        // Both arrays of indices must have one type.
        let is_narrow = [rows, columns, entries].iter().all(|&count| count <= i32::MAX as u64);
        let index = if is_narrow { "<i4" } else { "<i8" };
        let mut archive = ZipArchiveWriter::new(output);
        let (mut places, mut ends) = (self.places.records()?, self.ends.records()?);
        array(&mut archive, "indices", index, &[entries], |numbers| {
            (0..entries).try_for_each(|_| put(numbers, u32::from_le_bytes(places.next()?).into(), is_narrow))
        })?;
        array(&mut archive, "indptr", index, &[rows + 1], |numbers| {
            put(numbers, 0, is_narrow)?;
            (0..rows).try_for_each(|_| put(numbers, u64::from_le_bytes(ends.next()?), is_narrow))
        })?;
        array(&mut archive, "format", "|S3", &[], |text| text.write_all(b"csr").map_err(write_error))?;
        array(&mut archive, "shape", "<i8", &[2], |numbers| {
            put(numbers, rows, false)?;
            put(numbers, columns, false)
        })?;
        array(&mut archive, "data", NPY_F64, &[entries], |mut numbers| self.values.copy_to(&mut numbers))?;
        archive.finish().map_err(zip_error)?.flush().map_err(write_error)
    }
}

/// Adds an array, whose numbers `write` writes, to an archive.
fn array<W: Write>(
    archive: &mut ZipArchiveWriter<W>,
    name: &str,
    dtype: &str,
    shape: &[u64],
    write: impl FnOnce(&mut dyn Write) -> Result<()>,
) -> Result<()> {
    let (mut entry, config) = archive.new_file(format!("{name}.npy")).start().map_err(zip_error)?;
    let mut data: ZipDataWriter<_> = config.wrap(&mut entry);
    data.write_all(&npy_header(dtype, shape)).map_err(write_error)?;
    write(&mut data)?;
    let (_, descriptor) = data.finish().map_err(zip_error)?;
    entry.finish(descriptor).map_err(zip_error).map(drop)
}

/// Writes an index.
fn put(numbers: &mut dyn Write, index: u64, is_narrow: bool) -> Result<()> {
    let bytes = index.to_le_bytes();
    numbers.write_all(if is_narrow { &bytes[..4] } else { &bytes }).map_err(write_error)
}

fn zip_error(error: rawzip::Error) -> Error {
    write_error(match error.into_kind() {
        rawzip::ErrorKind::IO(error) => error,
        other => std::io::Error::other(rawzip::Error::from(other)),
    })
}
