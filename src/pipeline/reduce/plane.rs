//! Triangles: the reduction in the plane.

use super::bulk::{Bulk, Facet, WallSide};
use super::disks::Disks;
use super::residual::Residual;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::delaunay2::{Corner, Kernel, NONE, Triangles};
use spmesh_delaunay::predicates::PredicateCounts;
use spmesh_delaunay::predicates::circle::CircleBounds;
use spmesh_stream::model::bounds::Region;
use spmesh_stream::{Coordinates, Kind, Weights};

/// The kernel of the plane and its triangulation.
#[derive(Default)]
pub(super) struct Plane {
    kernel: Kernel,
    triangulation: Triangles,
}

impl Bulk<2> for Plane {
    type Corners = [u32; 3];
    type Balls = Disks;

    const MESH: Kind = Kind::TriangleMesh;
    const PARTIAL_MESH: Kind = Kind::PartialTriangleMesh;
    const RESIDUAL: Kind = Kind::TriangleResidual;
    const SIMPLEX: &'static str = "triangle";
    const FACET: &'static str = "edge";
    const TRIANGULATION: &'static str = "triangulation";
    const WAITING_BYTES: usize = 56;
    const KERNEL_BYTES: usize = 190;
    const KEPT_POINTS_MAX: usize = 1 << 16;
    const KEPT_BLOCKS_MAX: usize = 1 << 20;
    const SAMPLED_MIN: usize = 4_000;
    const PASSES_FEW: bool = false;

    fn triangulate(&mut self, points: &Residual<2>, _: Option<Weights>) -> Result<()> {
        self.kernel.triangulate(&points.at, &mut self.triangulation).map_err(Error::of_computation)
    }

    fn duplicates(&mut self) -> &mut Vec<[u32; 2]> {
        &mut self.triangulation.duplicates
    }

    fn len(&self) -> usize {
        self.triangulation.triangles().len()
    }

    /// The kernel's order follows a curve.
    #[inline]
    fn nth(&self, k: usize) -> u32 {
        k as u32
    }

    #[inline]
    fn corners(&self, triangle: u32) -> [u32; 3] {
        self.triangulation.triangles()[triangle as usize].vertices
    }

    #[inline]
    fn neighbour(&self, edge: Facet) -> Option<Facet> {
        let beyond = self.triangulation.triangles()[edge.simplex as usize].neighbour(edge.corner as usize);
        beyond.map(facet)
    }

    fn hull_vertices(&self) -> impl Iterator<Item = u32> {
        self.triangulation.hull.iter().copied()
    }

    fn hull_facets(&self) -> impl Iterator<Item = Facet> {
        let Triangles { hull, triangle_of_vertex, .. } = &self.triangulation;
        hull.iter().filter_map(|&v| {
            // The first triangle at a vertex of the hull is the one at the edge of the hull that leaves it.
            let simplex = triangle_of_vertex[v as usize];
            let triangle =
                self.triangulation.triangles().get(simplex as usize).filter(|_| simplex != NONE)?;
            let corner = (0..).zip(triangle.vertices).find(|&(_, vertex)| vertex == v)?.0;
            Some(Facet { simplex, corner: (corner + 2) % 3 })
        })
    }

    fn find(
        &mut self,
        walls: &[[u32; 2]],
        mut found: impl FnMut(WallSide),
    ) -> std::result::Result<(), usize> {
        let left_of = |a, b| self.triangulation.left_of(a, b).map(facet);
        let side = |&[a, b]: &[u32; 2]| {
            left_of(a, b).map(WallSide::Final).or_else(|| left_of(b, a).map(WallSide::Open))
        };
        walls.iter().enumerate().try_for_each(|(number, wall)| side(wall).map(&mut found).ok_or(number))
    }

    fn wall(&self, edge: Facet) -> [u32; 2] {
        let vertices = self.corners(edge.simplex);
        [1, 2].map(|k| vertices[(edge.corner as usize + k) % 3])
    }

    fn balls(coordinates: &Coordinates, region: Region, _: Option<Weights>) -> Disks {
        let bounds = match coordinates {
            Coordinates::F64 => CircleBounds::FLOAT,
            Coordinates::I32 { .. } => CircleBounds::INTEGER,
        };
        Disks::new(bounds, region)
    }

    #[inline(always)]
    fn is_inside(&self, triangle: u32, points: &Residual<2>, disks: &Disks) -> bool {
        let [a, b, c] = self.corners(triangle).map(|v| points.at[v as usize]);
        disks.inside(a, b, c)
    }

    fn keep_inside(&self, first: usize, kept: &mut [bool], points: &Residual<2>, disks: &Disks) {
        let triangles = &self.triangulation.triangles()[first..][..kept.len()];
        disks.keep_inside(triangles.iter().map(|triangle| triangle.vertices), &points.at, kept);
    }

    fn counts(&self) -> &PredicateCounts {
        self.kernel.counts()
    }
}

fn facet(Corner { triangle: simplex, corner }: Corner) -> Facet {
    Facet { simplex, corner }
}
