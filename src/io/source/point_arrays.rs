//! Points that a file stores as one or several arrays of coordinates, three per point.

use std::io::{BufRead, BufReader};
use std::sync::Arc;

use super::numbers::{NumberReader, Writing};
use super::origin::FileView;
use super::pass::{BATCH_POINTS, Pass, Stated};
use super::placement::Placement;
use super::sample_type::SampleType;
use super::vtk::Framed;
use spmesh_core::error::{Error, Result};
use spmesh_model::bounds::Point;
use spmesh_stream::{Coordinates, Crs};

/// Bytes that are read at once.
const BUFFER_LEN: usize = 1 << 18;

/// An array of coordinates: x, y and z of one point after the other.
#[derive(Debug, Clone)]
pub(super) struct PointArray {
    /// Number of the array's piece of the file, if the format has pieces.
    pub(super) piece: Option<u64>,
    pub(super) points: u64,
    pub(super) sample: SampleType,
    pub(super) writing: Writing,
    pub(super) place: Place,
    /// Whether the place must end with the last coordinate.
    pub(super) is_exact: bool,
}

/// Where the numbers of an array are.
#[derive(Debug, Clone)]
pub(super) enum Place {
    /// Between these bytes of the file, unpacked.
    Plain { start: u64, end: u64 },
    /// Packed as in the XML formats of VTK.
    Framed(Framed),
}

/// An input of numbers that a pass reads.
pub(super) type Numbers = Box<dyn BufRead + Send>;

impl PointArray {
    /// Length in bytes of the binary numbers of `points` points.
    ///
    /// # Errors
    /// If the length is beyond that of any file.
    pub(super) fn len_of(points: u64, sample: SampleType) -> Result<u64> {
        let too_many = || Error::malformed(format!("{points} points are stated: no file holds as many"));
        // The limit serves text too: a number of text takes at least two bytes, with its separator.
        points.checked_mul(3 * sample.len() as u64).filter(|&len| len < 1 << 62).ok_or_else(too_many)
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
        Ok(NumberReader::new(input, self.sample, self.writing, 3 * self.points))
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

/// Whether reading `arrays` takes more than copying bytes.
pub(super) fn are_costly(arrays: &[PointArray]) -> bool {
    arrays.iter().any(PointArray::is_costly)
}

/// What a file with `arrays` states about itself.
pub(super) fn state(arrays: &[PointArray]) -> Stated {
    Stated {
        coordinates: Coordinates::F64,
        has_z: Some(true),
        crs: Crs::Unknown,
        bounds: None,
        points: arrays.iter().try_fold(0u64, |sum, array| sum.checked_add(array.points)),
        offers: Vec::new(),
    }
}

/// One pass over the arrays of a file. Memory: one batch.
pub(super) struct ArrayPass {
    view: FileView,
    arrays: Arc<[PointArray]>,
    /// Index of the current array, and its reader once it is open.
    at: usize,
    reader: Option<NumberReader<Numbers>>,
    values: Vec<f64>,
}

impl ArrayPass {
    pub(super) fn new(view: FileView, arrays: Arc<[PointArray]>) -> Self {
        ArrayPass { view, arrays, at: 0, reader: None, values: Vec::new() }
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
        _rows: &mut Vec<u8>,
    ) -> Result<bool> {
        while self.at < self.arrays.len() {
            if self.read()? {
                let array = &self.arrays[self.at];
                let done = self.reader.as_ref().map_or(0, NumberReader::done);
                let first = (done - self.values.len() as u64) / 3;
                for (point, number) in self.values.as_chunks::<3>().0.iter().zip(first..) {
                    placement.put(*point, batch).map_err(|e| e.at(array.position(number)))?;
                }
                return Ok(true);
            }
            self.reader = None;
            self.at += 1;
        }
        Ok(false)
    }
}
