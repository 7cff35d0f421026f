//! Numbers of binary trajectories, in either byte order.

use std::io::{BufRead, BufReader, ErrorKind, Read};

use crate::drivers::AnyInput;
use spmesh_base::error::{Error, Result};
use spmesh_stream::Coordinates;
use spmesh_stream::model::points::Point3;

/// Bytes read at once.
const BUFFER_LEN: usize = 1 << 17;

/// Reads numbers, and counts bytes.
pub(crate) struct Words {
    input: BufReader<AnyInput>,
    pub(crate) is_little: bool,
    bytes: u64,
}

impl Words {
    /// Big-endian numbers.
    pub(crate) fn new(input: AnyInput) -> Words {
        Words { input: BufReader::with_capacity(BUFFER_LEN, input), is_little: false, bytes: 0 }
    }

    /// Bytes that were read.
    pub(crate) fn position(&self) -> u64 {
        self.bytes
    }

    /// Whether the input has ended.
    pub(crate) fn is_ended(&mut self) -> Result<bool> {
        loop {
            match self.input.fill_buf() {
                Ok(bytes) => return Ok(bytes.is_empty()),
                Err(e) if e.kind() == ErrorKind::Interrupted => {}
                Err(e) => return Err(Error::io("reading", e)),
            }
        }
    }

    /// The number that starts a frame, one of some; `None` at the end of the input.
    pub(crate) fn start(&mut self, known: &[u32]) -> Result<Option<u32>> {
        if self.is_ended()? {
            return Ok(None);
        }
        let (found, usual) = (self.u32()?, known[0]);
        if known.contains(&found) {
            return Ok(Some(found));
        }
        Err(Error::malformed(format!("found {found}, expected {usual}, the start of a frame")))
    }

    pub(crate) fn array<const N: usize>(&mut self) -> Result<[u8; N]> {
        let mut bytes = [0; N];
        self.input.read_exact(&mut bytes).map_err(|e| match e.kind() {
            ErrorKind::UnexpectedEof => truncated(),
            _ => Error::io("reading", e),
        })?;
        self.bytes += N as u64;
        Ok(bytes)
    }

    pub(crate) fn u32(&mut self) -> Result<u32> {
        let bytes = self.array()?;
        Ok(if self.is_little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) })
    }

    pub(crate) fn i32(&mut self) -> Result<i32> {
        Ok(self.u32()?.cast_signed())
    }

    pub(crate) fn u64(&mut self) -> Result<u64> {
        let bytes = self.array()?;
        Ok(if self.is_little { u64::from_le_bytes(bytes) } else { u64::from_be_bytes(bytes) })
    }

    pub(crate) fn f32(&mut self) -> Result<f32> {
        self.u32().map(f32::from_bits)
    }

    /// So many bytes. Memory grows as they arrive.
    pub(crate) fn bytes(&mut self, len: u64) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let read = (&mut self.input).take(len).read_to_end(&mut bytes);
        self.bytes += bytes.len() as u64;
        read.map_err(|e| Error::io("reading", e))?;
        if (bytes.len() as u64) < len { Err(truncated()) } else { Ok(bytes) }
    }

    /// Passes over so many bytes.
    pub(crate) fn skip(&mut self, len: u64) -> Result<()> {
        let copied = std::io::copy(&mut (&mut self.input).take(len), &mut std::io::sink());
        let copied = copied.map_err(|e| Error::io("reading", e))?;
        self.bytes += copied;
        if copied < len { Err(truncated()) } else { Ok(()) }
    }

    /// Numbers of 4 or 8 bytes.
    pub(crate) fn reals(&mut self, count: u64, width: u64) -> Result<Vec<f64>> {
        let bytes = self.bytes(count.checked_mul(width).ok_or_else(truncated)?)?;
        let is_little = self.is_little;
        Ok(if width == 4 {
            let words = bytes.as_chunks::<4>().0.iter().copied();
            let word = |bytes| if is_little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) };
            words.map(|bytes| f64::from(f32::from_bits(word(bytes)))).collect()
        } else {
            let words = bytes.as_chunks::<8>().0.iter().copied();
            let word = |bytes| if is_little { u64::from_le_bytes(bytes) } else { u64::from_be_bytes(bytes) };
            words.map(|bytes| f64::from_bits(word(bytes))).collect()
        })
    }
}

fn truncated() -> Error {
    Error::malformed("truncated: the file ends inside of the frame")
}

/// Points of coordinates in nm that must be finite.
pub(super) fn of_nanometres(reals: &[f64]) -> Result<(Vec<Point3>, Coordinates)> {
    let points = reals.as_chunks().0.iter().map(|point: &Point3| point.map(|length| 10.0 * length)).collect();
    finite(points)
}

/// Points in Å, if all are finite.
pub(super) fn finite(points: Vec<Point3>) -> Result<(Vec<Point3>, Coordinates)> {
    match points.iter().position(|point| point.iter().any(|length| !length.is_finite())) {
        None => Ok((points, Coordinates::F64)),
        Some(at) => {
            let [x, y, z] = points[at];
            let atom = at + 1;
            Err(Error::malformed(format!("found {x} {y} {z} as the place of atom {atom}, expected numbers")))
        }
    }
}
