//! Delaunay configurations of any degree, and their generalisations (thesis 6.2.2 and chapter 7).
//!
//! A configuration of degree k is a pair (B, I): three knots B, and the k knots I inside their circle.
//! [`delaunay`] and [`Start`] give the configurations of degree 0, the triangles of a triangulation.
//! [`link_triangulate`] goes from each degree to the next: the configurations of the previous degree leave a
//! polygon around each set J, its link, and triangles with interior set J triangulate it. Any rule for
//! triangulating polygons works (proved by Schmitt, "Bivariate B-splines from convex configurations", J.
//! Comput. System Sci. 120, 2021); [`Rule::Delaunay`] gives the Delaunay configurations. Every step asserts
//! what the theory states about links.
//!
//! `knots` has the symbolic perturbation of repeated knots, `plane` the predicates, and `configurations` the
//! arrays. `gathering` computes links from configurations; `polygon`, `rule`, `apex` and
//! `insertion` triangulate links. [`special`] sets up starts and links for special splines.

mod apex;
mod border;
mod centroids;
mod copies;
mod gathering;
mod insertion;
mod knots;
mod lift;
mod plane;
mod polygon;
mod rule;
pub mod special;
mod start_check;
mod surface;
mod symbolic;

pub use centroids::{CentroidMesh, UnionSource, centroid, inverse_union_map, union_map};
pub use gathering::links;
pub use knots::{Displacement, Knots};
pub use lift::Lift;
pub use rule::Rule;
pub use spmesh_stream::model::configurations::{Claim, Configurations, FARAWAY, Group, Link, Links};
pub use surface::{Start, delaunay};

use polygon::Triangulator;
use special::Diagonals;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::order::{Curve, SpatialOrder};
use spmesh_delaunay::predicates::{Arithmetic, Extent, PredicateCounts, Predicates2, WithPredicates2};

/// The configurations of the next degree: every link is triangulated by `rule` (thesis, table 7.1).
///
/// Domain: `configurations` are of the same knots. If [`Rule::Delaunay`] made all degrees since [`delaunay`],
/// these are exactly the Delaunay configurations. If [`Rule::Lifted`] made all degrees since
/// [`Start::lifted`], with the same lift, they are the projective configurations.
///
/// Cost: O(c k log c) for c configurations, and the cost of the rule per link of m vertices. That is O(m)
/// expected decisions for [`Rule::Delaunay`] and [`Rule::Lifted`] if they made all degrees since their
/// starts, and O(m³) for others. Links have about 6 vertices.
///
/// # Errors
/// Parameters of the rule that do not fit the knots; a link that is neither a simple polygon nor null (kind
/// [`spmesh_base::error::ErrorKind::Audit`]: a counterexample to the theory, or configurations from
/// elsewhere); a link with more vertices than the rule takes.
pub fn link_triangulate(
    knots: &Knots,
    configurations: &Configurations,
    rule: &Rule,
) -> Result<Configurations> {
    step(knots, configurations, rule, &Diagonals::default())
}

/// [`link_triangulate`] with required diagonals of links.
fn step(
    knots: &Knots,
    configurations: &Configurations,
    rule: &Rule,
    diagonals: &Diagonals,
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

/// Checks that there are enough knots for configurations of a degree: three more than the degree.
///
/// # Errors
/// Usage, if there are too few.
pub fn check_degree(knots: &Knots, degree: usize) -> Result<()> {
    if knots.len() < degree.saturating_add(3) {
        let (found, needed) = (knots.len(), degree.saturating_add(3));
        return Err(Error::usage(format!(
            "degree {degree} needs at least {needed} knots, there are {found}"
        )));
    }
    Ok(())
}

/// One step to the next degree, in any arithmetic.
struct Step<'a> {
    knots: &'a Knots,
    configurations: &'a Configurations,
    rule: &'a Rule,
    diagonals: &'a Diagonals,
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
        // Visits knots along a space-filling curve, so that memory accesses are local whatever the order of
        // ids.
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
