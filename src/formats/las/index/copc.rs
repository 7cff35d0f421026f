//! The parts of a COPC file in a box: each node of its octree is a chunk.
//!
//! Source: COPC specification 1.0, copc.io. Beyond it, the reader tests that the first record of each chunk,
//! which is not compressed, lies in the cube of its node: else a wrong key would hide the chunk.

use std::ops::Range;

use crate::las::header::LasHeader;
use crate::las::index::hierarchy::{Key, Node, read_nodes};
use crate::las::index::parts::Part;
use crate::las::index::{chunk_at, meet, steps, stored_point, wrong_index};
use crate::las::laz_chunks::Chunk;
use crate::source::origin::FileView;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::{Bounds, Point};

/// Length of the info record.
const INFO_LEN: usize = 160;

/// Byte of it from which it states the place of the hierarchy.
const ROOT_AT: u64 = 40;

/// How many steps of the file's grid a point may lie outside of the cube of its node: writers round
/// coordinates before or after they choose the node.
const SLACK: Point = [1.0; 3];

/// What the info record states.
struct Info {
    center: Point,
    half_side: f64,
    /// Bytes of the first page of the hierarchy.
    root: Range<u64>,
}

/// The chunks of which the node reaches `reach`, a closed box of the world.
pub(crate) fn find_parts(
    file: &FileView,
    header: &LasHeader,
    info: &Range<u64>,
    chunks: &[Chunk],
    reach: &Bounds,
) -> Result<Vec<Part>> {
    let info = Info::read(file, info)?;
    let keys = keys_of_chunks(&read_nodes(file, info.root.clone())?, chunks)?;
    let reach = steps::outward(&header.coordinates, reach, [0.0; 3]);
    let mut parts = Vec::new();
    for (chunk, key) in chunks.iter().zip(keys) {
        let cube = steps::outward(&header.coordinates, &info.cube(key), SLACK);
        if meet(&cube, &reach) {
            parts.push(Part { records: chunk.first..chunk.after(), within: Some(cube) });
        } else if !cube.contains(stored_point(file, chunk.start)?) {
            let what = format!("the record lies outside of {}", key.describe());
            return Err(wrong_index(what).at(format!("record {}", chunk.first)));
        }
    }
    Ok(parts)
}

/// Checks that the first page of the hierarchy is in the file. Cost: one read, also where no box is wanted.
pub(crate) fn check_root(file: &FileView, info: &Range<u64>) -> Result<()> {
    if info.end - info.start != INFO_LEN as u64 {
        return Ok(());
    }
    let mut bytes = [0; 16];
    let at = |error: Error| error.at(format!("COPC record at byte {}", info.start));
    file.read_at(info.start + ROOT_AT, &mut bytes).map_err(|e| at(Error::io("reading", e)))?;
    let (numbers, _) = bytes.as_chunks::<8>();
    root_page([0, 1].map(|index| u64::from_le_bytes(numbers[index])), file.len()).map(drop).map_err(at)
}

/// The bytes of the first page of the hierarchy, stated as the first one and their number.
fn root_page([start, len]: [u64; 2], file_len: u64) -> Result<Range<u64>> {
    let end = start.checked_add(len).filter(|&end| end <= file_len).ok_or_else(|| {
        wrong_index(format!(
            "a hierarchy of {len} bytes at byte {start}, beyond the end of the file at byte {file_len}"
        ))
    })?;
    Ok(start..end)
}

/// The node of each chunk.
fn keys_of_chunks(nodes: &[Node], chunks: &[Chunk]) -> Result<Vec<Key>> {
    let mut keys = vec![None; chunks.len()];
    for node in nodes.iter().filter(|node| node.points > 0) {
        let Node { key, start, len, points } = *node;
        let index = chunk_at(chunks, start).filter(|&index| {
            let chunk = &chunks[index];
            chunk.points == points && chunk.len == len
        });
        let Some(index) = index else {
            return Err(wrong_index(format!(
                "{} has {points} points in {len} bytes at byte {start}, the file has no such chunk",
                key.describe()
            )));
        };
        if let Some(other) = keys[index].replace(key) {
            let (one, other) = (key.describe(), other.describe());
            return Err(wrong_index(format!("{one} and {other} have the same points")));
        }
    }
    let named = |(key, chunk): (Option<Key>, &Chunk)| {
        key.ok_or_else(|| wrong_index("no node has the points").at(chunk.describe()))
    };
    keys.into_iter().zip(chunks).map(named).collect()
}

impl Info {
    fn read(file: &FileView, record: &Range<u64>) -> Result<Info> {
        let at = |error: Error| error.at(format!("COPC record at byte {}", record.start));
        if record.end - record.start != INFO_LEN as u64 {
            let len = record.end - record.start;
            return Err(at(wrong_index(format!("a record of {len} bytes, expected {INFO_LEN}"))));
        }
        let mut bytes = [0; INFO_LEN];
        file.read_at(record.start, &mut bytes).map_err(|e| at(Error::io("reading", e)))?;
        let (numbers, _) = bytes.as_chunks::<8>();
        let float = |index: usize| f64::from_le_bytes(numbers[index]);
        let count = |index: usize| u64::from_le_bytes(numbers[index]);
        let (center, half_side) = ([float(0), float(1), float(2)], float(3));
        if ![half_side, center[0], center[1], center[2]].iter().all(|x| x.is_finite()) || half_side <= 0.0 {
            return Err(at(wrong_index(format!("a cube around {center:?} with half a side of {half_side}"))));
        }
        let root = root_page([count(5), count(6)], file.len()).map_err(at)?;
        Ok(Info { center, half_side, root })
    }

    /// The cube of a node, in the world.
    fn cube(&self, key: Key) -> Bounds {
        let side = 2.0 * self.half_side / (1u64 << key.level) as f64;
        let border = |axis: usize, number: u32| self.center[axis] - self.half_side + f64::from(number) * side;
        Bounds {
            min: std::array::from_fn(|axis| border(axis, key.position[axis])),
            max: std::array::from_fn(|axis| border(axis, key.position[axis]) + side),
        }
    }
}
