//! Checks of configurations, which know the arrays but none of the code that fills them.
//!
//! [`check_facets`] is proposition 6.2.1 and lemma 7.4.1 of the thesis, word for word: what splines need, by whatever rule
//! the configurations were made. [`check_circles`] is the definition of Delaunay configurations, [`check_centroids`] what
//! makes centroid triangulations planar. [`StreamAudit`] asks all of it of a stream.

mod circles;
mod disk;
mod facets;
mod planar;
mod stream;
mod tree;

pub use circles::check_circles;
pub use facets::{FacetCounts, check_facets, check_start};
pub use planar::check_centroids;
pub use stream::{DegreeProof, Proof, StreamAudit, Violation, check};
