//! Points from the records of LAS files, compressed or not.

use std::ops::Range;
use std::sync::Arc;

use laz::DecompressionSelection;

use crate::las::header::LasHeader;
use crate::las::index;
use crate::las::laz::LazRecords;
use crate::source::cut::Cut;
use crate::source::options::SourceOptions;
use crate::source::origin::FileView;
use crate::source::pass::{BATCH_POINTS, Content, Opening, Pass, Sort, Stated};
use crate::source::placement::Placement;
use crate::source::record_filter::RecordFilter;
use crate::source::record_reader::RecordReader;
use crate::source::row_plan::RowPlan;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::Point;

/// Opens a LAS, LAZ or COPC file.
pub(crate) fn open(file: &Opening, notices: &mut Vec<String>) -> Result<Content> {
    let mut header = LasHeader::read(&file.origin.view()?, file.options.salvage, notices)?;
    if let Some(reach) = &file.options.reach {
        header.parts = index::find_parts(file.origin, &header, reach, notices)?;
    }
    let stated = Stated {
        coordinates: header.coordinates,
        has_z: Some(true),
        crs: Arc::new(header.crs.clone()),
        bounds: header.bounds,
        points: Some(header.points),
        offers: Arc::new(header.offers.clone()),
    };
    let (sort, is_costly) = (Sort::Records(header.format), header.laz.is_some());
    let cut = (header.lost > 0).then_some(Cut { read: header.points, lost: Some(header.lost) });
    let content = Content::new(stated, move |file, plan| {
        Ok(Box::new(RecordPass::new(file.origin.view()?, &header, file.options, plan)?))
    });
    Ok(Content { sort, is_costly, cut, ..content })
}

/// Bytes of records read at once from an uncompressed file.
const READ_LEN: usize = 1 << 18;

/// One pass over the points of a LAS file.
pub(crate) struct RecordPass {
    reader: Box<dyn RecordReader>,
    filter: RecordFilter,
    plan: RowPlan,
    record_len: usize,
    records: Vec<u8>,
    /// Bytes of `records` already used.
    used: usize,
    /// Records decoded so far.
    decoded: u64,
}

impl RecordPass {
    pub(crate) fn new(
        file: FileView,
        header: &LasHeader,
        options: &SourceOptions,
        plan: RowPlan,
    ) -> Result<Self> {
        let filter = RecordFilter::new(&options.filters, header.format);
        let reader: Box<dyn RecordReader> = match &header.laz {
            Some(laszip) => {
                let selection =
                    if plan.is_empty() { filter.selection() } else { DecompressionSelection::all() };
                Box::new(LazRecords::new(file, header, laszip, options.threads(), selection)?)
            }
            None => Box::new(PlainRecords::new(file, header)),
        };
        Ok(RecordPass {
            reader,
            filter,
            plan,
            record_len: header.record_len,
            records: Vec::new(),
            used: 0,
            decoded: 0,
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
            self.used = 0;
            self.reader.next_records(&mut self.records)?;
            self.decoded += (self.records.len() / self.record_len) as u64;
            if self.records.is_empty() {
                return Ok(false);
            }
        }
        let end = self.records.len().min(self.used + BATCH_POINTS * self.record_len);
        if self.filter.keeps_others() && placement.keeps_integers() {
            let records = || self.records[self.used..end].chunks_exact(self.record_len);
            let (before, mut flags) = (batch.len(), 0);
            batch.extend(records().map(|record| {
                flags |= RecordFilter::flags(record);
                raw_point(record)
            }));
            if !self.filter.is_withheld(flags) {
                if !self.plan.is_empty() {
                    records().for_each(|record| self.plan.append(record, rows));
                }
                self.used = end;
                return Ok(true);
            }
            batch.truncate(before);
        }
        let first = self.reader.first() + (self.used / self.record_len) as u64;
        for (record, index) in self.records[self.used..end].chunks_exact(self.record_len).zip(first..) {
            if placement.is_elsewhere(raw_point(record)) {
                continue;
            }
            if let Some(reason) = self.filter.reason(record) {
                placement.dropped.count(reason);
            } else if placement.put(raw_point(record), batch).map_err(|e| e.at(format!("record {index}")))? {
                self.plan.append(record, rows);
            }
        }
        self.used = end;
        Ok(true)
    }

    fn records(&self) -> u64 {
        self.decoded
    }
}

/// The stored integers of a record, of which the first 12 bytes are enough.
pub(crate) fn raw_point(record: &[u8]) -> Point {
    let value = |at: usize| {
        f64::from(i32::from_le_bytes(
            record[at..at + 4].try_into().expect("records are longer than 12 bytes"),
        ))
    };
    [value(0), value(4), value(8)]
}

/// Records of an uncompressed file.
pub(crate) struct PlainRecords {
    file: FileView,
    points_start: u64,
    record_len: usize,
    /// Numbers of the records to read.
    ranges: std::vec::IntoIter<Range<u64>>,
    /// The records of the current range that are left, and the first of the last ones.
    left: Range<u64>,
    first: u64,
}

impl PlainRecords {
    pub(crate) fn new(file: FileView, header: &LasHeader) -> Self {
        let ranges = index::ranges_of_parts(header.points, header.parts.as_deref()).into_iter();
        let (points_start, record_len) = (header.points_start, header.record_len);
        PlainRecords { file, points_start, record_len, ranges, left: 0..0, first: 0 }
    }
}

impl RecordReader for PlainRecords {
    fn next_records(&mut self, records: &mut Vec<u8>) -> Result<()> {
        if self.left.is_empty() {
            self.left = self.ranges.next().unwrap_or(self.left.end..self.left.end);
        }
        self.first = self.left.start;
        let left = self.left.end - self.left.start;
        let count = left.min((READ_LEN / self.record_len).max(1) as u64);
        records.resize(count as usize * self.record_len, 0);
        let at = self.points_start + self.first * self.record_len as u64;
        self.file
            .read_at(at, records)
            .map_err(|e| Error::io("reading point records", e).at(format!("byte {at}")))?;
        self.left.start += count;
        Ok(())
    }

    fn first(&self) -> u64 {
        self.first
    }
}
