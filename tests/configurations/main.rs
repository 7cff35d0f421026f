//! Delaunay configurations against their definition and their theory.

mod borders;
mod centroids;
mod definition;
#[path = "../audit/held.rs"]
mod held;
mod hubs;
mod lifted;
mod rules;
mod special_boxes;
mod special_features;
mod spline;
mod union_map;

use spmesh_audit::configurations::{self as audit, FacetCounts};
use spmesh_base::error::Result;
use spmesh_configurations::{self as configurations, Configurations, Knots, Rule};

use spmesh_reference::configurations::Configuration;
use spmesh_reference::normalised;

/// The knots at the points, which must be valid.
fn knots(points: &[[f64; 2]]) -> Knots {
    Knots::new(points.to_vec()).expect("finite points")
}

/// All Delaunay configurations up to a degree.
fn delaunay(points: &[[f64; 2]], degree: usize) -> Vec<Configurations> {
    let knots = knots(points);
    let start = configurations::delaunay(&knots).expect("points that are not all on a line");
    configurations::generate(&knots, start, &Rule::Delaunay, degree)
        .unwrap_or_else(|error| panic!("{error}: let points = vec!{points:?};"))
}

/// Configurations as a plain list, in the order of the reference.
fn listed(configurations: &Configurations) -> Vec<Configuration> {
    let all = configurations.iter().map(|(boundary, interior)| (normalised(boundary), interior.to_vec()));
    let mut all: Vec<Configuration> = all.collect();
    if configurations.degree() == 0 {
        all.sort_unstable();
    }
    all
}

/// Checks with the audit that facets match.
fn check_facets(lower: &Configurations, upper: &Configurations) -> Result<FacetCounts> {
    audit::check_facets(&held::configurations(lower), &held::configurations(upper))
}

/// Checks with the audit that circles are right.
fn check_circles(knots: &Knots, configurations: &Configurations) -> Result<()> {
    audit::check_circles(&held::knots(knots), &held::configurations(configurations))
}
