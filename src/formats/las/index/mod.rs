//! Partial reading: which records of a LAS file are needed for a box, by an index in the file or beside it.
//!
//! An index is believed only as far as the records agree with it, so that a wrong one loses no points.

pub(crate) mod copc;
pub(crate) mod hierarchy;
pub(crate) mod lax;
pub(crate) mod lax_file;
pub(crate) mod lax_tree;
pub(crate) mod parts;
pub(crate) mod steps;

use std::sync::Arc;

use crate::las::header::LasHeader;
use crate::las::laz_chunks::{Chunk, Chunks};
use crate::source::origin::{FileView, Origin};
use crate::source::records::raw_point;
use lax::Lax;
pub(crate) use parts::{Part, check_records, chunks_of_parts, ranges_of_parts};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::{Bounds, Point};

/// Records from one test of an index to the next in a file without chunks.
const TEST_DISTANCE: usize = 50_000;

/// The parts of a file that can have points in `reach`, a closed box of the world; `None` if no index tells.
/// An index of LAStools that does not fit the file is left out with a notice.
///
/// Cost: the chunk table, the index, and the first record of each chunk.
pub(crate) fn find_parts(
    origin: &Origin,
    header: &LasHeader,
    reach: &Bounds,
    notices: &mut Vec<String>,
) -> Result<Option<Arc<[Part]>>> {
    let file = origin.view()?;
    // An index may be cut off where points are not, and salvage wants all of them.
    if header.points == 0 || header.is_salvaged {
        return Ok(None);
    }
    let Some(laszip) = &header.laz else {
        let tests = (0..header.points).step_by(TEST_DISTANCE);
        let tests = tests.map(|number| (number, header.points_start + number * header.record_len as u64));
        return Ok(parts_by_lax(origin, &file, header, reach, tests.collect(), notices));
    };
    let Chunks::Table(chunks) = Chunks::find(&file, header, laszip)? else { return Ok(None) };
    if let Some(info) = &header.indices.copc {
        return copc::find_parts(&file, header, info, &chunks, reach).map(|parts| Some(parts.into()));
    }
    // A chunk starts with a record that is not compressed.
    let tests = chunks.iter().map(|chunk| (chunk.first, chunk.start)).collect();
    Ok(parts_by_lax(origin, &file, header, reach, tests, notices))
}

/// As `find_parts`, by an index of LAStools. `tests` are the numbers of records, and the bytes at which they are
/// stored without compression.
fn parts_by_lax(
    origin: &Origin,
    file: &FileView,
    header: &LasHeader,
    reach: &Bounds,
    tests: Vec<(u64, u64)>,
    notices: &mut Vec<String>,
) -> Option<Arc<[Part]>> {
    let (name, content) = lax_file::find(origin, file, header)?;
    let select = || -> Result<Vec<Part>> {
        let lax = Lax::read(&content?)?;
        lax.check(header)?;
        let read = |(number, at): (u64, u64)| Ok((number, stored_point(file, at)?));
        lax.test(header, &tests.into_iter().map(read).collect::<Result<Vec<_>>>()?)?;
        let reach = steps::outward(&header.coordinates, reach, [0.0; 3]);
        Ok(lax.parts(&header.coordinates, &reach))
    };
    match select() {
        Ok(parts) => Some(parts.into()),
        Err(error) => {
            notices.push(format!(
                "{name} is left out, all points are read: {error} (lasindex writes a new one)"
            ));
            None
        }
    }
}

/// The stored coordinates of the record at a byte of the file.
fn stored_point(file: &FileView, at: u64) -> Result<Point> {
    let mut bytes = [0; 12];
    file.read_at(at, &mut bytes).map_err(|e| Error::io("reading a record", e).at(format!("byte {at}")))?;
    Ok(raw_point(&bytes))
}

/// Whether two closed boxes have a point in common.
fn meet(a: &Bounds, b: &Bounds) -> bool {
    (0..3).all(|axis| a.min[axis] <= b.max[axis] && b.min[axis] <= a.max[axis])
}

/// The error of a file whose COPC index contradicts it.
fn wrong_index(what: impl std::fmt::Display) -> Error {
    Error::malformed(format!("the COPC index of the file is wrong: {what}"))
        .noting("write the file again as LAZ without the index")
}

/// The chunk that starts at a byte.
fn chunk_at(chunks: &[Chunk], start: u64) -> Option<usize> {
    chunks.binary_search_by_key(&start, |chunk| chunk.start).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_that_share_a_side_meet() {
        let infinite = f64::INFINITY;
        let a = Bounds { min: [0.0, 0.0, -infinite], max: [4.0, 4.0, infinite] };
        let beside = |x: f64, z: f64| Bounds { min: [x, 4.0, z], max: [x, 9.0, z] };
        for (b, do_meet) in
            [(beside(4.0, 7.0), true), (beside(0.0, infinite), true), (beside(5.0, 7.0), false)]
        {
            assert_eq!((meet(&a, &b), meet(&b, &a)), (do_meet, do_meet), "{b:?}");
        }
    }
}
