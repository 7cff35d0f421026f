//! Lines of the text twin about what constrains a triangle mesh.

use std::io::Write;

use crate::sink::world::write_numbers;
use crate::sink::write_error;
use spmesh_base::error::Result;
use spmesh_stream::{Coordinates, Segment};

/// Writes the lines of segments.
pub(crate) fn segments(
    output: &mut impl Write,
    coordinates: &Coordinates,
    segments: &[Segment],
) -> Result<()> {
    for Segment { line, ends } in segments {
        let [[x0, y0, _], [x1, y1, _]] = ends.map(|[x, y]| coordinates.to_decimal([x, y, 0.0]));
        write_numbers(output, &format!("segment {line}"), &[x0, y0, x1, y1])?;
    }
    Ok(())
}

/// Writes the lines of the sides of a patch, behind the lines of its triangles; `first` triangles were
/// written before these.
pub(crate) fn sides(output: &mut impl Write, first: u64, sides: &[[u32; 3]]) -> Result<()> {
    for [triangle, place, segment] in sides.iter().map(|side| side.map(u64::from)) {
        let (triangle, place, segment) = (first + triangle + 1, place + 1, segment + 1);
        writeln!(output, "side {triangle} {place} {segment}").map_err(write_error)?;
    }
    Ok(())
}

/// Writes the lines of segments that leave the mesh.
pub(crate) fn open_segments(output: &mut impl Write, segments: &[u32]) -> Result<()> {
    segments
        .iter()
        .try_for_each(|&segment| writeln!(output, "open {}", u64::from(segment) + 1).map_err(write_error))
}
