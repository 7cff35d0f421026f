//! The boundary of a whole tetrahedral mesh: one convex surface, once around.
//!
//! The open facets are the sum of the boundaries of all tetrahedra, so they form a closed surface: along
//! every edge as many facets go one way as the other. Let every edge belong to two facets, let none of them
//! be concave; let a point `o` lie strictly inside of every facet's plane; and let a ray from `o` leave
//! through one facet only.
//!
//! *The surface is a star around `o`.* Projected onto a sphere around `o`, every facet is a triangle of
//! positive area, because `o` is inside of its plane. A closed surface covers each point of the sphere off
//! the edges equally often, since the number cannot change where an edge is crossed, and here that is once.
//! So the facets tile the sphere, and the surface is the border of a solid that is a star around `o`. It has
//! the topology of a sphere, it does not meet itself, and it is in one piece.
//!
//! *The star is convex.* If it were not, a segment between two of its inner points would leave it, also after
//! any small change of these points, and the plane through the two and `o` would avoid all vertices of the
//! surface. It cuts a polygon from the solid that is a star around `o`, so simple, and whose corners lie on
//! edges of the surface. None of these is concave, so no corner is. But a simple polygon without a concave
//! corner is convex.
//!
//! Conversely all of this holds of a convex solid, for any `o` inside. The audit takes a corner of a
//! tetrahedron, moved into the tetrahedron by infinitesimals: towards its second corner, infinitely less
//! towards the third, and less again towards the fourth. Then `o` lies on the same side of a plane or line as
//! the first of the four corners off it, and no coordinates are computed.

use std::cmp::Ordering;
use std::collections::HashMap;
use std::convert::Infallible;

use foldhash::fast::RandomState;

use super::Corner;
use crate::check::{Check, Ledger, Violation};
use crate::corner::{name_corners, named};
use crate::exact::plane;
use crate::exact::space::{Xyz, float_orientation, orientation};

/// Corners of the boundary.
///
/// Memory: the vertices of the hull, those inside of its faces and edges included.
#[derive(Debug, Default)]
pub(super) struct Hull {
    corners: HashMap<u64, Xyz, RandomState>,
}

impl Hull {
    /// Adds a finalized vertex with open facets.
    pub(super) fn add(&mut self, corner: Corner) {
        self.corners.insert(corner.id, corner.at);
    }

    /// Number of corners.
    pub(super) fn len(&self) -> u64 {
        self.corners.len() as u64
    }

    /// Proves that the open facets are one convex surface; all their corners must have been added.
    pub(super) fn check(
        &self,
        facets: impl Iterator<Item = OpenFacet>,
        ledger: &mut Ledger,
    ) -> Result<(), Violation> {
        let surface = Surface::of(self, facets);
        let Some(inside) = surface.inside else {
            return Err(Violation::new(Check::Hull, "the tetrahedra have no boundary"));
        };
        surface.for_each_edge(|edge| edge.check(ledger))?;
        surface.check_inside(&inside, ledger)?;
        surface.check_once(&inside, ledger)
    }

    /// Counts the faults of the edges of the surface; all its corners must have been added.
    pub(super) fn count(&self, facets: impl Iterator<Item = OpenFacet>) -> EdgeFaults {
        let mut faults = EdgeFaults::default();
        let counted = Surface::of(self, facets).for_each_edge(|edge| {
            match edge {
                Edge::Torn { .. } => faults.torn += 1,
                Edge::Whole { facet: [a, b, c], opposite, .. } => {
                    let [a, b, c, d] = [a.at, b.at, c.at, opposite.at];
                    faults.concave += u64::from(orientation(a, b, c, d).sign == Ordering::Greater);
                    faults.concave_in_float += u64::from(float_orientation(a, b, c, d) == Ordering::Greater);
                }
            }
            Ok::<(), Infallible>(())
        });
        let Ok(()) = counted;
        faults
    }
}

/// Corners of an open facet, counterclockwise seen from outside, and the apex of its tetrahedron.
pub(super) type OpenFacet = ([u64; 3], Corner);

/// How many edges of a surface are wrong.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct EdgeFaults {
    /// Edges that are not between two facets.
    pub(super) torn: u64,
    /// Edges between two facets that are concave.
    pub(super) concave: u64,
    /// The same, by plain floating-point arithmetic.
    pub(super) concave_in_float: u64,
}

/// The boundary in the order of its ids. Memory: about 200 bytes per facet.
struct Surface {
    corners: Vec<Corner>,
    /// Counterclockwise seen from outside, as indices of `corners`.
    facets: Vec<[usize; 3]>,
    /// A tetrahedron with a facet on the boundary: `o` is its first corner, moved into it.
    inside: Option<[Corner; 4]>,
}

/// An edge of a facet: its ends in increasing order, whether the facet has them in that order, and the facet.
type Half = ([usize; 2], bool, usize);

/// An edge of the surface.
enum Edge {
    /// Between two facets, which have it in opposite directions: one, and the third corner of the other.
    Whole { ends: [Corner; 2], facet: [Corner; 3], opposite: Corner },
    /// Any other, with the number of its facets.
    Torn { ends: [Corner; 2], facets: usize },
}

