//! Lists of points with residuals: tables of x, y, elevation and residual.

use std::io::Write;
use std::num::NonZeroUsize;

use super::layout::Spline;
use super::points::{Cursor, Points};
use super::table;
use crate::fitting::{self, Residual, RobustFit};
use spmesh_base::error::Result;

/// The columns of a list.
const COLUMNS: [&str; 4] = ["x", "y", "z", "residual"];

/// Writes all points in the domain with their residuals. Returns their number.
///
/// # Errors
/// If points cannot be read, or the list cannot be written.
pub fn write_residuals(
    spline: &Spline,
    points: &Points,
    threads: NonZeroUsize,
    output: &mut impl Write,
) -> Result<u64> {
    let all = points.in_frame(&spline.layout.frame, &|_| ());
    let mut list = List::new(points, output)?;
    let (basis, coefficients) = (&spline.layout.basis, &spline.coefficients);
    fitting::for_each_residual(basis, coefficients, &all, threads, |found| list.push(&found))?;
    list.finish()
}

/// Writes the points that a robust fit rejects. Returns their number.
pub(super) fn write_rejected(
    fit: &RobustFit,
    spline: &Spline,
    points: &Points,
    threads: NonZeroUsize,
    output: &mut dyn Write,
) -> Result<u64> {
    let all = points.in_frame(&spline.layout.frame, &|_| ());
    let mut list = List::new(points, output)?;
    fit.rejected(&spline.layout.basis, &all, threads, |found| list.push(&found))?;
    list.finish()
}

struct List<'a> {
    cursor: Cursor<'a>,
    output: &'a mut dyn Write,
    /// The number of lines written, or the first error.
    written: Result<u64>,
}

impl<'a> List<'a> {
    fn new(points: &'a Points, output: &'a mut dyn Write) -> Result<List<'a>> {
        table::write_title(output, &COLUMNS)?;
        Ok(List { cursor: Cursor::new(points)?, output, written: Ok(0) })
    }

    fn push(&mut self, found: &Residual) {
        let Ok(count) = self.written else { return };
        let line = self.cursor.at(found.index).and_then(|([x, y], z)| {
            writeln!(self.output, "{x} {y} {z} {}", found.residual).map_err(table::write_error)
        });
        self.written = line.map(|()| count + 1);
    }

    fn finish(self) -> Result<u64> {
        self.written
    }
}
