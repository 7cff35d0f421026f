//! A LAS or LAZ file, opened for reading its records.

use std::path::{Path, PathBuf};

use laz::DecompressionSelection;

use crate::detect::{Format, SPHEIGHT, read_head};
use crate::las::header::{LasHeader, RECORD_LENS};
use crate::las::laz::LazRecords;
use crate::source::name_of;
use crate::source::origin::{Admitted, FileView, Origin};
use crate::source::record_reader::RecordReader;
use crate::source::records::PlainRecords;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::Bounds;
use spmesh_stream::{Coordinates, Crs};

/// A LAS, LAZ or COPC file.
#[derive(Debug)]
pub struct LasFile {
    name: String,
    origin: Origin,
    pub(crate) header: LasHeader,
    notices: Vec<String>,
}

impl LasFile {
    /// Opens the file at `path` ("-" is stdin) and reads its header.
    ///
    /// Cost: the header. Stdin, and files within gzip, are copied to an unlinked temporary file in
    /// `temp_dir`, or in the system's folder for temporary files.
    ///
    /// # Errors
    /// If the file cannot be opened, is of another format, or its header is damaged; the file is named.
    pub fn open(path: &Path, temp_dir: Option<&Path>) -> Result<LasFile> {
        let name = name_of(path);
        let temp_dir = temp_dir.map_or_else(std::env::temp_dir, PathBuf::from);
        let mut notices = Vec::new();
        let mut origin = Origin::new(path, Admitted::Formats(&SPHEIGHT), &temp_dir, &mut notices)?;
        let mut read = || -> Result<(LasHeader, Vec<String>)> {
            let mut plain = origin.plain()?;
            let head = read_head(&mut plain).map_err(|e| Error::io("reading", e))?;
            let format = SPHEIGHT.detect(&head)?;
            debug_assert_eq!(format, Format::Las);
            if plain.is_compressed() {
                origin = origin.unpacked(&name, &temp_dir, &mut notices)?;
            }
            let mut own = Vec::new();
            let header = LasHeader::read(&origin.view()?, false, &mut own)?;
            Ok((header, own))
        };
        let (header, own) = read().map_err(|e| e.of_input(&name))?;
        notices.extend(own.into_iter().map(|notice| format!("{name}: {notice}")));
        Ok(LasFile { name, origin, header, notices })
    }

    /// Its name in messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Scale and offset of its points.
    pub fn coordinates(&self) -> &Coordinates {
        &self.header.coordinates
    }

    /// The coordinate reference system that it states.
    pub fn crs(&self) -> &Crs {
        &self.header.crs
    }

    /// The box of its points that it states, in world coordinates; `None` if it makes no sense. It is not
    /// verified.
    pub fn stated_bounds(&self) -> Option<Bounds> {
        let Bounds { min, max } = self.header.bounds?;
        Some(Bounds { min: self.coordinates().to_world(min), max: self.coordinates().to_world(max) })
    }

    /// Number of its points.
    pub fn points(&self) -> u64 {
        self.header.points
    }

    /// Bytes of a point record.
    pub fn record_len(&self) -> usize {
        self.header.record_len
    }

    /// Whether its points are compressed.
    pub fn is_compressed(&self) -> bool {
        self.header.laz.is_some()
    }

    /// Oddities that the user should know.
    pub fn notices(&self) -> &[String] {
        &self.notices
    }

    /// Bytes of a point record that its format states; extra bytes follow them.
    pub(crate) fn core_len(&self) -> usize {
        RECORD_LENS[usize::from(self.header.format)]
    }

    pub(crate) fn view(&self) -> Result<FileView> {
        self.origin.view()
    }

    /// Starts a pass over all records; `threads` decompress them.
    ///
    /// Memory: one group of chunks for each thread.
    ///
    /// # Errors
    /// If the file cannot be opened, or its chunks contradict its header.
    pub fn records(&self, threads: usize) -> Result<LasRecords> {
        let open = || -> Result<Box<dyn RecordReader>> {
            let (view, header) = (self.view()?, &self.header);
            Ok(match &header.laz {
                Some(laszip) => {
                    let all = DecompressionSelection::all();
                    Box::new(LazRecords::new(view, header, laszip, threads, all)?)
                }
                None => Box::new(PlainRecords::new(view, header)),
            })
        };
        let reader = open().map_err(|e| e.of_input(&self.name))?;
        Ok(LasRecords { reader, name: self.name.clone() })
    }
}

/// The records of a file, in its order.
pub struct LasRecords {
    reader: Box<dyn RecordReader>,
    name: String,
}

impl LasRecords {
    /// Replaces the content of `records` with the next whole records, uncompressed; leaves it empty at the
    /// end.
    ///
    /// # Errors
    /// If reading fails, or compressed records are damaged; the file and the byte are named.
    pub fn next(&mut self, records: &mut Vec<u8>) -> Result<()> {
        self.reader.next_records(records).map_err(|e| e.of_input(&self.name))
    }
}
