//! Points on one line: no triangles, and little memory, because such points cannot be divided among nodes.

use super::half_edge::NONE;
use super::triangles::Triangles;
use crate::predicates::{Point2, Predicates2, Sign, WithPredicates2, lexicographic};

/// Places that are tried first. Points that come in rows are then found off the line without a look at the
/// first row.
const FIRST: usize = 16;

/// Finds a point that is not on one line with two others.
pub(super) struct OffLine<'a> {
    pub(super) points: &'a [Point2],
}

impl WithPredicates2 for OffLine<'_> {
    /// Its index; `None` if all points are on one line.
    type Output = Option<usize>;

    fn with(self, predicates: &mut impl Predicates2) -> Self::Output {
        let points = self.points;
        let first = *points.first()?;
        let second = *points.iter().find(|&&point| point != first)?;
        let mut is_off = |index: &usize| predicates.orient2d(first, second, points[*index]) != Sign::Zero;
        let mut spread = (0..FIRST).map(|k| k * points.len() / FIRST);
        spread.find(&mut is_off).or_else(|| (0..points.len()).find(is_off))
    }
}

/// Writes the result for points that all lie on one line.
pub(super) fn extract(points: &[Point2], out: &mut Triangles) {
    out.triangle_of_vertex.resize(points.len(), NONE);
    out.hull.extend(0..points.len() as u32);
    let compare = |&u: &u32, &v: &u32| lexicographic(points[u as usize], points[v as usize]);
    out.hull.sort_unstable_by(|u, v| compare(u, v).then(u.cmp(v)));
    let duplicates = &mut out.duplicates;
    out.hull.dedup_by(|point, vertex| {
        let coincide = compare(point, vertex).is_eq();
        if coincide {
            duplicates.push([*point, *vertex]);
        }
        coincide
    });
}
