//! Splines at sites: lines of x, y and an attribute.

use std::io::Write;

use super::attributes::Attribute;
use super::layout::Spline;
use spmesh_core::error::{Error, Result};
use spmesh_geometry::predicates::Point2;
use spmesh_io::source::Input;
use spmesh_splines::bases::{Jet, Scratch};

/// Writes a line for each site, in their order. Outside of the domain, where a spline is not extrapolated,
/// the attribute is `nan`. Returns the number of sites, and the number of sites outside.
///
/// # Errors
/// If sites cannot be read, or lines cannot be written.
pub fn write_values(
    spline: &Spline,
    attribute: Attribute,
    sites: &Input,
    output: &mut impl Write,
    mut done: impl FnMut(u64),
) -> Result<[u64; 2]> {
    let (mut count, mut outside) = (0, 0);
    let (mut reader, mut batch) = (sites.read()?, Vec::new());
    let (mut scratch, mut text) = (Scratch::default(), Vec::new());
    let coordinates = sites.description().coordinates;
    loop {
        reader.next_batch(&mut batch)?;
        if batch.is_empty() {
            return Ok([count, outside]);
        }
        text.clear();
        for &stored in &batch {
            let [x, y, _] = coordinates.to_world(stored);
            let jet = spline.jet([x, y], attribute, &mut scratch);
            outside += u64::from(jet.is_none());
            let [x, y, _] = coordinates.to_decimal(stored);
            line(&mut text, [x, y], attribute, jet.as_ref());
        }
        count += batch.len() as u64;
        output.write_all(&text).map_err(write_error)?;
        done(count);
    }
}

/// Appends a line of a table.
pub(super) fn line(text: &mut Vec<u8>, [x, y]: Point2, attribute: Attribute, jet: Option<&Jet>) {
    let mut push = |word: String| text.extend_from_slice(word.as_bytes());
    push(format!("{x} {y}"));
    match jet {
        Some(jet) => attribute.all(jet).for_each(|number| push(format!(" {}", Number(number)))),
        None => attribute.columns().iter().for_each(|_| push(" nan".into())),
    }
    text.push(b'\n');
}

/// A number in a table.
struct Number(f64);

impl std::fmt::Display for Number {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.0.is_nan() { f.write_str("nan") } else { self.0.fmt(f) }
    }
}

impl Spline {
    /// The jet that an attribute needs at a world point, in world coordinates; `None` outside of the domain.
    pub(super) fn jet(&self, world: Point2, attribute: Attribute, scratch: &mut Scratch) -> Option<Jet> {
        let (basis, frame) = (&self.layout.basis, &self.layout.frame);
        let at = frame.to_stored(world);
        if !basis.is_in_domain(at) {
            return None;
        }
        Some(match attribute {
            Attribute::Value => Jet::constant(basis.value(&self.coefficients, at, scratch)),
            Attribute::Gradient => frame.jet_to_world(basis.jet(&self.coefficients, at, scratch)),
            _ => frame.jet_in_one_unit(basis.jet(&self.coefficients, at, scratch)),
        })
    }
}

pub(super) fn write_error(error: std::io::Error) -> Error {
    Error::io("writing values", error)
}
