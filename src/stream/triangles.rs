//! Writes triangles in memory, with their vertices, as a triangle mesh stream.

use std::io::Write;

use super::{Header, Patch, StreamWriter};
use crate::model::bounds::Point;
use spmesh_base::error::Result;

/// Triangles per patch. A triangle with three new vertices takes at most 3 * (4 + 24 + 4) bytes, so a patch
/// stays below the maximum length of a block.
const PATCH_TRIANGLES: usize = 8000;

/// The id of a vertex that no patch has written yet.
const NONE: u64 = u64::MAX;

/// Writes all triangles, in their order, with the vertices that they use. Vertices are numbered below
/// `count`; `at` gives their stored coordinates.
///
/// Domain: every vertex is used, except `merged` of them.
///
/// # Errors
/// If writing fails.
pub fn write_triangles(
    header: Header,
    triangles: &[[u32; 3]],
    count: usize,
    merged: u64,
    at: impl Fn(u32) -> Point,
    output: impl Write,
) -> Result<()> {
    let mut writer = StreamWriter::new(output, header)?;
    let mut last_patches = vec![0u32; count];
    for (number, triangles) in (0..).zip(triangles.chunks(PATCH_TRIANGLES)) {
        triangles.as_flattened().iter().for_each(|&v| last_patches[v as usize] = number);
    }
    let mut ids = vec![NONE; count];
    for (number, triangles) in (0..).zip(triangles.chunks(PATCH_TRIANGLES)) {
        let is_last = |v: u32| last_patches[v as usize] == number;
        writer.patch(&patch(triangles, writer.totals().vertices, &mut ids, is_last, &at))?;
    }
    writer.end(count as u64, merged).map(drop)
}

/// The patch of some triangles; `first_id` vertices were written before.
fn patch(
    triangles: &[[u32; 3]],
    first_id: u64,
    ids: &mut [u64],
    is_last: impl Fn(u32) -> bool,
    at: impl Fn(u32) -> Point,
) -> Patch {
    let (mut new, mut imported) = (Vec::new(), Vec::new());
    for &v in triangles.as_flattened() {
        let id = &mut ids[v as usize];
        if *id == NONE {
            *id = first_id + new.len() as u64;
            new.push(v);
        } else if *id < first_id {
            imported.push((*id, v));
        }
    }
    imported.sort_unstable();
    imported.dedup();
    let local = |&v: &u32| match ids[v as usize].checked_sub(first_id) {
        Some(new) => new as u32,
        None => (new.len() + imported.partition_point(|&(id, _)| id < ids[v as usize])) as u32,
    };
    let simplices = triangles.as_flattened().iter().map(local).collect();
    let vertices = new.iter().copied().chain(imported.iter().map(|&(_, v)| v));
    let finalized = (0..).zip(vertices).filter(|&(_, v)| is_last(v)).map(|(local, _)| local).collect();
    Patch {
        first_id,
        new: new.into_iter().map(at).collect(),
        imported: imported.into_iter().map(|(id, _)| id).collect(),
        simplices,
        finalized,
        ..Patch::default()
    }
}
