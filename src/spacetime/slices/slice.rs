//! Space at one time: where it cuts the edges of simplices, and the pieces that result.

use super::subdivide::{Rule, Subdivision, subdivide};
use foldhash::{HashMap, HashMapExt};
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

/// Numbers the points where edges are cut; each edge gets one point.
#[derive(Debug, Default)]
pub(super) struct Cuts(HashMap<(u32, u32), u32>);

impl Cuts {
    pub(super) fn new() -> Self {
        Cuts(HashMap::new())
    }

    /// The number of the point on an edge; `make` is called to add a new one.
    pub(super) fn number(&mut self, edge: (u32, u32), make: impl FnOnce()) -> Result<u32> {
        if let Some(&number) = self.0.get(&edge) {
            return Ok(number);
        }
        let number = u32::try_from(self.0.len());
        let number = number.map_err(|_| Error::usage("2^32 points or more in a section"))?;
        self.0.insert(edge, number);
        make();
        Ok(number)
    }
}

/// Simplices of the product of two simplices, whose vertices are pairs of theirs: one for each path from the
/// first pair to the last that advances in one list at a time (a staircase). With lists in increasing order,
/// both sides of a face that is a product of parts of the lists have the same simplices there.
pub(super) fn staircases(
    below: &[u32],
    above: &[u32],
    visit: &mut impl FnMut(&[(u32, u32)]) -> Result<()>,
) -> Result<()> {
    fn steps(
        path: &mut Vec<(u32, u32)>,
        below: &[u32],
        above: &[u32],
        visit: &mut impl FnMut(&[(u32, u32)]) -> Result<()>,
    ) -> Result<()> {
        let ([i, below_rest @ ..], [j, above_rest @ ..]) = (below, above) else { return Ok(()) };
        path.push((*i, *j));
        if below_rest.is_empty() && above_rest.is_empty() {
            visit(path)?;
        }
        if !below_rest.is_empty() {
            steps(path, below_rest, above, visit)?;
        }
        if !above_rest.is_empty() {
            steps(path, below, above_rest, visit)?;
        }
        path.pop();
        Ok(())
    }
    steps(&mut Vec::with_capacity(below.len() + above.len()), below, above, visit)
}

/// Interpolates linearly between two numbers; exact if they are equal.
pub(super) fn between(from: f64, to: f64, share: f64) -> f64 {
    if from == to { from } else { from * (1.0 - share) + to * share }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prisms_fall_into_simplices() {
        let count = |below: &[u32], above: &[u32]| {
            let mut count = 0;
            staircases(below, above, &mut |path| {
                assert_eq!(path.len(), below.len() + above.len() - 1);
                count += 1;
                Ok(())
            })
            .unwrap();
            count
        };
        assert_eq!(
            (count(&[1], &[2, 3, 4, 5]), count(&[1, 2], &[3, 4, 5]), count(&[], &[1, 2, 3, 4, 5])),
            (1, 3, 0)
        );
    }
}
