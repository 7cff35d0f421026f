//! One table of the rows of all files of a sweep. The output of each file is a part of it, so that a sweep
//! can be resumed; when all are done, parts become the table, in the order of the files.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::Sweep;
use crate::tess3::job::table_columns;
use spmesh_base::error::Result;
use spmesh_base::output::Output;
use spmesh_formats::ledger::Ledger;
use spmesh_formats::sink::{TableFormat, TableSink};

/// The one table of a sweep, while its parts are made.
pub(super) struct Whole<'s> {
    sweep: &'s Sweep,
    table: TableSink,
    /// The part of each file that is done, relative to the folder.
    parts: HashMap<PathBuf, PathBuf>,
}

impl<'s> Whole<'s> {
    /// The table, if one is wanted. Fails before the work if it cannot be written, or would replace a file of
    /// the sweep.
    pub(super) fn new(
        sweep: &'s Sweep,
        format: TableFormat,
        path: &Path,
        ledger: &Ledger<'_>,
    ) -> Result<Self> {
        ledger.check_free(path)?;
        let columns = table_columns(&sweep.options);
        let table = TableSink::create(format, columns, Output::create(path, true)?);
        // Files of earlier sweeps that are not among those of this one do not matter.
        let parts = ledger.outputs().map(|(file, part)| (file.to_path_buf(), part)).collect();
        Ok(Whole { sweep, table, parts })
    }

    /// A file is done.
    pub(super) fn add(&mut self, file: &Path, part: PathBuf) {
        self.parts.insert(file.to_path_buf(), part);
    }

    /// Writes the table. Files that failed have no rows.
    pub(super) fn write(mut self) -> Result<()> {
        let files = self.sweep.batch.files.iter();
        for part in files.filter_map(|file| self.parts.get(file)) {
            self.table.append_part(&self.sweep.batch.folder.join(part))?;
        }
        self.table.commit()
    }
}
