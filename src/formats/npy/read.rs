//! Points in an array of numpy (`numpy.save`): shape (n, 2) or (n, 3), of integers or floating-point numbers.
//!
//! Source: the NEP 1 description of the format, versions 1 to 3.

use std::io::BufReader;

use crate::npy::header::NpyHeader;
use crate::raw::byte_order::ByteOrder;
use crate::raw::sample::SampleType;
use crate::source::origin::FileView;
use crate::source::pass::{BATCH_POINTS, Content, Opening, Pass, Stated};
use crate::source::placement::Placement;
use crate::text::numbers::{NumberReader, Writing};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Coordinates, Crs};

/// Bytes that are read at once.
const BUFFER_LEN: usize = 1 << 18;

/// Opens an array of points.
pub(crate) fn open(file: &Opening) -> Result<Content> {
    let array = NpyArray::read(&file.origin.view()?)?;
    let pass = array.clone();
    Ok(Content::new(array.state(), move |file, _| {
        Ok(Box::new(NpyPass::new(&file.origin.view()?, pass.clone())))
    }))
}

/// An array of points: a row has the coordinates of one.
#[derive(Debug, Clone)]
struct NpyArray {
    sample: SampleType,
    order: ByteOrder,
    /// Whether all x come first, then all y.
    is_by_columns: bool,
    rows: u64,
    columns: u64,
    /// Offset of the first number.
    start: u64,
}

impl NpyArray {
    /// Reads the header of a file, and checks that the file holds the whole array and nothing else.
    fn read(view: &FileView) -> Result<NpyArray> {
        let NpyHeader { dtype, is_by_columns, shape, start } = NpyHeader::read(view)?;
        let (sample, order) = sample_of(&dtype)?;
        let [rows, columns] = match shape[..] {
            [0, _] => return Err(Error::malformed(format!("shape {}: no rows", shape_text(&shape)))),
            [rows, columns @ 2..=3] => [rows, columns],
            _ => return Err(bad_shape(&shape)),
        };
        let array = NpyArray { sample, order, is_by_columns, rows, columns, start };
        array.check_len(view.len())?;
        Ok(array)
    }

    fn check_len(&self, len: u64) -> Result<()> {
        let needed = u128::from(self.rows) * u128::from(self.columns) * self.sample.len() as u128;
        let found = u128::from(len - self.start);
        if found < needed {
            let what = format!("truncated: found {found} of {needed} bytes of the array");
            return Err(Error::malformed(what).at(format!("byte {len}")));
        }
        if found > needed {
            let what = format!("{} bytes follow the array: expected one array", found - needed);
            return Err(Error::malformed(what).at(format!("byte {}", u128::from(self.start) + needed)));
        }
        Ok(())
    }

    /// What the file states about itself.
    fn state(&self) -> Stated {
        Stated {
            coordinates: Coordinates::F64,
            has_z: Some(self.columns == 3),
            crs: Crs::Unknown.into(),
            bounds: None,
            points: Some(self.rows),
            offers: Vec::new().into(),
        }
    }

    /// Offset of a number.
    fn byte_of(&self, row: u64, column: u64) -> u64 {
        let place = if self.is_by_columns { column * self.rows + row } else { row * self.columns + column };
        self.start + place * self.sample.len() as u64
    }

    /// Readers that take turns, and how many numbers of a row each has.
    fn readers(&self, view: &FileView) -> (Vec<NumberReader<BufReader<FileView>>>, usize) {
        let reader = |first: u64, numbers: u64| {
            let end = first + numbers * self.sample.len() as u64;
            let input = BufReader::with_capacity(BUFFER_LEN, view.range(first, end));
            NumberReader::new(input, self.sample, Writing::Binary(self.order), numbers)
        };
        match self.is_by_columns {
            true => {
                let column = |column| reader(self.byte_of(0, column), self.rows);
                ((0..self.columns).map(column).collect(), 1)
            }
            false => (vec![reader(self.start, self.rows * self.columns)], self.columns as usize),
        }
    }
}

/// How numbers of a dtype such as `<f8` are stored.
fn sample_of(dtype: &str) -> Result<(SampleType, ByteOrder)> {
    let refusal = || {
        let what = "expected floating-point numbers or integers, such as <f8: save array.astype(float)";
        Error::malformed(format!("dtype {dtype}; {what}"))
    };
    let order = match dtype.as_bytes().first() {
        Some(b'<' | b'|') => ByteOrder::Little,
        Some(b'>') => ByteOrder::Big,
        _ => return Err(refusal()),
    };
    let sample = match &dtype[1..] {
        "f8" => SampleType::F64,
        "f4" => SampleType::F32,
        "i8" => SampleType::I64,
        "i4" => SampleType::I32,
        "i2" => SampleType::I16,
        "i1" => SampleType::I8,
        "u8" => SampleType::U64,
        "u4" => SampleType::U32,
        "u2" => SampleType::U16,
        "u1" => SampleType::U8,
        _ => return Err(refusal()),
    };
    Ok((sample, order))
}

/// A shape as Python writes it.
fn shape_text(shape: &[u64]) -> String {
    match shape {
        [one] => format!("({one},)"),
        all => format!("({})", all.iter().map(u64::to_string).collect::<Vec<_>>().join(", ")),
    }
}

fn bad_shape(shape: &[u64]) -> Error {
    let remedy = match shape {
        [2 | 3, n] if *n > 3 => format!("; its transpose has shape ({n}, {})", shape[0]),
        [_, columns] if *columns > 3 => "; save array[:, :3]".to_string(),
        _ => String::new(),
    };
    let what = "expected (n, 2) for x and y, or (n, 3) for x, y and z";
    Error::malformed(format!("shape {}; {what}{remedy}", shape_text(shape)))
}

/// One pass over an array. Memory: one batch.
struct NpyPass {
    array: NpyArray,
    readers: Vec<NumberReader<BufReader<FileView>>>,
    /// Numbers of a row that each reader has.
    share: usize,
    /// Numbers of the batch, by readers.
    numbers: Vec<Vec<f64>>,
    /// Rows read so far.
    done: u64,
}

impl NpyPass {
    fn new(view: &FileView, array: NpyArray) -> NpyPass {
        let (readers, share) = array.readers(view);
        NpyPass { array, numbers: vec![Vec::new(); readers.len()], readers, share, done: 0 }
    }

    /// The coordinates in a row of the batch.
    fn point(&self, row: usize) -> Point {
        let mut point = [0.0; 3];
        let numbers = self.numbers.iter().flat_map(|of_one| &of_one[row * self.share..][..self.share]);
        point.iter_mut().zip(numbers).for_each(|(coordinate, &number)| *coordinate = number);
        point
    }
}

impl Pass for NpyPass {
    fn next_batch(
        &mut self,
        placement: &mut Placement,
        batch: &mut Vec<Point>,
        _rows: &mut Vec<u8>,
    ) -> Result<bool> {
        for (reader, numbers) in self.readers.iter_mut().zip(&mut self.numbers) {
            numbers.clear();
            reader
                .read((self.share * BATCH_POINTS) as u64, numbers)
                .map_err(|e| e.at(format!("row {}", self.done)))?;
        }
        let count = self.numbers[0].len() / self.share;
        for row in 0..count {
            let number = self.done + row as u64;
            placement.put(self.point(row), batch).map_err(|e| {
                e.at(format!("row {number} (counted from 0), byte {}", self.array.byte_of(number, 0)))
            })?;
        }
        self.done += count as u64;
        Ok(count > 0)
    }
}
