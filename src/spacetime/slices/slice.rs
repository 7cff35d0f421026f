//! Space at one time.

use super::prism::{Cuts, between, staircases};
use super::subdivide::{Rule, Subdivision, subdivide};
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::{FiniteFloatPredicates3, Predicates3, Sign};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::cells4::Point4;
use spmesh_stream::model::diagram4::Diagram4;

/// The tetrahedra that a time cuts out of a diagram.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Slice {
    /// The time.
    pub time: f64,
    /// Points where edges cross the time, and vertices at that time.
    pub points: Vec<Point>,
    /// Interpolated values there, if the points of the diagram have values.
    pub values: Option<Vec<f64>>,
    /// Numbers of points (a, b, c, d) with det(b - a, c - a, d - a) > 0. They fit together facet to facet.
    pub tetrahedra: Vec<[u32; 4]>,
    /// Simplices and tetrahedra that were left out because they are flat by rounding.
    pub flat: u64,
}

/// Cuts a diagram at a time.
///
/// Cells that are no simplices are subdivided around barycentres, as for interpolation. A vertex exactly at
/// the time counts as later: the slice is the limit of the slices before it. At the first time of all points
/// it is the limit of the slices after it. Tetrahedra that collapse in the limit are left out; the others fit
/// together. The result has no tetrahedra where the points span no volume at that time.
///
/// Cost: as [`subdivide`] for the cells that span the time, and half a microsecond per tetrahedron.
///
/// # Errors
/// Usage, if the time is before or after all points.
pub fn slice(diagram: &Diagram4, time: f64) -> Result<Slice> {
    let first = first_time(&diagram.points, time)?;
    let is_above = |point: &Point4| if time == first { point[3] > time } else { point[3] >= time };
    let (points, values) = (&diagram.points, diagram.values.as_deref());
    let is_cut = |vertices: &[u32]| {
        let mut sides = vertices.iter().map(|&vertex| is_above(&points[vertex as usize]));
        let side = sides.next();
        sides.any(|other| Some(other) != side)
    };
    let parts = subdivide(points, values, &diagram.cells, Rule::Barycentric, is_cut)?;
    let slice = Slice { time, values: values.map(|_| Vec::new()), flat: parts.flat, ..Slice::default() };
    let mut cutter =
        Cutter { parts: &parts, cuts: Cuts::new(), slice, predicates: FiniteFloatPredicates3::default() };
    for simplex in &parts.simplices {
        let mut simplex = *simplex;
        simplex.sort_unstable();
        let (above, below): (Vec<u32>, Vec<u32>) =
            simplex.iter().partition(|&&vertex| is_above(&parts.points[vertex as usize]));
        staircases(&below, &above, &mut |edges| cutter.tetrahedron(edges))?;
    }
    Ok(cutter.slice)
}

/// Checks that a time is within those of the points, and returns the first of these.
///
/// # Errors
/// Usage, if it is not.
pub fn first_time(points: &[Point4], time: f64) -> Result<f64> {
    let times = points.iter().map(|point| point[3]);
    let (first, last) = times.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), t| (a.min(t), b.max(t)));
    if !(first..=last).contains(&time) {
        return Err(Error::usage(format!("no slice at time {time}: the points are from {first} to {last}")));
    }
    Ok(first)
}

struct Cutter<'a> {
    parts: &'a Subdivision,
    cuts: Cuts,
    slice: Slice,
    predicates: FiniteFloatPredicates3,
}

impl Cutter<'_> {
    fn tetrahedron(&mut self, edges: &[(u32, u32)]) -> Result<()> {
        let mut corners = [0; 4];
        for (corner, &edge) in corners.iter_mut().zip(edges) {
            *corner = self.cut(edge)?;
        }
        let [a, b, c, d] = corners;
        if a == b || a == c || a == d || b == c || b == d || c == d {
            return Ok(());
        }
        let [p, q, r, s] = corners.map(|corner| self.slice.points[corner as usize]);
        match self.predicates.orient3d(p, q, r, s) {
            Sign::Positive => self.slice.tetrahedra.push([a, b, c, d]),
            Sign::Negative => self.slice.tetrahedra.push([a, b, d, c]),
            Sign::Zero => self.slice.flat += 1,
        }
        Ok(())
    }

    /// The point where an edge, from below to above, crosses the time.
    fn cut(&mut self, (below, above): (u32, u32)) -> Result<u32> {
        let Cutter { parts, cuts, slice, .. } = self;
        let [p, q] = [below, above].map(|vertex| parts.points[vertex as usize]);
        // All edges that end in a vertex at the time cross the time there.
        let (edge, share) = if q[3] == slice.time {
            ((above, above), 1.0)
        } else if p[3] == slice.time {
            ((below, below), 0.0)
        } else {
            ((below, above), (slice.time * 0.5 - p[3] * 0.5) / (q[3] * 0.5 - p[3] * 0.5))
        };
        let at = |from: f64, to: f64| match share {
            0.0 => from,
            1.0 => to,
            _ => between(from, to, share),
        };
        cuts.number(edge, || {
            slice.points.push(std::array::from_fn(|axis| at(p[axis], q[axis])));
            if let (Some(all), Some(values)) = (&mut slice.values, &parts.values) {
                all.push(at(values[below as usize], values[above as usize]));
            }
        })
    }
}
