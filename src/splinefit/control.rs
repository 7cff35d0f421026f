//! Control meshes: Greville sites with coefficients as elevations, triangulated (thesis, figure 8.1).

use std::io::Write;

use super::layout::Spline;
use crate::delaunay2;
use crate::error::{Error, Result};
use crate::predicates::Point2;
use crate::stream::{Coordinates, Header, Kind, write_triangles};

/// Writes the control mesh of a spline as a triangle mesh stream, in world coordinates; the number of triangles.
///
/// Of several functions with one Greville site, the mesh has the first.
///
/// # Errors
/// Usage, if all sites are on one line; if writing fails.
pub fn write_control_mesh(spline: &Spline, output: impl Write) -> Result<u64> {
    let Spline { layout, coefficients } = spline;
    let site = |function: usize| layout.frame.to_world(layout.basis.greville(function));
    let sites: Vec<Point2> = (0..layout.basis.len()).map(site).collect();
    let mesh = delaunay2::triangulate(&sites)?;
    if mesh.triangles().is_empty() {
        let what = format!("all {} Greville sites are on one line: there is no control mesh", sites.len());
        return Err(Error::usage(what));
    }
    let triangles: Vec<[u32; 3]> = mesh.triangles().iter().map(|triangle| triangle.vertices).collect();
    let header = Header {
        crs: layout.frame.crs.clone(),
        producer: concat!("splinefit ", env!("CARGO_PKG_VERSION")).to_string(),
        ..Header::new(Kind::TriangleMesh, Coordinates::F64, 2, true)
    };
    let at = |id: u32| {
        let [x, y] = sites[id as usize];
        [x, y, coefficients[id as usize]]
    };
    let merged = mesh.duplicates.len() as u64;
    write_triangles(header, &triangles, sites.len(), merged, at, output)?;
    Ok(triangles.len() as u64)
}
