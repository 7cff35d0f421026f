//! The collocation matrix: all functions of a basis at sites.

use std::io::Write;
use std::path::Path;

use super::layout::Layout;
use super::sites::for_each_site;
use crate::bases::Scratch;
use spmesh_base::error::Result;
use spmesh_formats::sink::{MatrixFormat, SparseRows};
use spmesh_formats::source::Input;

/// What a collocation matrix has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CollocationCounts {
    /// Rows: the number of sites.
    pub sites: u64,
    /// Rows without entries: the number of sites outside of the domain.
    pub outside: u64,
    /// Columns: the number of functions.
    pub functions: usize,
    /// Entries that are not zero.
    pub entries: u64,
}

/// Writes the matrix with a row for each site, in their order, and a column for each function: the values of
/// functions at sites. Times the coefficients of a spline it is the values of the spline. Rows of sites
/// outside of the domain are empty.
///
/// Cost: one pass over the sites; the entries wait in temporary files in `temp_dir`, see
/// [`SparseRows`].
///
/// # Errors
/// If sites cannot be read, or the matrix cannot be written.
pub fn write_collocation(
    layout: &Layout,
    sites: &Input,
    format: MatrixFormat,
    temp_dir: Option<&Path>,
    output: &mut impl Write,
    done: impl FnMut(u64),
) -> Result<CollocationCounts> {
    let (basis, mut scratch) = (&layout.basis, Scratch::default());
    let mut matrix = SparseRows::new(basis.len() as u64, temp_dir)?;
    let [sites, outside] = for_each_site(sites, done, |site| {
        let at = layout.frame.to_stored(site.world);
        let is_inside = basis.is_in_domain(at);
        matrix.push(if is_inside { basis.at(at, &mut scratch) } else { &[] })?;
        Ok(is_inside)
    })?;
    let entries = matrix.entries();
    matrix.finish(format, output)?;
    Ok(CollocationCounts { sites, outside, functions: basis.len(), entries })
}
