//! Points that a file stores as one or several arrays of coordinates, three per point.

use std::io::{BufRead, BufReader};
use std::ops::Range;
use std::sync::Arc;

use crate::raw::sample::SampleType;
use crate::source::origin::FileView;
use crate::source::pass::{BATCH_POINTS, Content, Pass, Stated};
use crate::source::placement::Placement;
use crate::source::row_plan::{RowPlan, offers_of};
use crate::text::numbers::{NumberReader, Writing};
use crate::vtk::Framed;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::attributes::Attribute;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Coordinates, Crs};

/// Bytes that are read at once.
const BUFFER_LEN: usize = 1 << 18;

/// An array of numbers of points: x, y and z of one point after the other, or those of an attribute.
#[derive(Debug, Clone)]
pub(crate) struct PointArray {
    /// Number of the array's piece of the file, if the format has pieces.
    pub(crate) piece: Option<u64>,
    pub(crate) points: u64,
    /// Numbers per point.
    pub(crate) components: u8,
    pub(crate) sample: SampleType,
    pub(crate) writing: Writing,
    pub(crate) place: Place,
    /// Whether the place must end with the last coordinate.
    pub(crate) is_exact: bool,
    /// Attributes of the same points, with their names.
    pub(crate) data: Vec<(String, PointArray)>,
}

/// Where the numbers of an array are.
#[derive(Debug, Clone)]
pub(crate) enum Place {
    /// Between these bytes of the file, unpacked.
    Plain { start: u64, end: u64 },
    /// Packed as in the XML formats of VTK.
    Framed(Framed),
}

/// An input of numbers that a pass reads.
pub(crate) type Numbers = Box<dyn BufRead + Send>;

impl PointArray {
    /// Length in bytes of the binary numbers of `points` points.
    pub(crate) fn len_of(points: u64, components: u8, sample: SampleType) -> Result<u64> {
        let too_many = || Error::malformed(format!("{points} points are stated: no file holds as many"));
        // The limit serves text too: a number of text takes at least two bytes, with its separator.
        points
            .checked_mul(u64::from(components) * sample.len() as u64)
            .filter(|&len| len < 1 << 62)
            .ok_or_else(too_many)
    }

    /// Whether reading takes more than copying bytes.
    fn is_costly(&self) -> bool {
        self.writing == Writing::Text || matches!(self.place, Place::Framed(_))
    }

    fn open(&self, view: &FileView) -> Result<NumberReader<Numbers>> {
        let input: Numbers = match &self.place {
            Place::Plain { start, end } => {
                Box::new(BufReader::with_capacity(BUFFER_LEN, view.range(*start, *end)))
            }
            Place::Framed(framed) => framed.open(view)?,
        };
        Ok(NumberReader::new(input, self.sample, self.writing, u64::from(self.components) * self.points))
    }

    /// Position of the point with this index, for messages.
    fn position(&self, point: u64) -> String {
        let piece = self.piece.map(|piece| format!("piece {piece}, ")).unwrap_or_default();
        match (&self.place, self.writing) {
            (Place::Plain { start, .. }, Writing::Binary(_)) => {
                let byte = start + point * 3 * self.sample.len() as u64;
                format!("{piece}point {} at byte {byte}", point + 1)
            }
            _ => format!("{piece}point {}", point + 1),
        }
    }
}

/// The points of a file with these arrays.
pub(crate) fn content(arrays: Vec<PointArray>) -> Content {
    let is_costly = arrays.iter().any(PointArray::is_costly);
    let stated = Stated {
        coordinates: Coordinates::F64,
        has_z: Some(true),
        crs: Crs::Unknown.into(),
        bounds: None,
        points: arrays.iter().try_fold(0u64, |sum, array| sum.checked_add(array.points)),
        offers: offers_of(&attributes_of(&arrays)).into(),
    };
    let arrays: Arc<[PointArray]> = arrays.into();
    let content = Content::new(stated, move |file, plan| {
        Ok(Box::new(ArrayPass::new(file.origin.view()?, Arc::clone(&arrays), plan)))
    });
    Content { is_costly, ..content }
}

/// The attributes that all arrays with points have, in the order of the first.
fn attributes_of(arrays: &[PointArray]) -> Vec<Attribute> {
    let mut pieces = arrays.iter().filter(|array| array.points > 0).map(|array| &array.data);
    let Some(first) = pieces.next() else { return Vec::new() };
    let of = |(name, array): &(String, PointArray)| Attribute {
        components: array.components,
        ..Attribute::new(name, array.sample.number_type())
    };
    let mut attributes: Vec<Attribute> = first.iter().map(of).collect();
    attributes.retain(|attribute| attribute.check().is_ok());
    for data in pieces {
        attributes.retain(|attribute| data.iter().any(|other| of(other) == *attribute));
    }
    // Arrays of one name cannot be told apart in the other pieces.
    let names: Vec<String> = attributes.iter().map(|attribute| attribute.name.clone()).collect();
    attributes.retain(|attribute| names.iter().filter(|name| **name == attribute.name).count() == 1);
    attributes
}

