//! Builds bases from configurations.

use super::basis::Basis;
use super::domain::Domain;
use super::elements::{Elements, FunctionSets, hull_area, hull_edges};
use super::linear_simplex::{Factors, LinearSimplex};
use super::simplex::MAX_DEGREE;
use super::tree::{Hull, Tree};
use spmesh_base::error::{Error, Result};
use spmesh_configurations::{self as configurations, Configurations, FARAWAY, Knots};
use spmesh_delaunay::predicates::{BoundedFloatPredicates, Extent, Point2};
use spmesh_stream::model::functions::Function;

impl Basis {
    /// The B-splines of degree k that belong to the links of configurations of degree k - 1, in the order of
    /// links, without those that are zero everywhere.
    ///
    /// They sum to one and reproduce polynomials of degree k, by polar forms, at every point for which each
    /// closed half-plane that contains it contains at least k knots ([`Basis::is_in_domain`]).
    ///
    /// Domain: the configurations are of these knots.
    ///
    /// Source: Neamtu 2004; thesis 8.1.
    ///
    /// # Errors
    /// Usage, for knots whose coordinates make areas overflow or underflow, a degree that is too great,
    /// configurations without links, or functions that are all zero.
    pub fn new(knots: &Knots, configurations: &Configurations) -> Result<Basis> {
        check(knots, configurations)?;
        let links = configurations::links(knots, configurations)?;
        let mut sets = FunctionSets::new(links.size());
        let mut of_link = vec![Vec::new(); links.len()];
        for (at, link) in links.iter().enumerate().filter(|(_, link)| !link.is_null()) {
            of_link[at].push((sets.len() as u32, 1.0));
            sets.push([(link.set, 1.0)].into_iter());
        }
        let elements = of_links(knots, configurations, &links, &of_link);
        Basis::without_zeros(knots, configurations, sets, elements)
    }

    /// Functions that are sums of B-splines of degree 2, as [`configurations::special::Special::functions`]
    /// collects them, in their order; `configurations` are those of degree 1.
    ///
    /// # Errors
    /// Those of [`Basis::new`]; configurations of another degree; a set without a link; a factor that is not
    /// finite.
    pub fn of_functions(
        knots: &Knots,
        configurations: &Configurations,
        functions: &[Function],
    ) -> Result<Basis> {
        if configurations.degree() != 1 {
            let what = format!(
                "configurations of degree {}: sums of B-splines need degree 1",
                configurations.degree()
            );
            return Err(Error::usage(what));
        }
        check(knots, configurations)?;
        let links = configurations::links(knots, configurations)?;
        let mut sets = FunctionSets::new(2);
        let mut of_link = vec![Vec::new(); links.len()];
        for (number, function) in (0u32..).zip(functions) {
            for (set, factor) in &function.terms {
                let named = |error: Error| error.at(format!("function {number}"));
                let Some(at) = links.find(set) else {
                    return Err(named(Error::usage(format!("knots {} and {} have no link", set[0], set[1]))));
                };
                if !factor.is_finite() {
                    return Err(named(Error::malformed("a factor is not finite")));
                }
                of_link[at].push((number, *factor));
            }
            sets.push(function.terms.iter().map(|(set, factor)| (&set[..], *factor)));
        }
        let elements = of_links(knots, configurations, &links, &of_link);
        Basis::of_elements(knots, configurations, sets, elements)
    }

    /// Functions of degree 0, in the order of configurations: one inside a triangle and zero elsewhere. Flat
    /// triangles are left out.
    ///
    /// # Errors
    /// Those of [`Basis::new`]; configurations of another degree.
    pub fn of_triangles(knots: &Knots, configurations: &Configurations) -> Result<Basis> {
        if configurations.degree() != 0 {
            let what =
                format!("configurations of degree {}: triangles have degree 0", configurations.degree());
            return Err(Error::usage(what));
        }
        check(knots, configurations)?;
        let mut sets = FunctionSets::new(3);
        configurations.iter().for_each(|(triangle, _)| sets.push([(&triangle[..], 1.0)].into_iter()));
        let elements =
            Elements::of_configurations(knots, configurations, |number, _, _, take| take(number, 1.0));
        Basis::without_zeros(knots, configurations, sets, elements)
    }

