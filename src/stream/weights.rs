//! Weighted points of space: the attribute `weight` is subtracted from squared distances.

use byteorder::{ByteOrder, LittleEndian as LE};

use super::header::Header;
use super::kind::Kind;
use crate::model::attributes::{Attribute, Attributes, NumberType};
use spmesh_base::error::{Error, Result};

/// What the header says of the weights of points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weighted {
    /// Upper bound of all weights of the stream, in squared stored units.
    pub greatest: f64,
}

impl Weighted {
    /// The attribute that holds the weights.
    pub fn attribute() -> Attribute {
        Attribute::new("weight", NumberType::F64)
    }

    pub(super) fn encode(header: &Header) -> Option<Vec<u8>> {
        header.weighted.map(|Weighted { greatest }| greatest.to_le_bytes().to_vec())
    }

    pub(super) fn decode(header: &mut Header, payload: &[u8]) -> std::result::Result<(), String> {
        if payload.len() != 8 {
            return Err(format!("{} bytes, expected 8", payload.len()));
        }
        header.weighted = Some(Weighted { greatest: LE::read_f64(payload) });
        Ok(())
    }

    /// Checks that a stream with this header can have weights.
    pub(super) fn check(self, header: &Header) -> std::result::Result<(), String> {
        if !(matches!(header.kind, Kind::Points | Kind::TetrahedralMesh) && header.dims == 3) {
            return Err(format!(
                "weights in a stream of kind {} of {} dimensions",
                header.kind.name(),
                header.dims
            ));
        }
        if !self.greatest.is_finite() {
            return Err(format!("the greatest weight {}, expected a finite number", self.greatest));
        }
        Weights::of(self, &header.attributes).map(|_| ())
    }
}

/// Where the weights are in the rows of points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weights {
    greatest: f64,
    /// Place in a row, and length of a row.
    at: usize,
    row_len: usize,
}

impl Weights {
    fn of(weighted: Weighted, attributes: &Attributes) -> std::result::Result<Weights, String> {
        let expected = Weighted::attribute();
        let found = attributes.find(&expected.name).filter(|(attribute, _)| {
            let Attribute { number, components, scale, unknown, .. } = attribute;
            (*number, *components, scale, unknown)
                == (expected.number, expected.components, &expected.scale, &expected.unknown)
        });
        let Some((_, place)) = found else {
            return Err(
                "weights need an attribute \"weight\": one f64 without scale and unknown number".into()
            );
        };
        Ok(Weights { greatest: weighted.greatest, at: place.start, row_len: attributes.row_len() })
    }

    /// The upper limit that the header states.
    pub fn greatest(&self) -> f64 {
        self.greatest
    }

    /// The weights in `rows`, one for each row.
    pub fn read<'r>(&self, rows: &'r [u8]) -> impl ExactSizeIterator<Item = f64> + use<'r> {
        let at = self.at;
        rows.chunks_exact(self.row_len).map(move |row| LE::read_f64(&row[at..]))
    }

    /// Checks the weights in `rows`.
    ///
    /// # Errors
    /// [`spmesh_base::error::ErrorKind::Malformed`] if one is not finite, or greater than the header says.
    pub fn check(&self, rows: &[u8]) -> Result<()> {
        // A NaN is no number up to the limit.
        match self.read(rows).find(|&weight| !(weight.is_finite() && weight <= self.greatest)) {
            Some(weight) => {
                let greatest = self.greatest;
                Err(Error::malformed(format!("weight {weight}, expected a finite number up to {greatest}")))
            }
            None => Ok(()),
        }
    }
}

impl Header {
    /// Where the weights of the points are; `None` without weights.
    pub fn weights(&self) -> Option<Weights> {
        // A header whose check fails has none.
        self.weighted.and_then(|weighted| Weights::of(weighted, &self.attributes).ok())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::coordinates::Coordinates;

    fn header(attributes: Vec<Attribute>) -> Header {
        let attributes = Attributes::new(attributes).expect("all rules hold");
        let weighted = Some(Weighted { greatest: 2.5 });
        Header { weighted, attributes, ..Header::new(Kind::Points, Coordinates::F64, 3, false) }
    }

    #[test]
    fn weights_are_one_plain_number_of_a_point_of_space() {
        let weight = Weighted::attribute;
        assert_eq!(header(vec![weight()]).check(), Ok(()));
        let others = [
            Attribute { components: 2, ..weight() },
            Attribute { scale: Some([1.0, 0.0]), ..weight() },
            Attribute { unknown: Some(vec![0; 8]), ..weight() },
            Attribute::new("weight", NumberType::U64),
            Attribute::new("weights", NumberType::F64),
        ];
        others.into_iter().for_each(|other| assert!(header(vec![other]).check().is_err()));
        let of = |header: Header| Header { weighted: Some(Weighted { greatest: 2.5 }), ..header };
        assert!(of(header(Vec::new())).check().is_err());
        let plane = Header { dims: 2, ..header(vec![weight()]) };
        assert!(of(plane).check().is_err());
        let endless = Weighted { greatest: f64::INFINITY };
        assert!(Header { weighted: Some(endless), ..header(vec![weight()]) }.check().is_err());
    }

    #[test]
    fn weights_are_found_in_rows_and_checked() {
        let header = header(vec![Attribute::new("class", NumberType::U8), Weighted::attribute()]);
        let weights = header.weights().expect("the header has weights");
        let rows = |values: &[f64]| -> Vec<u8> {
            values.iter().flat_map(|value| [&[7][..], &value.to_le_bytes()].concat()).collect()
        };
        assert_eq!(weights.read(&rows(&[-1.0, 2.5])).collect::<Vec<_>>(), [-1.0, 2.5]);
        assert!(weights.check(&rows(&[-1e300, 2.5])).is_ok());
        for bad in [2.6, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(weights.check(&rows(&[0.0, bad])).is_err(), "{bad}");
        }
    }
}