impl Edge {
    /// Checks that every edge belongs to two facets, and is convex or flat.
    fn check(&self, ledger: &mut Ledger) -> Result<(), Violation> {
        match self {
            Edge::Torn { ends, facets } => {
                let message = format!("edge {} belongs to {facets} facets of the boundary", named(ends));
                Err(name_corners(Violation::new(Check::Hull, message), ends))
            }
            Edge::Whole { ends, facet: facet @ [a, b, c], opposite } => {
                let turn = orientation(a.at, b.at, c.at, opposite.at);
                ledger.count(Check::Hull, turn.exactly);
                if turn.sign != Ordering::Greater {
                    return Ok(());
                }
                let message = format!(
                    "the boundary is concave at edge {}: vertex {} lies beyond the facet {}",
                    named(ends),
                    opposite.id,
                    named(facet)
                );
                let violation = name_corners(Violation::new(Check::Hull, message), facet);
                Err(name_corners(violation, &[*opposite]))
            }
        }
    }
}

impl Surface {
    fn of(hull: &Hull, facets: impl Iterator<Item = OpenFacet>) -> Self {
        let mut corners: Vec<Corner> = hull.corners.iter().map(|(&id, &at)| Corner::new(id, at)).collect();
        corners.sort_unstable_by_key(|corner| corner.id);
        let index: HashMap<u64, usize, RandomState> =
            corners.iter().enumerate().map(|(i, corner)| (corner.id, i)).collect();
        let mut indexed: Vec<([usize; 3], Corner)> =
            facets.map(|(facet, apex)| (facet.map(|id| index[&id]), apex)).collect();
        indexed.sort_unstable_by_key(|&(facet, _)| facet);
        let inside = indexed.first().map(|&([a, b, c], apex)| [apex, corners[a], corners[b], corners[c]]);
        let facets = indexed.into_iter().map(|(facet, _)| facet).collect();
        Surface { corners, facets, inside }
    }

    /// Visits the edges in order.
    fn for_each_edge<E>(&self, mut visit: impl FnMut(Edge) -> Result<(), E>) -> Result<(), E> {
        let mut halves: Vec<Half> = Vec::with_capacity(3 * self.facets.len());
        for (i, &[a, b, c]) in self.facets.iter().enumerate() {
            halves.extend([[a, b], [b, c], [c, a]].map(|[p, q]| ([p.min(q), p.max(q)], p < q, i)));
        }
        halves.sort_unstable();
        halves.chunk_by(|one, other| one.0 == other.0).try_for_each(|edge| visit(self.edge(edge)))
    }

    /// The edge with these halves, which have the same ends.
    fn edge(&self, halves: &[Half]) -> Edge {
        let between = halves[0].0;
        let ends = between.map(|i| self.corners[i]);
        let &[(_, false, one), (_, true, other)] = halves else {
            return Edge::Torn { ends, facets: halves.len() };
        };
        let third = self.facets[other].iter().find(|i| !between.contains(i));
        let opposite = self.corners[*third.expect("a facet has three corners")];
        Edge::Whole { ends, facet: self.facets[one].map(|i| self.corners[i]), opposite }
    }

    /// Checks that the point `o` lies strictly inside of every facet's plane.
    fn check_inside(&self, inside: &[Corner; 4], ledger: &mut Ledger) -> Result<(), Violation> {
        for facet in &self.facets {
            let [a, b, c] = facet.map(|i| self.corners[i]);
            let side = inside.iter().find_map(|corner| {
                let turn = orientation(a.at, b.at, c.at, corner.at);
                ledger.count(Check::Hull, turn.exactly);
                (turn.sign != Ordering::Equal).then_some(turn.sign)
            });
            if side != Some(Ordering::Less) {
                let message = format!(
                    "the boundary is not one convex surface: the tetrahedron {} lies beyond its facet {}",
                    named(inside),
                    named(&[a, b, c])
                );
                let violation = name_corners(Violation::new(Check::Hull, message), &[a, b, c]);
                return Err(name_corners(violation, inside));
            }
        }
        Ok(())
    }

    /// Checks that the ray from `o` in the direction of x leaves through one facet.
    ///
    /// As `o` is inside of all planes, the ray leaves through the facets that face its direction and contain
    /// `o` when seen along the ray. Seen that way, `o` is on no line through two points.
    fn check_once(&self, inside: &[Corner; 4], ledger: &mut Ledger) -> Result<(), Violation> {
        let along = |corner: Corner| [corner.at[1], corner.at[2]];
        let is_left = |p: Corner, q: Corner| {
            let sides = inside.iter().map(|&o| plane::orientation(along(p), along(q), along(o)).sign);
            sides.into_iter().find(|&sign| sign != Ordering::Equal) == Some(Ordering::Greater)
        };
        let mut passes = 0;
        for facet in &self.facets {
            let [a, b, c] = facet.map(|i| self.corners[i]);
            let turn = plane::orientation(along(a), along(b), along(c));
            ledger.count(Check::Hull, turn.exactly);
            let is_passed = turn.sign == Ordering::Greater && is_left(a, b) && is_left(b, c) && is_left(c, a);
            passes += u64::from(is_passed);
        }
        if passes != 1 {
            let message = format!("the boundary goes around {passes} times, expected once");
            return Err(name_corners(Violation::new(Check::Hull, message), &self.corners[..1]));
        }
        Ok(())
    }
}
