//! Decodes payloads of blocks, and checks them as far as the header and earlier counts allow.

use byteorder::{ByteOrder, LittleEndian as LE};

use super::block::whole_records;
use super::coordinates::Coordinates;
use super::event::{Patch, Totals};
use super::header::Header;
use super::part::check_residual_id;
use crate::model::bounds::{Bounds, Point};
use crate::model::cells::CellCode;
use spmesh_base::error::{Error, Result};

/// The id of a residual point that is not yet a vertex.
const NO_VERTEX: u64 = u64::MAX;

/// Length of the counts before the arrays of a patch, in bytes.
pub(super) const PATCH_FIXED_LEN: usize = 24;

/// Replaces `points` by those of a block; returns their bounding box, if there are any.
pub(super) fn points(header: &Header, bytes: &[u8], points: &mut Vec<Point>) -> Result<Option<Bounds>> {
    points.clear();
    let _ = whole_records(bytes, header.point_len())?;
    decoder(header)(bytes, points);
    check_places(header, points)
}

/// Appends the points of whole records: `N` coordinates of `WIDTH` bytes each.
fn decode<const WIDTH: usize, const N: usize>(bytes: &[u8], points: &mut Vec<Point>) {
    points.extend(bytes.chunks_exact(WIDTH * N).map(|record| {
        let mut point = [0.0; 3];
        for (value, bytes) in point.iter_mut().zip(record.chunks_exact(WIDTH)) {
            *value = if WIDTH == 8 { LE::read_f64(bytes) } else { f64::from(LE::read_i32(bytes)) };
        }
        point
    }));
}

/// Checks that points lie where the header says, by their bounding box; returns the box.
fn check_places(header: &Header, points: &[Point]) -> Result<Option<Bounds>> {
    let Some((bounds, finite)) = extent(points) else { return Ok(None) };
    if !finite || check_place(header, bounds.min).is_err() || check_place(header, bounds.max).is_err() {
        points.iter().try_for_each(|&point| check_point(header, point))?;
    }
    Ok(Some(bounds))
}

/// Bounding box of points, and whether all coordinates are finite; if not, the box may miss points.
fn extent(points: &[Point]) -> Option<(Bounds, bool)> {
    let Bounds { mut min, mut max } = Bounds::of_point(*points.first()?);
    // Zero times infinity or NaN is NaN, and a sum with NaN stays NaN.
    let mut poison = [0.0; 3];
    for point in points {
        for axis in 0..3 {
            let value = point[axis];
            min[axis] = if value < min[axis] { value } else { min[axis] };
            max[axis] = if value > max[axis] { value } else { max[axis] };
            poison[axis] += value * 0.0;
        }
    }
    Some((Bounds { min, max }, poison.iter().all(|sum| *sum == 0.0)))
}

pub(super) fn cells(header: &Header, bytes: &[u8]) -> Result<Vec<CellCode>> {
    let Some(tree) = &header.tree else {
        return Err(Error::malformed("cell tag in a stream without a finalization tree"));
    };
    whole_records(bytes, 8)?
        .map(|record| {
            let cell = CellCode(LE::read_u64(record));
            if tree.is_valid(cell) {
                Ok(cell)
            } else {
                Err(Error::malformed(format!("location code {} is not a cell of the tree", cell.0)))
            }
        })
        .collect()
}

/// Decodes a patch; `vertices_before` vertices were written by earlier patches.
pub(super) fn patch(header: &Header, vertices_before: u64, bytes: &[u8]) -> Result<Patch> {
    if bytes.len() < PATCH_FIXED_LEN {
        return Err(Error::malformed(format!(
            "patch of {} bytes, expected at least {PATCH_FIXED_LEN}",
            bytes.len()
        )));
    }
    let per_simplex = header.kind.vertices_per_simplex();
    let mut rest = &bytes[PATCH_FIXED_LEN..];
    let mut array = |at: usize, record_len: usize| {
        let len = u64::from(LE::read_u32(&bytes[at..])) * record_len as u64;
        let (array, after) = usize::try_from(len).ok().and_then(|len| rest.split_at_checked(len))?;
        rest = after;
        Some(array)
    };
    let arrays = (array(8, header.point_len()), array(12, 8), array(16, per_simplex * 4), array(20, 4));
    let ((Some(new), Some(imported), Some(simplices), Some(finalized)), true) = (arrays, rest.is_empty())
    else {
        return Err(Error::malformed("the counts of the patch do not add up to its length"));
    };
    let locals = |bytes: &[u8]| bytes.chunks_exact(4).map(LE::read_u32).collect();
    let mut new_points = Vec::with_capacity(new.len() / header.point_len());
    points(header, new, &mut new_points)?;
    let patch = Patch {
        first_id: LE::read_u64(bytes),
        new: new_points,
        imported: imported.chunks_exact(8).map(LE::read_u64).collect(),
        simplices: locals(simplices),
        finalized: locals(finalized),
        ..Patch::default()
    };
    patch.check(vertices_before, per_simplex)?;
    Ok(patch)
}