/// A number, or several, in a record of attributes.
struct RecordField {
    name: String,
    place: Range<usize>,
}

/// One pass over the arrays of a file. Memory: one batch.
pub(crate) struct ArrayPass {
    view: FileView,
    arrays: Arc<[PointArray]>,
    /// Index of the current array, and its reader once it is open.
    at: usize,
    reader: Option<NumberReader<Numbers>>,
    values: Vec<f64>,
    plan: RowPlan,
    /// The fields of a record that are needed, and their readers in the current array.
    fields: Vec<RecordField>,
    record_len: usize,
    field_readers: Vec<NumberReader<Numbers>>,
}

impl ArrayPass {
    fn new(view: FileView, arrays: Arc<[PointArray]>, plan: RowPlan) -> Self {
        let attributes = if plan.is_empty() { Vec::new() } else { attributes_of(&arrays) };
        let mut record_len = 0;
        let field = |attribute: &Attribute| {
            let start = record_len;
            record_len += attribute.width();
            let name = attribute.name.clone();
            plan.uses(start).then_some(RecordField { name, place: start..record_len })
        };
        let fields = attributes.iter().filter_map(field).collect();
        let (values, field_readers) = (Vec::new(), Vec::new());
        ArrayPass { view, arrays, at: 0, reader: None, values, plan, fields, record_len, field_readers }
    }

    /// Reads the records of the next `count` points of the current array.
    fn read_records(&mut self, count: usize) -> Result<Vec<u8>> {
        let array = &self.arrays[self.at];
        if self.field_readers.is_empty() {
            for RecordField { name, .. } in &self.fields {
                let data = array.data.iter().find(|(of, _)| of == name).map(|(_, data)| data);
                let data = data.ok_or_else(|| Error::malformed(format!("found no array {name}")))?;
                self.field_readers.push(data.open(&self.view)?);
            }
        }
        let (mut records, mut column) = (vec![0; count * self.record_len], Vec::new());
        for (RecordField { name, place }, reader) in self.fields.iter().zip(&mut self.field_readers) {
            column.clear();
            let numbers = count * place.len() / reader.number_len();
            reader.read_stored(numbers as u64, &mut column).map_err(|e| e.at(format!("array {name}")))?;
            for (record, field) in
                records.chunks_exact_mut(self.record_len).zip(column.chunks_exact(place.len()))
            {
                record[place.clone()].copy_from_slice(field);
            }
        }
        Ok(records)
    }

    /// Replaces the values by the coordinates of the next points of the current array; false at its end.
    fn read(&mut self) -> Result<bool> {
        let array = &self.arrays[self.at];
        let reader = match &mut self.reader {
            Some(reader) => reader,
            none => none.insert(array.open(&self.view).map_err(|e| e.at(array.position(0)))?),
        };
        self.values.clear();
        let read = reader.read(3 * BATCH_POINTS as u64, &mut self.values).and_then(|goes_on| {
            if !goes_on && array.is_exact {
                reader.expect_end()?;
            }
            Ok(goes_on)
        });
        read.map_err(|e| e.at(array.position(reader.done() / 3)))
    }
}

impl Pass for ArrayPass {
    fn next_batch(
        &mut self,
        placement: &mut Placement,
        batch: &mut Vec<Point>,
        rows: &mut Vec<u8>,
    ) -> Result<bool> {
        while self.at < self.arrays.len() {
            if self.read()? {
                let array = &self.arrays[self.at];
                let done = self.reader.as_ref().map_or(0, NumberReader::done);
                let first = (done - self.values.len() as u64) / 3;
                let mut is_put = Vec::new();
                for (point, number) in self.values.as_chunks::<3>().0.iter().zip(first..) {
                    is_put.push(placement.put(*point, batch).map_err(|e| e.at(array.position(number)))?);
                }
                if !self.plan.is_empty() {
                    let records = self.read_records(is_put.len())?;
                    for (record, _) in
                        records.chunks_exact(self.record_len).zip(is_put).filter(|(_, is_put)| *is_put)
                    {
                        self.plan.append(record, rows);
                    }
                }
                return Ok(true);
            }
            self.reader = None;
            self.field_readers.clear();
            self.at += 1;
        }
        Ok(false)
    }
}
