//! Splines at sites: a table of x, y and an attribute, or an array of the attribute.

use std::io::Write;
use std::path::Path;

use super::attributes::Attribute;
use super::layout::Spline;
use super::sites::for_each_site;
use super::table;
use crate::bases::{Jet, Scratch};
use spmesh_base::error::Result;
use spmesh_delaunay::predicates::Point2;
use spmesh_formats::sink::NpyRows;
use spmesh_formats::source::Input;

/// Writes a table with a line for each site, in their order. Outside of the domain, where a spline is not
/// extrapolated, the attribute is `nan`. Returns the number of sites, and the number of sites outside.
///
/// # Errors
/// If sites cannot be read, or lines cannot be written.
pub fn write_values(
    spline: &Spline,
    attribute: Attribute,
    sites: &Input,
    output: &mut impl Write,
    done: impl FnMut(u64),
) -> Result<[u64; 2]> {
    table::write_title(output, ["x", "y"].iter().chain(attribute.columns()))?;
    let (mut scratch, mut text) = (Scratch::default(), Vec::new());
    for_each_site(sites, done, |site| {
        let jet = spline.jet(site.world, attribute, &mut scratch);
        text.clear();
        line(&mut text, site.decimal, attribute, jet.as_ref());
        output.write_all(&text).map_err(table::write_error)?;
        Ok(jet.is_some())
    })
}

/// Writes an array of numpy: as [`write_values`], without x and y.
///
/// Shape: (sites,), or (sites, numbers) for attributes of several numbers. The numbers wait in a temporary
/// file in `temp_dir`, or in the system's folder.
///
/// # Errors
/// As [`write_values`].
pub fn write_value_array(
    spline: &Spline,
    attribute: Attribute,
    sites: &Input,
    temp_dir: Option<&Path>,
    output: &mut impl Write,
    done: impl FnMut(u64),
) -> Result<[u64; 2]> {
    let mut scratch = Scratch::default();
    let mut row = vec![f64::NAN; attribute.columns().len()];
    let mut array = NpyRows::new(row.len(), temp_dir)?;
    let counts = for_each_site(sites, done, |site| {
        let jet = spline.jet(site.world, attribute, &mut scratch);
        attribute.fill(jet.as_ref(), &mut row);
        array.push(&row)?;
        Ok(jet.is_some())
    })?;
    array.finish(output)?;
    Ok(counts)
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
            Attribute::Gradient | Attribute::Hessian => {
                frame.jet_to_world(basis.jet(&self.coefficients, at, scratch))
            }
            _ => frame.jet_in_one_unit(basis.jet(&self.coefficients, at, scratch)),
        })
    }
}
