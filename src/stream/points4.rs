//! Points and simplices of four dimensions, as blocks hold them.

use byteorder::{ByteOrder, LittleEndian as LE};

use super::block::whole_records;
use super::header::Header;
use crate::model::cells4::Point4;
use spmesh_base::error::{Error, Result};

/// Points of four dimensions; either all have a value, or none has.
#[derive(Debug, Clone, Default)]
pub struct Points4 {
    /// Coordinates x, y, z, t: finite.
    pub points: Vec<Point4>,
    /// The value measured at each point: finite, or NaN if it is unknown.
    pub values: Option<Vec<f64>>,
}

/// Values are equal if their bits are, so that an unknown value equals itself.
impl PartialEq for Points4 {
    fn eq(&self, other: &Self) -> bool {
        let bits = |values: &Option<Vec<f64>>| {
            values.as_ref().map(|values| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>())
        };
        self.points == other.points && bits(&self.values) == bits(&other.values)
    }
}

impl Points4 {
    /// An empty list; `has_values` says whether its points will have values.
    pub fn new(has_values: bool) -> Self {
        Points4 { points: Vec::new(), values: has_values.then(Vec::new) }
    }

    /// Decodes the points of a block. [`super::rules4::Rules4`] checks that coordinates are finite.
    pub(super) fn decode(header: &Header, bytes: &[u8]) -> Result<Self> {
        let mut points = Points4::new(header.has_elevation);
        for record in whole_records(bytes, header.point_len())? {
            points.points.push(std::array::from_fn(|axis| LE::read_f64(&record[8 * axis..])));
            if let Some(values) = &mut points.values {
                let value = LE::read_f64(&record[32..]);
                check_value(value)?;
                values.push(value);
            }
        }
        Ok(points)
    }
}

/// Checks that a value is finite, or the canonical NaN, which stands for an unknown value.
///
/// # Errors
/// Malformed, for any other value.
pub fn check_value(value: f64) -> Result<()> {
    if value.is_finite() || value.to_bits() == f64::NAN.to_bits() {
        return Ok(());
    }
    Err(Error::malformed(format!(
        "value {value} ({:#018x}) is neither finite nor the NaN of what is not known ({:#018x})",
        value.to_bits(),
        f64::NAN.to_bits()
    )))
}

/// Decodes the simplices of a block.
pub(super) fn simplices(bytes: &[u8]) -> Result<Vec<[u32; 5]>> {
    let simplex = |record: &[u8]| std::array::from_fn(|corner| LE::read_u32(&record[4 * corner..]));
    Ok(whole_records(bytes, 20)?.map(simplex).collect())
}
