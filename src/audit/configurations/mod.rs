//! Checks of configurations, with knots, ranks and arrays of their own: none of the code that makes
//! configurations is used.
//!
//! [`check_facets`] is proposition 6.2.1 and lemma 7.4.1 of the thesis, word for word. Splines need exactly
//! that, whatever the rule of the configurations. [`check_functions`] proves that functions name links. [`check_circles`] is the definition of Delaunay
//! configurations. [`check_centroids`] proves that centroid triangulations are planar. [`StreamAudit`] checks
//! all of them for a stream.

mod arrays;
mod circles;
mod facets;
mod knots;
mod planar;
mod set;
mod stream;

pub use arrays::Configurations;
pub use circles::check_circles;
pub use facets::{FacetCounts, check_facets, check_start};
pub use knots::Knots;
pub use planar::check_centroids;
pub use set::{ConfigurationSet, check_functions};
pub use stream::{DegreeProof, Proof, StreamAudit, Violation, check};

// Two terms of the stream format: data, not code.
pub(super) use spmesh_stream::model::configurations::{Claim, FARAWAY};
