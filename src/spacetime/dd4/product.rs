//! The products of a diagram.

use std::io::Write;

use super::{Placement, write_diagram, write_simplices, write_slice, write_surface, write_values};
use crate::slices::{Interpolator, NO_VALUES, Rule, Slice, first_time, isosurface, slice, subdivide};
use spmesh_base::error::{Error, Result};
use spmesh_formats::drivers::Format;
use spmesh_stream::model::cells4::Point4;
use spmesh_stream::model::diagram4::Diagram4;

/// The output made of a diagram.
#[derive(Debug, Clone, PartialEq)]
pub enum Product {
    /// The cells.
    Cells,
    /// Simplices.
    Simplices(Rule),
    /// Values at sites.
    Values(Vec<Point4>),
    /// Tetrahedra at a time.
    Slice {
        /// The time.
        time: f64,
        /// VTU or Medit.
        format: Format,
    },
    /// A surface of equal value at a time.
    Isosurface {
        /// The time.
        time: f64,
        /// The value.
        level: f64,
        /// Any format.
        format: Format,
    },
}

impl Product {
    /// Checks that the product can be made of these points, before the computation.
    ///
    /// # Errors
    /// Usage, if values are needed and the points have none, or a slice is at a time before or after all
    /// points.
    pub fn check(&self, points: &[Point4], has_values: bool) -> Result<()> {
        if matches!(self, Product::Values(_) | Product::Isosurface { .. }) && !has_values {
            return Err(Error::usage(NO_VALUES));
        }
        match self {
            Product::Slice { time, .. } | Product::Isosurface { time, .. } if !points.is_empty() => {
                first_time(points, *time).map(drop)
            }
            _ => Ok(()),
        }
    }

    /// Whether the output is binary.
    pub fn is_binary(&self) -> bool {
        match self {
            Product::Cells | Product::Simplices(_) => true,
            Product::Values(_) => false,
            Product::Slice { format, .. } | Product::Isosurface { format, .. } => format.is_binary(),
        }
    }

    /// Whether the output is a stream.
    pub fn is_stream(&self) -> bool {
        matches!(self, Product::Cells | Product::Simplices(_))
    }

    /// Makes the product of a diagram and writes it, a stream compressed if `compress` says so. Times, sites
    /// and meshes in space are in coordinates of the input. Returns notices for the user.
    ///
    /// # Errors
    /// Usage, if values are needed and the points have none, the slice is at a time before or after all
    /// points, or the format cannot hold it; I/O. The output is then incomplete.
    pub fn write(
        &self,
        diagram: &Diagram4,
        placement: &Placement,
        compress: bool,
        output: &mut impl Write,
    ) -> Result<Vec<String>> {
        match self {
            Product::Cells => write_diagram(diagram, compress, output).map(|()| placement.stream_notices()),
            Product::Simplices(rule) => {
                let (points, values) = (&diagram.points, diagram.values.as_deref());
                let parts = subdivide(points, values, &diagram.cells, *rule, |_| true)?;
                write_simplices(&parts, diagram.merged, compress, output)?;
                Ok(flat_notice(parts.flat).into_iter().chain(placement.stream_notices()).collect())
            }
            Product::Values(sites) => {
                let values = interpolate(diagram, placement, sites)?;
                write_values(sites, &values, output)?;
                Ok(outside_notice(&values).into_iter().collect())
            }
            Product::Slice { time, format } => {
                let mut slice = slice(diagram, placement.time(*time))?;
                placement.place_slice(&mut slice, *time);
                let mut notices = slice_notices(&slice);
                notices.extend(write_slice(&slice, *format, output)?);
                Ok(notices)
            }
            Product::Isosurface { time, level, format } => {
                let mut slice = slice(diagram, placement.time(*time))?;
                let mut surface = isosurface(&slice, *level)?;
                placement.place_slice(&mut slice, *time);
                placement.place_surface(&mut surface);
                let mut notices = slice_notices(&slice);
                if surface.triangles.is_empty() && !slice.tetrahedra.is_empty() {
                    notices.push(empty_notice(&slice, *level));
                }
                write_surface(&surface, *format, output)?;
                Ok(notices)
            }
        }
    }
}

fn interpolate(diagram: &Diagram4, placement: &Placement, sites: &[Point4]) -> Result<Vec<Option<f64>>> {
    let mut interpolator = Interpolator::new(diagram)?;
    sites.iter().map(|&site| interpolator.value(placement.site(site))).collect()
}

fn flat_notice(flat: u64) -> Option<String> {
    (flat > 0).then(|| format!("{flat} simplices are flat, because barycentres are rounded: left out"))
}

fn outside_notice(values: &[Option<f64>]) -> Option<String> {
    let outside = values.iter().filter(|value| value.is_none()).count();
    let verb = if outside == 1 { "is" } else { "are" };
    let message = "outside of the convex hull of the points: nan";
    (outside > 0).then(|| format!("{outside} of {} sites {verb} {message}", values.len()))
}

fn slice_notices(slice: &Slice) -> Vec<String> {
    let is_empty = slice.tetrahedra.is_empty();
    let empty =
        is_empty.then(|| format!("the slice is empty: the points span no volume at time {}", slice.time));
    empty.into_iter().chain(flat_notice(slice.flat)).collect()
}

fn empty_notice(slice: &Slice, level: f64) -> String {
    let values = slice.values.iter().flatten().filter(|value| !value.is_nan());
    let range = values.fold(None, |range: Option<(f64, f64)>, &value| {
        Some(range.map_or((value, value), |(least, most)| (least.min(value), most.max(value))))
    });
    match range {
        Some((least, most)) => {
            format!("the surface is empty: values in the slice go from {least} to {most}, not across {level}")
        }
        None => "the surface is empty: no values in the slice are known".into(),
    }
}
