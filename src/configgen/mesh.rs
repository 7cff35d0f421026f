//! Centroid triangulations as triangle mesh streams.

use std::io::Write;

use super::sites::Frame;
use crate::bounds::Point;
use crate::config::{CentroidMesh, Knots};
use crate::error::Result;
use crate::stream::{Coordinates, Header, Kind, Patch, StreamWriter};

/// Triangles per patch. With three vertices of its own each, a triangle takes at most 3 * (4 + 24 + 4) bytes, so a patch
/// stays below the maximum of a block.
const PATCH_TRIANGLES: usize = 8000;

/// Id of a vertex that no patch has so far.
const NONE: u64 = u64::MAX;

/// Writes a centroid triangulation, with the mean of elevations where knots have some.
///
/// Knots on an integer grid have centroids on a grid that is finer by the order, so these are exact, unless they do not fit
/// 32 bits; otherwise centroids are rounded.
///
/// # Errors
/// If writing fails.
pub fn write_centroids(knots: &Knots, frame: &Frame, mesh: &CentroidMesh, output: impl Write) -> Result<()> {
    let placement = Placement::of(knots, frame, mesh.order());
    let points = Some(mesh.vertices.len() as u64);
    let mut writer = StreamWriter::new(output, Header { points, ..placement.header.clone() })?;
    let mut last_patches = vec![0u32; mesh.vertices.len()];
    for (number, triangles) in (0..).zip(mesh.triangles.chunks(PATCH_TRIANGLES)) {
        triangles.as_flattened().iter().for_each(|&v| last_patches[v as usize] = number);
    }
    let mut ids = vec![NONE; mesh.vertices.len()];
    for (number, triangles) in (0..).zip(mesh.triangles.chunks(PATCH_TRIANGLES)) {
        let is_last = |v: u32| last_patches[v as usize] == number;
        let at = |v: u32| placement.centroid(knots, frame, mesh.set(v));
        writer.patch(&patch(triangles, writer.totals().vertices, &mut ids, is_last, at))?;
    }
    writer.end(mesh.vertices.len() as u64, 0).map(drop)
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
    }
}

/// How centroids are stored.
struct Placement {
    header: Header,
    /// On a grid, what is the new origin of stored knots.
    origin: Option<Point>,
}

impl Placement {
    fn of(knots: &Knots, frame: &Frame, order: usize) -> Placement {
        let header = |coordinates| Header {
            crs: frame.crs.clone(),
            producer: concat!("configgen ", env!("CARGO_PKG_VERSION")).to_string(),
            ..Header::new(Kind::TriangleMesh, coordinates, 2, frame.elevations.is_some())
        };
        if let Coordinates::I32 { scale, offset } = frame.coordinates
            && let Some(origin) = origin(knots, frame, order)
        {
            let fine = Coordinates::I32 {
                scale: scale.map(|scale| scale / order as f64),
                offset: std::array::from_fn(|axis| origin[axis] * scale[axis] + offset[axis]),
            };
            let header = header(fine);
            if header.check().is_ok() {
                return Placement { header, origin: Some(origin) };
            }
        }
        Placement { header: header(Coordinates::F64), origin: None }
    }

    /// The centroid of knots, as it is stored.
    fn centroid(&self, knots: &Knots, frame: &Frame, set: &[u32]) -> Point {
        let origin = self.origin.unwrap_or_default();
        let mut sum = [0.0; 3];
        for &id in set {
            let at = stored(knots, frame, id);
            (0..3).for_each(|axis| sum[axis] += at[axis] - origin[axis]);
        }
        match self.origin {
            Some(_) => sum,
            None => frame.coordinates.to_world(sum.map(|sum| sum / set.len() as f64)),
        }
    }
}

fn stored(knots: &Knots, frame: &Frame, id: u32) -> Point {
    let [x, y] = knots.at(id);
    [x, y, frame.elevations.as_ref().map_or(0.0, |elevations| elevations[id as usize])]
}

/// Where sums of as many knots as `order` are counted from, so that they fit 32 bits: the origin of the knots, or else
/// their least coordinates.
fn origin(knots: &Knots, frame: &Frame, order: usize) -> Option<Point> {
    let (mut min, mut max) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for id in 0..knots.len() as u32 {
        let at = stored(knots, frame, id);
        for axis in 0..3 {
            min[axis] = at[axis].min(min[axis]);
            max[axis] = at[axis].max(max[axis]);
        }
    }
    let fits = |from: f64, to: f64| order as f64 * (to - from).abs() <= f64::from(i32::MAX);
    let mut origin = [0.0; 3];
    for axis in 0..3 {
        if !(fits(0.0, min[axis]) && fits(0.0, max[axis])) {
            origin[axis] = min[axis];
            if !fits(min[axis], max[axis]) {
                return None;
            }
        }
    }
    Some(origin)
}
