//! Geometries as well-known binary, in the form of GeoPackage.
//!
//! Source: OGC 12-128r19, GeoPackage Encoding Standard 1.4, clause 2.1.3; OGC 06-103r4, clause 8.

use crate::lines::Collector;
use crate::lines::collect::Shape;
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::WKB_DEPTH_MAX;

/// Enters the lines of a geometry with the header of GeoPackage.
pub(crate) fn enter(geometry: &[u8], lines: &mut Collector, position: &dyn Fn() -> String) -> Result<()> {
    let mut rest = Bytes { rest: geometry, is_little: true };
    if rest.take(2)? != b"GP" {
        return Err(Error::malformed("the geometry does not start with GP"));
    }
    rest.take(1)?;
    let flags = rest.take(1)?[0];
    // The number of the system, then the envelope.
    let envelope = match flags >> 1 & 7 {
        0 => 0,
        1 => 32,
        2 | 3 => 48,
        4 => 64,
        other => return Err(Error::malformed(format!("the geometry has an envelope of kind {other}"))),
    };
    rest.take(4 + envelope)?;
    let is_empty = flags & 16 != 0;
    if is_empty { Ok(()) } else { rest.geometry(lines, position, 0) }
}

struct Bytes<'a> {
    rest: &'a [u8],
    is_little: bool,
}

impl<'a> Bytes<'a> {
    fn take(&mut self, len: usize) -> Result<&'a [u8]> {
        let found = self.rest.len();
        let (taken, rest) = self.rest.split_at_checked(len).ok_or_else(|| {
            Error::malformed(format!("the geometry has {found} bytes left, expected {len}"))
        })?;
        self.rest = rest;
        Ok(taken)
    }

    fn integer(&mut self) -> Result<u32> {
        let bytes = self.take(4)?.try_into().expect("four bytes");
        Ok(if self.is_little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) })
    }

    /// A count of items with at least `len` bytes each.
    fn count(&mut self, len: usize) -> Result<usize> {
        let count = self.integer()? as usize;
        if count > self.rest.len() / len {
            return Err(Error::malformed(format!(
                "the geometry has {count} items, more than fit into its bytes"
            )));
        }
        Ok(count)
    }

    fn geometry(&mut self, lines: &mut Collector, position: &dyn Fn() -> String, depth: u32) -> Result<()> {
        self.is_little = match self.take(1)?[0] {
            0 => false,
            1 => true,
            other => {
                return Err(Error::malformed(format!(
                    "the geometry has the byte order {other}, expected 0 (big-endian) or 1 (little-endian)"
                )));
            }
        };
        let code = self.integer()?;
        let dims = match code / 1000 {
            0 => Dims { len: 2, z: None },
            1 => Dims { len: 3, z: Some(2) },
            2 => Dims { len: 3, z: None },
            3 => Dims { len: 4, z: Some(2) },
            _ => return Err(unknown(code)),
        };
        match code % 1000 {
            1 => {
                let vertex = self.vertices(1, dims)?;
                // An empty point has coordinates that are NaN.
                let is_empty = vertex[0][0].is_nan() && vertex[0][1].is_nan();
                if is_empty { Ok(()) } else { lines.add(Shape::Points, &vertex, position) }
            }
            2 => self.line(Shape::Line, dims, lines, position),
            3 => {
                lines.polygon();
                let rings = self.count(4)?;
                (0..rings).try_for_each(|_| self.line(Shape::Ring, dims, lines, position))
            }
            4..=7 if depth < WKB_DEPTH_MAX => {
                let parts = self.count(5)?;
                (0..parts).try_for_each(|_| self.geometry(lines, position, depth + 1))
            }
            4..=7 => Err(Error::malformed(format!("more than {WKB_DEPTH_MAX} collections in collections"))),
            _ => Err(unknown(code)),
        }
    }

    fn line(
        &mut self,
        shape: Shape,
        dims: Dims,
        lines: &mut Collector,
        position: &dyn Fn() -> String,
    ) -> Result<()> {
        let count = self.count(8 * dims.len)?;
        let vertices = self.vertices(count, dims)?;
        lines.add(shape, &vertices, position)
    }

    fn vertices(&mut self, count: usize, dims: Dims) -> Result<Vec<[f64; 3]>> {
        let is_little = self.is_little;
        let number = |bytes: &[u8]| {
            let bytes = bytes.try_into().expect("eight bytes");
            if is_little { f64::from_le_bytes(bytes) } else { f64::from_be_bytes(bytes) }
        };
        let bytes = self.take(8 * dims.len * count)?;
        let vertex = |vertex: &[u8]| {
            let value = |index: usize| number(&vertex[8 * index..8 * index + 8]);
            [value(0), value(1), dims.z.map_or(f64::NAN, value)]
        };
        Ok(bytes.chunks_exact(8 * dims.len).map(vertex).collect())
    }
}

/// Numbers of a vertex, and which of them is z.
#[derive(Clone, Copy)]
struct Dims {
    len: usize,
    z: Option<usize>,
}

fn unknown(code: u32) -> Error {
    Error::malformed(format!(
        "found a geometry of type {code}, expected points, lines or polygons: convert curves and surfaces first, for \
         example with ogr2ogr -nlt CONVERT_TO_LINEAR"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lines::Reading;
    use spmesh_stream::Crs;

    fn read(bytes: &[u8]) -> Result<Vec<(usize, Option<f64>)>> {
        let mut lines = Collector::new(&Reading::default());
        enter(bytes, &mut lines, &|| "row 1".to_string())?;
        let lines = lines.finish(Crs::Unknown)?.lines;
        Ok(lines.into_iter().map(|line| (line.vertices.len(), line.elevations[0])).collect())
    }

    /// A line of two vertices with z, big-endian, behind an envelope.
    fn line() -> Vec<u8> {
        let mut bytes = b"GP\0\x02\0\0\0\0".to_vec();
        bytes.extend([0; 32]);
        bytes.extend([0, 0, 0, 3, 234, 0, 0, 0, 2]);
        [1.0, 2.0, 3.0, 4.0, 5.0, f64::NAN].iter().for_each(|value: &f64| bytes.extend(value.to_be_bytes()));
        bytes
    }

    #[test]
    fn lines_are_read_and_damage_is_told() {
        assert_eq!(read(&line()).unwrap(), [(2, Some(3.0))]);
        for len in 0..line().len() {
            assert!(read(&line()[..len]).is_err(), "{len}");
        }
        for index in 0..line().len() {
            for value in [0, 1, 127, 255] {
                let mut bytes = line();
                bytes[index] = value;
                let _ = read(&bytes);
            }
        }
    }

    #[test]
    fn byte_order_is_one_of_two() {
        let mut bytes = line();
        bytes[8 + 32] = 9;
        let message = read(&bytes).unwrap_err().to_string();
        assert!(message.contains("the byte order 9, expected 0 (big-endian)"), "{message}");
    }

    #[test]
    fn collections_have_a_depth() {
        let nested = |depth: u32| {
            let mut bytes = b"GP\0\x01\0\0\0\0".to_vec();
            (0..depth).for_each(|_| bytes.extend([1, 7, 0, 0, 0, 1, 0, 0, 0]));
            bytes.extend(&line()[8 + 32..]);
            read(&bytes)
        };
        assert_eq!(nested(WKB_DEPTH_MAX).unwrap(), [(2, Some(3.0))]);
        let message = nested(WKB_DEPTH_MAX + 1).unwrap_err().to_string();
        assert!(message.contains("more than 32 collections in collections"), "{message}");
    }
}