/// Decodes labels; [`super::Tally`] compares their number with the number of vertices.
pub(super) fn labels(bytes: &[u8]) -> Result<Vec<u64>> {
    Ok(whole_records(bytes, 8)?.map(LE::read_u64).collect())
}

/// Decodes residual points; their ids must be among the `vertices` earlier vertices, or, in a residual of its
/// own, those of parts up to this one.
pub(super) fn residual_points(
    header: &Header,
    vertices: u64,
    bytes: &[u8],
) -> Result<Vec<(Option<u64>, Point)>> {
    whole_records(bytes, 8 + header.point_len())?
        .map(|record| {
            let id = LE::read_u64(record);
            if id != NO_VERTEX {
                check_residual_id(header, vertices, id)?;
            }
            Ok(((id != NO_VERTEX).then_some(id), point(header, &record[8..])?))
        })
        .collect()
}

/// Decodes walls of `corners` corners each, concatenated, between the first `residual_points` residual
/// points.
pub(super) fn walls(corners: usize, residual_points: u64, bytes: &[u8]) -> Result<Vec<u32>> {
    let walls: Vec<u32> = whole_records(bytes, 4 * corners)?
        .flat_map(|record| record.chunks_exact(4).map(LE::read_u32))
        .collect();
    for wall in walls.chunks_exact(corners) {
        let is_known = wall.iter().all(|&corner| u64::from(corner) < residual_points);
        if !is_known || (1..corners).any(|i| wall[..i].contains(&wall[i])) {
            let names: Vec<String> = wall.iter().map(u32::to_string).collect();
            let message = format!("wall {} between no {corners} residual points", names.join(" to "));
            return Err(Error::malformed(message));
        }
    }
    Ok(walls)
}

pub(super) fn totals(bytes: &[u8]) -> Result<Totals> {
    let fields: Vec<u64> = whole_records(bytes, 8)?.map(LE::read_u64).collect();
    match <[u64; 7]>::try_from(fields) {
        Ok(fields) => Ok(Totals::from_fields(fields)),
        Err(_) => Err(Error::malformed(format!("END of {} bytes, expected 56", bytes.len()))),
    }
}

/// Decodes a point, and checks that it lies where the header says.
fn point(header: &Header, record: &[u8]) -> Result<Point> {
    let mut point = [0.0; 3];
    let width = header.coordinates.width();
    for (value, bytes) in point.iter_mut().zip(record.chunks_exact(width)) {
        *value = match header.coordinates {
            Coordinates::F64 => LE::read_f64(bytes),
            Coordinates::I32 { .. } => f64::from(LE::read_i32(bytes)),
        };
    }
    check_point(header, point)?;
    Ok(point)
}

/// Appends points that this process encoded with [`super::encode_points`]; they are not checked.
pub fn decode_points(header: &Header, bytes: &[u8], points: &mut Vec<Point>) {
    decoder(header)(bytes, points);
}

/// What appends the points of whole records.
fn decoder(header: &Header) -> fn(&[u8], &mut Vec<Point>) {
    match (header.coordinates, header.coordinates_per_point()) {
        (Coordinates::F64, 2) => decode::<8, 2>,
        (Coordinates::F64, _) => decode::<8, 3>,
        (Coordinates::I32 { .. }, 2) => decode::<4, 2>,
        (Coordinates::I32 { .. }, _) => decode::<4, 3>,
    }
}

fn check_point(header: &Header, point: Point) -> Result<()> {
    if let Some(value) = point.iter().find(|value| !value.is_finite()) {
        return Err(Error::malformed(format!("coordinate {value} is not finite")));
    }
    check_place(header, point)
}

/// Checks that a point lies in the bounding box, the tree and the region of the header.
///
/// # Errors
/// Malformed, if it lies outside of one of them.
pub fn check_place(header: &Header, point: Point) -> Result<()> {
    let outside_of = if header.bounds.is_some_and(|bounds| !bounds.contains(point)) {
        "the header's bounding box"
    } else if header.tree.is_some_and(|tree| !tree.contains(point)) {
        "the finalization tree"
    } else if header.region.is_some_and(|region| !region.contains(point)) {
        "the region"
    } else {
        return Ok(());
    };
    Err(Error::malformed(format!("point {point:?} lies outside of {outside_of}")))
}
