//! A LAS or LAZ file, opened for reading its records.

use laz::DecompressionSelection;

use crate::las::header::{LasHeader, RECORD_LENS};
use crate::las::laz::LazRecords;
use crate::source::filters::Filters;
use crate::source::origin::{FileView, Origin};
use crate::source::record_filter::RecordFilter;
use crate::source::record_reader::RecordReader;
use crate::source::records::PlainRecords;
use spmesh_base::error::Result;
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
    /// Reads the header of a file that is not compressed as a whole. It is called `name` in messages.
    pub(crate) fn of(origin: Origin, name: String, mut notices: Vec<String>) -> Result<LasFile> {
        let mut own = Vec::new();
        let header = origin.view().and_then(|view| LasHeader::read(&view, false, &mut own));
        let header = header.map_err(|e| e.of_input(&name))?;
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

    /// The classes of its records, and which of them filters keep. The interval of z is not looked at.
    pub fn classes(&self, filters: &Filters) -> RecordClasses {
        let format = self.header.format;
        RecordClasses { is_extended: format >= 6, filter: RecordFilter::new(filters, format) }
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

/// The classes of the records of a file.
pub struct RecordClasses {
    is_extended: bool,
    filter: RecordFilter,
}

impl RecordClasses {
    /// Whether the filters keep a record.
    pub fn keeps(&self, record: &[u8]) -> bool {
        self.filter.reason(record).is_none()
    }

    /// Sets the class of a record, and leaves the flags beside it as they are. Domain: at most 31 in point
    /// formats 0 to 5, which have five bits for it.
    pub fn set(&self, record: &mut [u8], class: u8) {
        if self.is_extended {
            record[16] = class;
        } else {
            debug_assert!(class < 32);
            record[15] = record[15] & 0xe0 | class & 0x1f;
        }
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
