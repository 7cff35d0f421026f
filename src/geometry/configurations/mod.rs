//! Delaunay configurations of any degree, and what generalises them (thesis 6.2.2 and chapter 7).
//!
//! A configuration of degree k is a pair (B, I): three knots B, and the k knots I that their circle has
//! inside. [`delaunay`] and [`Start`] give those of degree 0, the triangles of a triangulation;
//! [`link_triangulate`] goes from each degree to the next: the triangles with interior set J triangulate the
//! polygon that those of the degree before leave around J, its link. Any rule for polygons will do (proved by
//! Schmitt, "Bivariate B-splines from convex configurations", J. Comput. System Sci. 120, 2021);
//! [`Rule::Delaunay`] gives the Delaunay configurations. What theory promises of links is asserted in every
//! step.
//!
//! `knots` has the symbolic perturbation of repeated knots, `plane` the predicates, `configurations` the
//! arrays, `gathering` the way from configurations to links, `polygon`, `rule`, `apex` and `insertion` that
//! from links to configurations. [`special`] sets up starts and links for splines of a purpose.

mod apex;
mod border;
mod centroids;
mod copies;
mod gathering;
mod insertion;
mod knots;
mod lift;
mod merged;
mod plane;
mod polygon;
mod rule;
mod simple;
pub mod special;
mod start_check;
mod surface;
mod symbolic;
mod union_map;

pub use centroids::{CentroidMesh, centroid};
pub use gathering::links;
pub use knots::Knots;
pub use lift::Lift;
pub use rule::Rule;
pub use spmesh_model::configurations::{Claim, Configurations, FARAWAY, Group, Link, Links};
pub use surface::{Start, delaunay};
pub use union_map::{UnionSource, inverse_union_map, union_map};

use crate::order::{Curve, SpatialOrder};
use crate::predicates::{Arithmetic, Extent, PredicateCounts, Predicates2, WithPredicates2};
use polygon::Triangulator;
use spmesh_core::error::{Error, Result};

/// The configurations of the next degree: every link is triangulated by `rule` (thesis, table 7.1).
///
/// Domain: `configurations` are of the same knots. With [`Rule::Delaunay`] all the way from [`delaunay`] on,
/// these are exactly the Delaunay configurations; with [`Rule::Lifted`] from [`Start::lifted`] on and the
/// same lift, the projective ones.
///
/// Cost: O(c k log c) for c configurations, and what the rule costs per link of m vertices: O(m) expected
/// decisions for [`Rule::Delaunay`] and [`Rule::Lifted`] all the way from their starts, O(m³) for others;
/// links have about 6 vertices.
///
/// # Errors
/// Parameters of the rule that do not fit; a link that is neither a simple polygon nor null (kind
/// [`spmesh_core::error::ErrorKind::Audit`]: a counterexample to the theory, or configurations from
/// elsewhere); a link with more vertices than the rule takes.
pub fn link_triangulate(
    knots: &Knots,
    configurations: &Configurations,
    rule: &Rule,
) -> Result<Configurations> {
    step(knots, configurations, rule, &special::Diagonals::default())
}

/// [`link_triangulate`] with diagonals that links must have.
fn step(
    knots: &Knots,
    configurations: &Configurations,
    rule: &Rule,
    diagonals: &special::Diagonals,
) -> Result<Configurations> {
    rule.check(knots)?;
    let step = Step { knots, configurations, rule, diagonals };
    Arithmetic::of(&Extent::of(knots.points())).run(step, &mut PredicateCounts::default())
}

/// All degrees from 0 to `degree`, in order.
///
/// # Errors
/// A degree that the number of knots does not allow, and those of [`link_triangulate`].
pub fn generate(
    knots: &Knots,
    start: Configurations,
    rule: &Rule,
    degree: usize,
) -> Result<Vec<Configurations>> {
    check_degree(knots, degree)?;
    let mut all = vec![start];
    for _ in 0..degree {
        all.push(link_triangulate(knots, &all[all.len() - 1], rule)?);
    }
    Ok(all)
}

/// Whether there are enough knots for configurations of a degree: three more.
///
/// # Errors
/// Too few.
pub fn check_degree(knots: &Knots, degree: usize) -> Result<()> {
    if knots.len() < degree.saturating_add(3) {
        let (found, needed) = (knots.len(), degree.saturating_add(3));
        return Err(Error::usage(format!(
            "degree {degree} needs at least {needed} knots, there are {found}"
        )));
    }
    Ok(())
}

/// One degree more, in some arithmetic.
struct Step<'a> {
    knots: &'a Knots,
    configurations: &'a Configurations,
    rule: &'a Rule,
    diagonals: &'a special::Diagonals,
}

impl WithPredicates2 for Step<'_> {
    type Output = Result<Configurations>;

    fn with(self, predicates: &mut impl Predicates2) -> Result<Configurations> {
        let Step { knots, configurations, rule, diagonals } = self;
        let claim = match (configurations.claim(), rule) {
            _ if !diagonals.is_empty() => Claim::Any,
            (Claim::Delaunay, Rule::Delaunay) => Claim::Delaunay,
            (Claim::Lifted, Rule::Lifted(_)) => Claim::Lifted,
            _ => Claim::Any,
        };
        let mut next = Configurations::new(configurations.degree() + 1, claim);
        let mut triangulator = Triangulator::new(knots, (rule, diagonals), claim, predicates);
        // Along a curve, so that what is near in the plane is near in time: ids may be in any order.
        let mut curve = SpatialOrder::default();
        let order: Vec<u32> =
            curve.sort(knots.points(), &Extent::of(knots.points()), Curve::Hilbert).collect();
        drop(curve);
        gathering::for_each_link(knots, configurations, &order, |set, link| {
            triangulator.triangulate(set, link)?;
            next.push(&triangulator.out);
            next.close_group(set);
            Ok(())
        })?;
        next.sort_groups(&order);
        Ok(next)
    }
}