    fn without_zeros(
        knots: &Knots,
        configurations: &Configurations,
        sets: FunctionSets,
        mut elements: Elements,
    ) -> Result<Basis> {
        let mut is_used = vec![false; sets.len()];
        let shares = (0..elements.len()).flat_map(|at| elements.shares(at));
        shares.for_each(|share| is_used[share.function as usize] = true);
        let (mut numbers, mut kept) = (vec![u32::MAX; sets.len()], FunctionSets::new(sets.size));
        for function in (0..sets.len()).filter(|&function| is_used[function]) {
            numbers[function] = kept.len() as u32;
            kept.push(sets.terms(function));
        }
        elements.renumber(&numbers);
        Basis::of_elements(knots, configurations, kept, elements)
    }

    fn of_elements(
        knots: &Knots,
        configurations: &Configurations,
        sets: FunctionSets,
        elements: Elements,
    ) -> Result<Basis> {
        if elements.len() == 0 {
            return Err(Error::usage(
                "all functions are zero: knots on one line, or none that are inside of others",
            ));
        }
        let points = knots.points().to_vec();
        let domain = Domain::of(knots, configurations);
        let hulls: Vec<Hull> = (0..elements.len()).map(|at| hull(&elements, at, &points)).collect();
        let extent = Extent::of(&points);
        let tree = Tree::new(&hulls, &domain, extent.lower, extent.upper);
        let (mut linear_simplices, mut sizes) = (Vec::new(), Vec::new());
        if elements.size <= 4 {
            for (at, hull) in hulls.iter().enumerate() {
                let knots: Vec<Point2> = elements.knots(at).iter().map(|&id| points[id as usize]).collect();
                sizes.push(hull_area(&hull.edges));
                linear_simplices.push(LinearSimplex::new(&knots, &hull.edges, sizes[at]));
            }
        }
        let factors = Factors::of(&elements, &linear_simplices, &sizes, &points);
        let greville = (0..sets.len()).map(|function| sets.greville(function, &points)).collect();
        let supports = supports(&elements, &hulls, sets.len());
        let degree =
            if sets.size == 3 && configurations.degree() == 0 { 0 } else { configurations.degree() + 1 };
        Ok(Basis {
            degree,
            points,
            sets,
            greville,
            supports,
            elements,
            linear_simplices,
            factors,
            domain,
            tree,
        })
    }
}

/// Checks what all bases require of knots and configurations.
fn check(knots: &Knots, configurations: &Configurations) -> Result<()> {
    if !BoundedFloatPredicates::covers(&Extent::of(knots.points())) {
        let what =
            "coordinates of knots must be zero, or have magnitudes between 2^-170 and 2^240: scale them";
        return Err(Error::usage(what));
    }
    if configurations.degree() > MAX_DEGREE {
        let what = format!(
            "degree {} is more than {MAX_DEGREE}, the greatest that can be evaluated",
            configurations.degree()
        );
        return Err(Error::usage(what));
    }
    let ids = configurations.groups().flat_map(|group| {
        let boundaries = group.triangles.iter().chain(group.infinite).flatten();
        boundaries.chain(group.interior).copied()
    });
    match ids.filter(|&id| id != FARAWAY).max() {
        Some(id) if id as usize >= knots.len() => {
            Err(Error::usage(format!("unknown knot {id}: there are {}", knots.len())))
        }
        _ => Ok(()),
    }
}

/// The elements of functions that belong to links.
fn of_links(
    knots: &Knots,
    configurations: &Configurations,
    links: &configurations::Links,
    of_link: &[Vec<(u32, f64)>],
) -> Elements {
    let mut set = Vec::new();
    Elements::of_configurations(knots, configurations, |_, corner, interior, take| {
        set.clear();
        set.extend_from_slice(interior);
        set.insert(interior.partition_point(|&id| id < corner), corner);
        let at = links.find(&set);
        at.into_iter().flat_map(|at| &of_link[at]).for_each(|&(function, factor)| take(function, factor));
    })
}

fn hull(elements: &Elements, element: usize, points: &[Point2]) -> Hull {
    let knots: Vec<Point2> = elements.knots(element).iter().map(|&id| points[id as usize]).collect();
    let extent = Extent::of(&knots);
    Hull { lower: extent.lower, upper: extent.upper, edges: hull_edges(&knots) }
}

/// The bounding box of the support of each function; empty if it has no element.
fn supports(elements: &Elements, hulls: &[Hull], functions: usize) -> Vec<[Point2; 2]> {
    let mut supports = vec![[[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]]; functions];
    for (at, hull) in hulls.iter().enumerate() {
        for share in elements.shares(at) {
            let [lower, upper] = &mut supports[share.function as usize];
            *lower = [0, 1].map(|axis| lower[axis].min(hull.lower[axis]));
            *upper = [0, 1].map(|axis| upper[axis].max(hull.upper[axis]));
        }
    }
    supports
}
