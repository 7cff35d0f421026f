//! Statistics of residuals, and lists of points with residuals.

use std::io::Write;
use std::num::NonZeroUsize;

use super::extent::{Excess, Extent};
use super::layout::Spline;
use super::points::{Cursor, Points};
use super::table;
use crate::fitting::{self, QuantileSketch, Residual, RobustFit};
use spmesh_base::error::Result;
use spmesh_delaunay::predicates::Point2;

/// The quantiles that are reported.
pub const PERCENTILES: [f64; 5] = [0.5, 0.75, 0.9, 0.95, 0.99];

/// Statistics of the residuals (elevation minus value) of the points in the domain.
#[derive(Debug, Clone, PartialEq)]
pub struct Statistics {
    /// Number of points in the domain.
    pub count: u64,
    /// Number of points outside of the domain.
    pub outside: u64,
    /// Mean.
    pub mean: f64,
    /// Root of the mean square.
    pub root_mean_square: f64,
    /// Greatest magnitude.
    pub greatest: f64,
    /// The place of the first point with the greatest magnitude, in world coordinates.
    pub worst: Option<Point2>,
    /// The least and greatest elevation of the points in the domain. Those of weight zero do not count, nor,
    /// unless all are, rejected ones. `None` without points.
    pub range: Option<[f64; 2]>,
    /// The least and the greatest value of the spline; `None` if it has no domain.
    pub extent: Option<Extent>,
    /// Quantiles of magnitudes for [`PERCENTILES`]; the first one is the median. Accuracy: half a percent.
    pub percentiles: [f64; 5],
}

impl Statistics {
    /// How far the spline leaves the range of elevations; `None` if it does not.
    pub fn excess(&self) -> Option<Excess> {
        self.extent?.excess(self.range?)
    }

    /// Computes the statistics of points in one pass.
    ///
    /// # Errors
    /// If points cannot be read.
    pub fn of(
        spline: &Spline,
        points: &Points,
        is_rejected: impl Fn(&Residual) -> bool,
        threads: NonZeroUsize,
        done: &dyn Fn(u64),
    ) -> Result<Statistics> {
        let frame = &spline.layout.frame;
        let (mut count, mut sum, mut square, mut sketch) = (0u64, 0.0, 0.0, QuantileSketch::default());
        let (mut greatest, mut worst, mut range, mut kept) = (0f64, None, None, None);
        let all = points.in_frame(frame, done);
        let (basis, coefficients) = (&spline.layout.basis, &spline.coefficients);
        let outside = fitting::for_each_residual(basis, coefficients, &all, threads, |found| {
            count += 1;
            sum += found.residual;
            square += found.residual * found.residual;
            sketch.add(found.residual);
            // Without the sign of a negative zero.
            let value = found.value + 0.0;
            let with = |range: Option<[f64; 2]>| {
                let [low, high] = range.unwrap_or([value; 2]);
                Some([low.min(value), high.max(value)])
            };
            if found.weight > 0.0 {
                range = with(range);
                if !is_rejected(&found) {
                    kept = with(kept);
                }
            }
            if worst.is_none() || found.residual.abs() > greatest {
                (greatest, worst) = (found.residual.abs(), Some(frame.to_decimal(found.point)));
            }
        })?;
        let divisor = count.max(1) as f64;
        Ok(Statistics {
            count,
            outside,
            mean: sum / divisor,
            root_mean_square: (square / divisor).sqrt(),
            greatest,
            worst,
            range: kept.or(range),
            extent: Extent::of(spline),
            // A class may end above the greatest magnitude, so quantiles are limited to it.
            percentiles: PERCENTILES.map(|part| sketch.quantile(part).unwrap_or(0.0).min(greatest)),
        })
    }
}

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
