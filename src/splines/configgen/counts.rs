//! Counts configurations, links and functions by kind.

use spmesh_base::error::Result;
use spmesh_configurations::{self as configurations, Configurations, Knots};
use spmesh_delaunay::predicates::{FiniteFloatPredicates, Predicates2, Sign};
use spmesh_stream::model::functions::{Function, FunctionKind};

/// Counts of one degree.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct DegreeCounts {
    /// The degree.
    pub degree: u64,
    /// Finite configurations.
    pub configurations: u64,
    /// Finite configurations whose boundary triangle has no area, because of copies of knots.
    pub flat: u64,
    /// Infinite configurations: lines with as many knots to the left as the degree.
    pub infinite: u64,
    /// Interior sets.
    pub interiors: u64,
    /// Links that are bounded polygons. Each belongs to a set of one more knot, and defines a B-spline of the
    /// next degree.
    pub links: u64,
    /// Links that are null.
    pub null_links: u64,
    /// Links through the faraway point.
    pub infinite_links: u64,
    /// Most vertices of a link.
    pub link_vertices_max: u64,
}

impl DegreeCounts {
    /// Counts configurations and the links that they leave.
    ///
    /// # Errors
    /// As [`configurations::links`].
    pub fn of(knots: &Knots, configurations: &Configurations) -> Result<DegreeCounts> {
        let mut counts = DegreeCounts {
            degree: configurations.degree() as u64,
            configurations: configurations.len() as u64,
            infinite: configurations.infinite_len() as u64,
            interiors: configurations.group_count() as u64,
            ..DegreeCounts::default()
        };
        if knots.has_copies() {
            let mut predicates = FiniteFloatPredicates::default();
            let mut is_flat = |boundary: [u32; 3]| {
                let [a, b, c] = boundary.map(|id| knots.at(id));
                predicates.orient2d(a, b, c) == Sign::Zero
            };
            counts.flat = configurations.iter().filter(|&(boundary, _)| is_flat(boundary)).count() as u64;
        }
        for link in configurations::links(knots, configurations)?.iter() {
            let kind = match (link.is_infinite(), link.is_null()) {
                (true, _) => &mut counts.infinite_links,
                (false, true) => &mut counts.null_links,
                (false, false) => &mut counts.links,
            };
            *kind += 1;
            counts.link_vertices_max = counts.link_vertices_max.max(link.polygon.len() as u64);
        }
        Ok(counts)
    }
}

/// Counts of the functions of quadratic splines, by [`FunctionKind`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct FunctionCounts {
    /// B-splines of edges.
    pub edges: u64,
    /// Tents of knots.
    pub vertices: u64,
    /// Tents of edges between a knot that is pulled apart and others.
    pub tents: u64,
    /// Functions of creases with smooth ends.
    pub creases: u64,
    /// Box splines.
    pub faces: u64,
}

impl FunctionCounts {
    /// Counts functions.
    pub fn of(functions: &[Function]) -> FunctionCounts {
        let mut counts = FunctionCounts::default();
        for function in functions {
            *match function.kind {
                FunctionKind::Edge(_) => &mut counts.edges,
                FunctionKind::Vertex(_) => &mut counts.vertices,
                FunctionKind::Tent(_) => &mut counts.tents,
                FunctionKind::Crease(_) => &mut counts.creases,
                FunctionKind::Face(_) => &mut counts.faces,
            } += 1;
        }
        counts
    }
}
