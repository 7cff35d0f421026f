//! Decoded blocks of a stream.

use super::configurations::ConfigurationBlock;
use super::constraints::Segment;
use super::part::Origin;
use super::points4::Points4;
use super::regions::PointRegion;
use crate::model::bounds::Point;
use crate::model::cells::CellCode;
use crate::model::cells4::Cells4;
use crate::model::functions::Function;
use spmesh_base::error::{Error, Result};

/// One block of a stream, decoded and checked.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// Points, in stored coordinates.
    Points(Vec<Point>),
    /// Cells that no later point of the stream lies in.
    Cells(Vec<CellCode>),
    /// A region. Its points follow: those up to the next region, or up to the end.
    Region(PointRegion),
    /// A piece of the mesh.
    Patch(Patch),
    /// Labels of the next vertices without a label, in the order of their ids. Their meaning is up to the
    /// producer.
    Labels(Vec<u64>),
    /// Points of a residual, each with its vertex id if an earlier patch has the vertex.
    ResidualPoints(Vec<(Option<u64>, Point)>),
    /// Facets between residual points (numbered over all their blocks), `vertices_per_wall` numbers each. One
    /// side has a final simplex, the other has one that is not final. The final triangle lies to the left of
    /// a directed edge; a facet in space is counterclockwise as seen from its final tetrahedron.
    Walls(Vec<u32>),
    /// Points of four dimensions.
    Points4(Points4),
    /// The cells of four dimensions that a block completes.
    Cells4(Cells4),
    /// Simplices of four dimensions: numbers of points, five each.
    Simplices4(Vec<[u32; 5]>),
    /// Configurations of one degree.
    Configurations(ConfigurationBlock),
    /// Functions of splines, as sums of B-splines.
    Functions(Vec<Function>),
    /// Coefficients of the next functions of a spline without a coefficient.
    Coefficients(Vec<f64>),
    /// Segments of a constrained mesh, numbered from 0 over all their blocks.
    Segments(Vec<Segment>),
    /// Numbers of segments that are not wholly chains of edges, since they leave the mesh: increasing over
    /// all their blocks. No patch follows.
    OpenSegments(Vec<u32>),
    /// The end: nothing follows.
    End(Totals),
}

/// A piece of a mesh. Local indices count the new vertices first, then the imported ones.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Patch {
    /// Id of the first new vertex; ids count up from 0 in stream order.
    pub first_id: u64,
    /// New vertices, in stored coordinates.
    pub new: Vec<Point>,
    /// Ids of vertices of earlier patches, increasing.
    pub imported: Vec<u64>,
    /// Simplices as local indices, positively oriented, `vertices_per_simplex` each: triangles are
    /// counterclockwise, tetrahedra (a, b, c, d) have det(b - a, c - a, d - a) > 0.
    pub simplices: Vec<u32>,
    /// Local indices, increasing, of vertices that no later patch uses.
    pub finalized: Vec<u32>,
    /// Sides of triangles that lie on segments of a constrained mesh, increasing: the number of the triangle
    /// in the patch, its corner (0, 1 or 2) opposite to the side, and the number of the segment. Both
    /// triangles at an edge state it. Empty in all other meshes.
    pub sides: Vec<[u32; 3]>,
    /// In a part of a mesh, the new vertices that are vertices of other parts, increasing.
    pub origins: Vec<Origin>,
    /// In a part of a mesh, those of the finalized vertices that later parts may use, increasing.
    pub kept: Vec<u32>,
}

impl Patch {
    /// Id of the vertex at local index `local`.
    pub fn id(&self, local: u32) -> u64 {
        match (local as usize).checked_sub(self.new.len()) {
            None => self.first_id + u64::from(local),
            Some(i) => self.imported[i],
        }
    }

    /// Number of vertices that local indices refer to.
    pub fn vertices(&self) -> usize {
        self.new.len() + self.imported.len()
    }

    /// Checks the rules that depend only on this patch and on the number of vertices before it.
    pub(super) fn check(&self, vertices_before: u64, per_simplex: usize) -> Result<()> {
        if self.first_id != vertices_before {
            return Err(Error::malformed(format!(
                "patch starts with vertex {}, expected {vertices_before}",
                self.first_id
            )));
        }
        if !is_increasing(&self.imported) || self.imported.last().is_some_and(|&id| id >= self.first_id) {
            return Err(Error::malformed("imported vertices are not increasing ids of earlier patches"));
        }
        let vertices = self.vertices();
        if !is_increasing(&self.finalized)
            || self.finalized.last().is_some_and(|&local| local as usize >= vertices)
        {
            return Err(Error::malformed("finalized vertices are not increasing indices of the patch"));
        }
        for simplex in self.simplices.chunks_exact(per_simplex) {
            if let Some(&local) = simplex.iter().find(|&&local| local as usize >= vertices) {
                return Err(Error::malformed(format!(
                    "simplex uses vertex {local} of {vertices} in its patch"
                )));
            }
            if (1..per_simplex).any(|i| simplex[..i].contains(&simplex[i])) {
                return Err(Error::malformed(format!("simplex {simplex:?} uses a vertex twice")));
            }
        }
        Ok(())
    }

    /// The simplices of a triangle mesh.
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.simplices.chunks_exact(3).map(|t| [t[0], t[1], t[2]])
    }

    /// The simplices of a tetrahedral mesh.
    pub fn tetrahedra(&self) -> impl Iterator<Item = [u32; 4]> + '_ {
        self.simplices.chunks_exact(4).map(|t| [t[0], t[1], t[2], t[3]])
    }
}

fn is_increasing<T: PartialOrd>(values: &[T]) -> bool {
    values.windows(2).all(|pair| pair[0] < pair[1])
}

/// The totals of the whole stream, as END states them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Totals {
    /// Points. For a points stream, those in it; for one of regions, each point once. For a mesh, those of
    /// the input: its vertices, its merged points, and its residual points that are no vertices.
    pub points: u64,
    /// Cell tags.
    pub cells: u64,
    /// Vertices; functions of splines.
    pub vertices: u64,
    /// Simplices; cells of four dimensions; configurations, infinite ones included.
    pub simplices: u64,
    /// Points of the input that coincide with another point and are no vertices of their own.
    pub merged: u64,
    /// Residual points; coefficients of splines.
    pub residual_points: u64,
    /// Walls.
    pub walls: u64,
}

impl Totals {
    /// Number of totals.
    pub(super) const FIELDS: usize = 7;

    /// Names of the totals in messages, in their order in the END block.
    pub(super) const NAMES: [&str; Self::FIELDS] =
        ["points", "cells", "vertices", "simplices", "merged points", "residual points", "walls"];

    /// The totals in their order in the END block.
    pub(super) fn fields(&self) -> [u64; Self::FIELDS] {
        [
            self.points,
            self.cells,
            self.vertices,
            self.simplices,
            self.merged,
            self.residual_points,
            self.walls,
        ]
    }

    /// Checks that no total is 2^64 - 1, which stands for an unknown number elsewhere.
    pub(super) fn check_range(&self) -> Result<()> {
        match Self::NAMES.iter().zip(self.fields()).find(|(_, total)| *total == u64::MAX) {
            None => Ok(()),
            Some((name, total)) => {
                Err(Error::malformed(format!("END: {total} {name} are beyond counting, at most 2^64 - 2")))
            }
        }
    }

    /// Totals from their order in the END block.
    pub(super) fn from_fields(fields: [u64; 7]) -> Self {
        let [points, cells, vertices, simplices, merged, residual_points, walls] = fields;
        Totals { points, cells, vertices, simplices, merged, residual_points, walls }
    }
}
