//! Points as the bytes of a stream.

use crate::coordinates::Coordinates;
use crate::header::Header;
use crate::model::bounds::Point;
use spmesh_base::error::{Error, Result};
use spmesh_base::wide::{Loop, run_wide};

/// Appends the stored form of `point`.
pub(super) fn encode_point(header: &Header, point: Point, bytes: &mut Vec<u8>) -> Result<()> {
    for &value in &point[..header.coordinates_per_point()] {
        if !header.coordinates.can_store(value) {
            return Err(Error::malformed(format!("coordinate {value} does not fit the stream's encoding")));
        }
        match header.coordinates {
            Coordinates::F64 => bytes.extend_from_slice(&value.to_le_bytes()),
            Coordinates::I32 { .. } => bytes.extend_from_slice(&(value as i32).to_le_bytes()),
        }
    }
    Ok(())
}

/// Appends the stored form of all `points`, each as by `encode_point`.
///
/// # Errors
/// [`spmesh_base::error::ErrorKind::Malformed`] if a coordinate does not fit the encoding of the header.
pub fn encode_points(header: &Header, points: &[Point], bytes: &mut Vec<u8>) -> Result<()> {
    let all_fit = match (header.coordinates, header.coordinates_per_point()) {
        (Coordinates::I32 { .. }, 2) => append::<2, 4>(points, bytes, i32_bytes),
        (Coordinates::I32 { .. }, _) => run_wide(Integers { values: points.as_flattened(), bytes }),
        (Coordinates::F64, 2) => append::<2, 8>(points, bytes, f64_bytes),
        (Coordinates::F64, _) => append::<3, 8>(points, bytes, f64_bytes),
    };
    if all_fit {
        return Ok(());
    }
    points.iter().try_for_each(|&point| encode_point(header, point, &mut Vec::new()))
}

fn i32_bytes(value: f64) -> ([u8; 4], bool) {
    ((value as i32).to_le_bytes(), f64::from(value as i32) == value)
}

fn f64_bytes(value: f64) -> ([u8; 8], bool) {
    (value.to_le_bytes(), value.is_finite())
}

/// Appends values as 32-bit integers; returns whether all of them fit.
struct Integers<'a> {
    values: &'a [f64],
    bytes: &'a mut Vec<u8>,
}

impl Loop for Integers<'_> {
    type Output = bool;

    #[inline(always)]
    fn run(self) -> bool {
        let start = self.bytes.len();
        self.bytes.resize(start + 4 * self.values.len(), 0);
        let (fields, _) = self.bytes[start..].as_chunks_mut();
        let mut misfits = 0;
        for (field, &value) in fields.iter_mut().zip(self.values) {
            let (encoded, fits) = i32_bytes(value);
            *field = encoded;
            misfits |= u64::from(!fits);
        }
        misfits == 0
    }
}

/// Appends the first `AXES` coordinates of each point as `WIDTH` bytes each; returns whether all of them fit.
#[inline(always)]
fn append<const AXES: usize, const WIDTH: usize>(
    points: &[Point],
    bytes: &mut Vec<u8>,
    encode: impl Fn(f64) -> ([u8; WIDTH], bool),
) -> bool {
    let start = bytes.len();
    bytes.resize(start + points.len() * AXES * WIDTH, 0);
    let mut all_fit = true;
    for (record, point) in bytes[start..].chunks_exact_mut(AXES * WIDTH).zip(points) {
        for (field, &value) in record.chunks_exact_mut(WIDTH).zip(point) {
            let (encoded, fits) = encode(value);
            field.copy_from_slice(&encoded);
            all_fit &= fits;
        }
    }
    all_fit
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kind::Kind;

    #[test]
    fn many_points_are_encoded_as_one_by_one() {
        let grid = Coordinates::I32 { scale: [0.001; 3], offset: [0.0; 3] };
        let header = Header::new(Kind::Points, grid, 3, false);
        let ends = [f64::from(i32::MIN), f64::from(i32::MAX), -0.0];
        for count in 0..40 {
            let mut points: Vec<Point> = (0..count).map(|i| [f64::from(i), f64::from(-7 * i), 1e9]).collect();
            points.extend((count == 9).then_some(ends));
            let (mut all, mut single) = (vec![1], vec![1]);
            encode_points(&header, &points, &mut all).unwrap();
            points.iter().for_each(|&point| encode_point(&header, point, &mut single).unwrap());
            assert_eq!(all, single);
            for wrong in [f64::NAN, 0.5, 2_147_483_648.0, -2_147_483_649.0, f64::INFINITY] {
                for at in 0..points.len() {
                    let mut points = points.clone();
                    points[at][at % 3] = wrong;
                    assert!(encode_points(&header, &points, &mut Vec::new()).is_err(), "{wrong} at {at}");
                }
            }
        }
    }
}
