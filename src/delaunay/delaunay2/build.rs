//! The first triangle, then point after point.

use super::insertion::{Cavity, Insertion};
use super::locate::Start;
use super::mesh::Mesh;
use crate::predicates::{Point2, Predicates2, Sign, WithPredicates2};
use crate::watch::{Pace, Watch};

/// Triangulates distinct points, all in one arithmetic.
pub(super) struct Build<'s, 'a> {
    /// The vertices, that at infinity first.
    pub(super) points: &'s [Point2],
    /// Memory for their triangles.
    pub(super) memory: &'s mut [u32],
    /// The finite vertices in the order of insertion.
    pub(super) sequence: &'a [u32],
    pub(super) cavity: &'a mut Cavity,
    pub(super) watch: Option<&'a Watch>,
}

impl<'s> WithPredicates2 for Build<'s, '_> {
    /// The triangulation; `None` if all points are on one line. Of some of the points only, if the work is
    /// stopped.
    type Output = Option<Mesh<'s>>;

    fn with(self, predicates: &mut impl Predicates2) -> Self::Output {
        let third = self.first_off_line(predicates)?;
        let [mut a, mut b, c] = [0, 1, third].map(|place| self.sequence[place]);
        let [p, q, r] = [a, b, c].map(|v| self.points[v as usize]);
        if predicates.orient2d(p, q, r) == Sign::Negative {
            (a, b) = (b, a);
        }
        let mesh = Mesh::new(self.points, self.memory, [a, b, c]);
        let mut insertion = Insertion::new(mesh, predicates, self.cavity);
        let mut start = Start { triangle: 0, is_seen: false };
        let mut pace = Pace::of(self.watch);
        for place in (2..self.sequence.len()).filter(|&place| place != third) {
            if pace.is_stopped() {
                break;
            }
            let after = self.sequence.get(place + 1).unwrap_or(&self.sequence[place]);
            start = insertion.insert(self.sequence[place], start, self.points[*after as usize]);
        }
        Some(insertion.finish())
    }
}

impl Build<'_, '_> {
    /// Place in the sequence of the first point that is not on the line through the first two.
    fn first_off_line(&self, predicates: &mut impl Predicates2) -> Option<usize> {
        let point = |place: usize| self.points[self.sequence[place] as usize];
        (2..self.sequence.len())
            .find(|&place| predicates.orient2d(point(0), point(1), point(place)) != Sign::Zero)
    }
}
