//! The interface that supplies the point records of a LAS file, compressed or not.

use spmesh_base::error::Result;

/// Supplies point records in their uncompressed form.
pub(crate) trait RecordReader: Send {
    /// Replaces the content of `records` with the next whole records; leaves it empty at the end.
    fn next_records(&mut self, records: &mut Vec<u8>) -> Result<()>;

    /// Number in the file of the first of the last records. They are consecutive, but the next ones need not
    /// follow them.
    fn first(&self) -> u64;
}
