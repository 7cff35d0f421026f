//! Control meshes: Greville sites with coefficients as elevations, triangulated (thesis, figure 8.1).

use std::io::Write;

use super::layout::Spline;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::delaunay2;
use spmesh_delaunay::predicates::Point2;
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::{Coordinates, Crs, Header, Kind, write_triangles};

/// The control mesh of a spline, in world coordinates.
///
/// It is the Delaunay triangulation of Greville sites; the thesis has the triangulation of centroids instead.
/// The vertices are the same, and collected functions have no other vertices.
#[derive(Debug)]
pub struct ControlMesh {
    /// For each function its Greville site and its coefficient.
    pub points: Vec<Point>,
    /// Counterclockwise triangles of functions; of several functions with one site, the first is the vertex.
    pub triangles: Vec<[u32; 3]>,
    merged: u64,
    crs: Crs,
}

impl ControlMesh {
    /// The control mesh of a spline.
    ///
    /// # Errors
    /// Usage, if all sites are on one line.
    pub fn of(spline: &Spline) -> Result<ControlMesh> {
        let Spline { layout, coefficients, .. } = spline;
        let site = |function: usize| layout.frame.to_world(layout.basis.greville(function));
        let sites: Vec<Point2> = (0..layout.basis.len()).map(site).collect();
        let mesh = delaunay2::triangulate(&sites).map_err(Error::of_computation)?;
        if mesh.triangles().is_empty() {
            let what =
                format!("all {} Greville sites are on one line: there is no control mesh", sites.len());
            return Err(Error::usage(what));
        }
        Ok(ControlMesh {
            points: sites.iter().zip(coefficients).map(|(&[x, y], &z)| [x, y, z]).collect(),
            triangles: mesh.triangles().iter().map(|triangle| triangle.vertices).collect(),
            merged: mesh.duplicates().len() as u64,
            crs: layout.frame.crs.clone(),
        })
    }

    /// Writes the control mesh as a triangle mesh stream, whose blocks may be compressed.
    ///
    /// # Errors
    /// If writing fails.
    pub fn write(&self, compress: bool, output: impl Write) -> Result<()> {
        let header = Header {
            bounds: Bounds::of_points(&self.points),
            compressed: compress,
            crs: self.crs.clone(),
            producer: concat!("splinefit ", env!("CARGO_PKG_VERSION")).to_string(),
            ..Header::new(Kind::TriangleMesh, Coordinates::F64, 2, true)
        };
        let at = |id: u32| self.points[id as usize];
        write_triangles(header, &self.triangles, self.points.len(), self.merged, at, output)
    }
}
