//! Centroid triangulations as triangle mesh streams.

use std::io::Write;

use super::sites::Frame;
use spmesh_base::error::Result;
use spmesh_configurations::{CentroidMesh, Knots};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Coordinates, Header, Kind, write_triangles};

/// Writes a centroid triangulation, whose blocks may be compressed, with the mean of elevations where knots have some.
///
/// Knots on an integer grid have centroids on a grid that is finer by the order, so they are stored exactly
/// if they fit 32 bits; otherwise they are rounded.
///
/// # Errors
/// If writing fails.
pub fn write_centroids(
    knots: &Knots,
    frame: &Frame,
    mesh: &CentroidMesh,
    compress: bool,
    output: impl Write,
) -> Result<()> {
    let placement = Placement::of(knots, frame, mesh.order());
    let points = Some(mesh.vertices.len() as u64);
    let header = Header { points, compressed: compress, ..placement.header.clone() };
    let at = |v: u32| placement.centroid(knots, frame, mesh.set(v));
    write_triangles(header, &mesh.triangles, mesh.vertices.len(), 0, at, output)
}

/// How centroids are stored.
struct Placement {
    header: Header,
    /// On a grid: the new origin of stored knots.
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

/// The origin of sums of `order` knots, chosen so that they fit 32 bits: the origin of the knots, or else
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
