//! The variable length records of a LAS file, as they are written again.

use std::io::{Read, Write};
use std::ops::Range;

use crate::las::header::{EVLR_HEADER_LEN, VLR_HEADER_LEN};
use crate::source::origin::FileView;
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::HEADER_BODY_MAX;

/// Places in the head of a record.
const USER: Range<usize> = 2..18;
const NUMBER: Range<usize> = 18..20;
const LEN: usize = 20;

/// User and number of the records that matter here.
const EXTRA_BYTES: (&[u8], u16) = (b"LASF_Spec", 4);
const LASZIP: (&[u8], u16) = (b"laszip encoded", 22204);
/// The user of the records that make a file COPC.
const COPC: &[u8] = b"copc";

/// A record with its head.
#[derive(Debug, Clone)]
pub(crate) struct Record {
    head: Vec<u8>,
    /// First byte of the record in the file that it is from.
    pub(crate) start: u64,
    body: Body,
}

#[derive(Debug, Clone)]
enum Body {
    /// These bytes of the file.
    Same(Range<u64>),
    New(Vec<u8>),
}

/// Records that follow each other in a file.
#[derive(Debug, Default)]
pub(crate) struct RecordList {
    pub(crate) records: Vec<Record>,
    /// The byte after the last one.
    pub(crate) end: u64,
    is_extended: bool,
}

impl RecordList {
    /// Reads the heads of up to `count` records from byte `start` on; less, if no more fit before `end`.
    pub(crate) fn read(
        file: &FileView,
        start: u64,
        end: u64,
        count: u32,
        is_extended: bool,
    ) -> Result<RecordList> {
        let head_len = if is_extended { EVLR_HEADER_LEN } else { VLR_HEADER_LEN };
        let mut list = RecordList { records: Vec::new(), end: start, is_extended };
        for _ in 0..count {
            let at = list.end;
            if at.checked_add(head_len).is_none_or(|body| body > end) {
                break;
            }
            let mut head = vec![0; head_len as usize];
            file.read_at(at, &mut head)
                .map_err(|e| Error::io("reading", e).at(format!("record at byte {at}")))?;
            let len = match is_extended {
                true => u64::from_le_bytes(*head[LEN..].first_chunk().expect("the head is longer")),
                false => u16::from_le_bytes(*head[LEN..].first_chunk().expect("the head is longer")).into(),
            };
            let body = at + head_len;
            let Some(after) = body.checked_add(len).filter(|&after| after <= end) else { break };
            list.records.push(Record { head, start: at, body: Body::Same(body..after) });
            list.end = after;
        }
        Ok(list)
    }

    /// Removes the records of COPC, which are of use only while points are in its order, and the record of
    /// the compression. Returns whether it was COPC.
    pub(crate) fn drop_arrangement(&mut self) -> bool {
        let before = self.records.len();
        self.records.retain(|record| record.user() != COPC);
        let was_copc = self.records.len() < before;
        self.records.retain(|record| record.id() != LASZIP);
        was_copc
    }

    /// Removes the descriptions of extra bytes, of which some files have several records. Returns them one after
    /// the other, and the place of the first one in the list, if there is one.
    pub(crate) fn take_descriptions(&mut self, file: &FileView) -> Result<(Vec<u8>, Option<usize>)> {
        let first = self.records.iter().position(|record| record.id() == EXTRA_BYTES);
        let mut descriptions = Vec::new();
        for record in self.records.iter().filter(|record| record.id() == EXTRA_BYTES) {
            descriptions.extend(record.body(file)?);
        }
        self.records.retain(|record| record.id() != EXTRA_BYTES);
        Ok((descriptions, first))
    }

    /// Puts descriptions of extra bytes at this place of the list.
    pub(crate) fn put_descriptions(&mut self, place: usize, descriptions: Vec<u8>) -> Result<()> {
        self.insert(place, EXTRA_BYTES, "extra bytes", descriptions)
    }

    /// Appends the record of the compression.
    pub(crate) fn push_laszip(&mut self, body: Vec<u8>) -> Result<()> {
        self.insert(self.records.len(), LASZIP, laz::LazVlr::DESCRIPTION, body)
    }

    fn insert(
        &mut self,
        place: usize,
        (user, number): (&[u8], u16),
        text: &str,
        body: Vec<u8>,
    ) -> Result<()> {
        debug_assert!(!self.is_extended);
        let mut head = vec![0; VLR_HEADER_LEN as usize];
        head[USER][..user.len()].copy_from_slice(user);
        head[NUMBER].copy_from_slice(&number.to_le_bytes());
        head[LEN + 2..][..text.len()].copy_from_slice(text.as_bytes());
        let len = u16::try_from(body.len()).map_err(|_| {
            Error::usage("the description of extra bytes has no room for one more field: drop one first")
        })?;
        head[LEN..LEN + 2].copy_from_slice(&len.to_le_bytes());
        let record = Record { head, start: u64::MAX, body: Body::New(body) };
        self.records.insert(place, record);
        Ok(())
    }

    /// Bytes of all records.
    pub(crate) fn len(&self) -> u64 {
        self.records.iter().map(Record::len).sum()
    }

    /// Writes all records.
    pub(crate) fn write(&self, file: &FileView, output: &mut impl Write) -> Result<()> {
        for record in &self.records {
            output.write_all(&record.head).map_err(|e| Error::io("writing", e))?;
            match &record.body {
                Body::New(bytes) => output.write_all(bytes).map_err(|e| Error::io("writing", e))?,
                Body::Same(range) => copy_range(file, range.clone(), output)?,
            }
        }
        Ok(())
    }
}

impl Record {
    fn user(&self) -> &[u8] {
        self.head[USER].split(|&byte| byte == 0).next().unwrap_or_default()
    }

    fn id(&self) -> (&[u8], u16) {
        (self.user(), u16::from_le_bytes([self.head[NUMBER.start], self.head[NUMBER.start + 1]]))
    }

    pub(crate) fn len(&self) -> u64 {
        let body = match &self.body {
            Body::Same(range) => range.end - range.start,
            Body::New(bytes) => bytes.len() as u64,
        };
        self.head.len() as u64 + body
    }

    /// The bytes of a short body.
    fn body(&self, file: &FileView) -> Result<Vec<u8>> {
        let range = match &self.body {
            Body::New(bytes) => return Ok(bytes.clone()),
            Body::Same(range) => range,
        };
        let len = range.end - range.start;
        if len > HEADER_BODY_MAX as u64 {
            let what = format!("record of {len} bytes, the maximum is {HEADER_BODY_MAX}");
            return Err(Error::malformed(what).at(format!("byte {}", self.start)));
        }
        let mut bytes = vec![0; len as usize];
        file.read_at(range.start, &mut bytes).map_err(|e| Error::io("reading", e))?;
        Ok(bytes)
    }
}

/// Copies bytes of a file.
pub(crate) fn copy_range(file: &FileView, range: Range<u64>, output: &mut impl Write) -> Result<()> {
    let mut from = file.range(range.start, range.end);
    let mut buffer = vec![0; 1 << 16];
    loop {
        let read = from.read(&mut buffer).map_err(|e| Error::io("reading", e))?;
        if read == 0 {
            return Ok(());
        }
        output.write_all(&buffer[..read]).map_err(|e| Error::io("writing", e))?;
    }
}
