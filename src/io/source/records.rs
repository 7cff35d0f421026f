//! Points from the records of LAS files, compressed or not.

use super::las_header::LasHeader;
use super::laz::LazRecords;
use super::options::SourceOptions;
use super::origin::FileView;
use super::pass::{BATCH_POINTS, Pass};
use super::placement::Placement;
use super::record_reader::RecordReader;
use super::row_plan::RowPlan;
use spmesh_core::error::{Error, Result};
use spmesh_model::bounds::Point;

/// Bytes of records read at once from an uncompressed file.
const READ_LEN: usize = 1 << 18;

/// Which records to keep.
#[derive(Debug, Clone)]
pub(super) struct RecordFilter {
    keep: [bool; 256],
    first_only: bool,
    last_only: bool,
    is_extended: bool,
}

impl RecordFilter {
    pub(super) fn new(options: &SourceOptions, format: u8) -> Self {
        let mut keep = [options.keep_class.is_empty(); 256];
        options.keep_class.iter().for_each(|&class| keep[usize::from(class)] = true);
        options.drop_class.iter().for_each(|&class| keep[usize::from(class)] = false);
        RecordFilter {
            keep,
            first_only: options.first_only,
            last_only: options.last_only,
            is_extended: format >= 6,
        }
    }

    /// Whether the filter keeps every record.
    fn wants_all(&self) -> bool {
        !self.first_only && !self.last_only && self.keep.iter().all(|&keep| keep)
    }

    /// Whether to keep `record`. Formats 0 to 5 have 5 bits for the class and 3 for each return number,
    /// formats 6 to 10 have 8 and 4. A return number of 0 means none: it counts as both first and last.
    fn wants(&self, record: &[u8]) -> bool {
        let (class, number, returns) = if self.is_extended {
            (record[16], record[14] & 15, record[14] >> 4)
        } else {
            (record[15] & 31, record[14] & 7, (record[14] >> 3) & 7)
        };
        self.keep[usize::from(class)]
            && (!self.first_only || number <= 1)
            && (!self.last_only || number == 0 || number >= returns)
    }
}

/// One pass over the points of a LAS file.
pub(super) struct RecordPass {
    reader: Box<dyn RecordReader>,
    filter: RecordFilter,
    plan: RowPlan,
    record_len: usize,
    records: Vec<u8>,
    /// Bytes of `records` already used, and number of records in the file before `records`.
    used: usize,
    before: u64,
}

impl RecordPass {
    pub(super) fn new(
        file: FileView,
        header: &LasHeader,
        options: &SourceOptions,
        plan: RowPlan,
    ) -> Result<Self> {
        let reader: Box<dyn RecordReader> = match &header.laz {
            Some(laszip) => {
                let is_whole = !plan.is_empty();
                Box::new(LazRecords::new(file, header, laszip, options.threads(), is_whole)?)
            }
            None => Box::new(PlainRecords::new(file, header)),
        };
        Ok(RecordPass {
            reader,
            filter: RecordFilter::new(options, header.format),
            plan,
            record_len: header.record_len,
            records: Vec::new(),
            used: 0,
            before: 0,
        })
    }
}

impl Pass for RecordPass {
    fn next_batch(
        &mut self,
        placement: &mut Placement,
        batch: &mut Vec<Point>,
        rows: &mut Vec<u8>,
    ) -> Result<bool> {
        if self.used == self.records.len() {
            self.before += (self.records.len() / self.record_len) as u64;
            self.used = 0;
            self.reader.next_records(&mut self.records)?;
            if self.records.is_empty() {
                return Ok(false);
            }
        }
        let end = self.records.len().min(self.used + BATCH_POINTS * self.record_len);
        if self.filter.wants_all() && placement.keeps_integers() {
            let records = || self.records[self.used..end].chunks_exact(self.record_len);
            batch.extend(records().map(raw_point));
            if !self.plan.is_empty() {
                records().for_each(|record| self.plan.append(record, rows));
            }
            self.used = end;
            return Ok(true);
        }
        let first = self.before + (self.used / self.record_len) as u64;
        for (record, index) in self.records[self.used..end].chunks_exact(self.record_len).zip(first..) {
            if self.filter.wants(record)
                && placement.put(raw_point(record), batch).map_err(|e| e.at(format!("record {index}")))?
            {
                self.plan.append(record, rows);
            }
        }
        self.used = end;
        Ok(true)
    }
}

/// The stored integers of a record.
fn raw_point(record: &[u8]) -> Point {
    let value = |at: usize| {
        f64::from(i32::from_le_bytes(
            record[at..at + 4].try_into().expect("records are longer than 12 bytes"),
        ))
    };
    [value(0), value(4), value(8)]
}

/// Records of an uncompressed file.
struct PlainRecords {
    file: FileView,
    at: u64,
    left: u64,
    record_len: usize,
}

impl PlainRecords {
    fn new(file: FileView, header: &LasHeader) -> Self {
        PlainRecords { file, at: header.points_start, left: header.points, record_len: header.record_len }
    }
}

impl RecordReader for PlainRecords {
    fn next_records(&mut self, records: &mut Vec<u8>) -> Result<()> {
        let count = self.left.min((READ_LEN / self.record_len).max(1) as u64);
        records.resize(count as usize * self.record_len, 0);
        self.file
            .read_at(self.at, records)
            .map_err(|e| Error::io("reading point records", e).at(format!("byte {}", self.at)))?;
        self.at += records.len() as u64;
        self.left -= count;
        Ok(())
    }
}
