//! The line of a region of points in a text twin (`formats/text.md`).

use crate::twin::tokens::{next_field, parse_integer, unexpected};
use crate::twin::write::numbers;
use spmesh_base::error::Result;
use spmesh_stream::PointRegion;
use spmesh_stream::model::bounds::Region;

/// The fields of the line: the box in stored coordinates, and the counts.
pub(crate) fn region_fields(region: &PointRegion) -> String {
    let PointRegion { bounds: Region { min, max }, own, first, again, last } = region;
    format!("{} {} {own} {first} {again} {last}", numbers(min), numbers(max))
}

/// The region that these fields state.
pub(crate) fn parse_point_region<'a>(fields: &mut impl Iterator<Item = &'a [u8]>) -> Result<PointRegion> {
    let mut bounds = Region::EVERYTHING;
    for side in bounds.min.iter_mut().chain(&mut bounds.max) {
        let field = next_field(fields)?;
        let number = std::str::from_utf8(field).ok().and_then(|text| text.parse().ok());
        *side = number.ok_or_else(|| unexpected(field, "a number or inf"))?;
    }
    let mut count = || parse_integer(next_field(fields)?);
    Ok(PointRegion { bounds, own: count()?, first: count()?, again: count()?, last: count()? })
}
