//! Surfaces of equal value in a slice (marching tetrahedra).

use super::NO_VALUES;
use super::slice::{Cuts, Slice, between};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::Point;

/// Least distance of a cut from the ends of its edge, relative to the length. A vertex exactly at the level
/// counts as above it. Without this distance, triangles around the vertex would collapse, and parts of the
/// surface would touch.
const DISTANCE_MIN: f64 = 1.0 / 1_048_576.0;

/// A surface of equal value.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Surface {
    /// Points where edges of the slice cross the level.
    pub points: Vec<Point>,
    /// Numbers of points, counterclockwise as seen from the side of lesser values.
    pub triangles: Vec<[u32; 3]>,
}

/// The surface where the values of a slice are `level`.
///
/// Each edge belongs to two triangles, which traverse it in opposite directions; or to one, on the border of
/// the slice or of tetrahedra with unknown values. Points keep a distance of a millionth of the edge from its
/// ends.
///
/// Cost: about 50 nanoseconds per tetrahedron.
///
/// # Errors
/// Usage, if the slice has no values, or the level is not finite.
pub fn isosurface(slice: &Slice, level: f64) -> Result<Surface> {
    let Some(values) = slice.values.as_deref() else {
        return Err(Error::usage(NO_VALUES));
    };
    if !level.is_finite() {
        return Err(Error::usage(format!("no isosurface at {level}: a finite value is needed")));
    }
    let mut marcher = Marcher { slice, values, level, cuts: Cuts::new(), surface: Surface::default() };
    let is_known = |corner: &u32| !values[*corner as usize].is_nan();
    let known = slice.tetrahedra.iter().filter(|tetrahedron| tetrahedron.iter().all(is_known));
    known.copied().try_for_each(|tetrahedron| marcher.tetrahedron(tetrahedron))?;
    Ok(marcher.surface)
}

struct Marcher<'a> {
    slice: &'a Slice,
    values: &'a [f64],
    level: f64,
    cuts: Cuts,
    surface: Surface,
}

impl Marcher<'_> {
    /// Adds the triangles in a positive tetrahedron. An even permutation puts the vertices above the level
    /// first, which fixes the edges of the surface and its orientation.
    fn tetrahedron(&mut self, [a, b, c, d]: [u32; 4]) -> Result<()> {
        let is_above = |vertex: u32| self.values[vertex as usize] >= self.level;
        match [a, b, c, d].map(is_above) {
            [true, false, false, false] => self.corner([a, b, c, d]),
            [false, true, false, false] => self.corner([b, a, d, c]),
            [false, false, true, false] => self.corner([c, d, a, b]),
            [false, false, false, true] => self.corner([d, c, b, a]),
            [true, true, false, false] => self.quadrangle([a, b, c, d]),
            [true, false, true, false] => self.quadrangle([a, c, d, b]),
            [true, false, false, true] => self.quadrangle([a, d, b, c]),
            [false, true, true, false] => self.quadrangle([b, c, a, d]),
            [false, true, false, true] => self.quadrangle([b, d, c, a]),
            [false, false, true, true] => self.quadrangle([c, d, a, b]),
            [false, true, true, true] => self.notch([a, b, c, d]),
            [true, false, true, true] => self.notch([b, a, d, c]),
            [true, true, false, true] => self.notch([c, d, a, b]),
            [true, true, true, false] => self.notch([d, c, b, a]),
            [true, true, true, true] | [false, false, false, false] => Ok(()),
        }
    }

    /// Cuts off a vertex above the level.
    fn corner(&mut self, [p, q, r, s]: [u32; 4]) -> Result<()> {
        let triangle = [self.cut(q, p)?, self.cut(r, p)?, self.cut(s, p)?];
        self.surface.triangles.push(triangle);
        Ok(())
    }

    /// Cuts off a vertex below.
    fn notch(&mut self, [p, q, r, s]: [u32; 4]) -> Result<()> {
        let triangle = [self.cut(p, q)?, self.cut(p, s)?, self.cut(p, r)?];
        self.surface.triangles.push(triangle);
        Ok(())
    }

    /// Separates two vertices above from two below.
    fn quadrangle(&mut self, [p, q, r, s]: [u32; 4]) -> Result<()> {
        let [pr, ps, qs, qr] = [self.cut(r, p)?, self.cut(s, p)?, self.cut(s, q)?, self.cut(r, q)?];
        self.surface.triangles.extend([[pr, ps, qs], [pr, qs, qr]]);
        Ok(())
    }

    fn cut(&mut self, below: u32, above: u32) -> Result<u32> {
        let Marcher { slice, values, level, cuts, surface } = self;
        let [low, high] = [below, above].map(|vertex| values[vertex as usize] * 0.5);
        let share = ((*level * 0.5 - low) / (high - low)).clamp(DISTANCE_MIN, 1.0 - DISTANCE_MIN);
        let [p, q] = [below, above].map(|vertex| slice.points[vertex as usize]);
        cuts.number((below, above), || {
            surface.points.push(std::array::from_fn(|axis| between(p[axis], q[axis], share)));
        })
    }
}
