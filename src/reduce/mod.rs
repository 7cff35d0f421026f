//! Streaming Delaunay triangulation in 2D as a reduction over a quadtree of bulk triangulations.
//!
//! Thesis 5.3 keeps one triangulation and inserts into it; here every cell of the finalization tree is
//! triangulated alone, and a node of the tree triangulates what its children could not finish:
//!
//! * A triangle is *final at a node* if its circumscribing disk certainly lies in the node's box
//!   ([`crate::predicates::circle`]). Final triangles are written and forgotten.
//! * The *residual* of a node is what is left: the vertices of all triangles that are not final, all vertices
//!   of the hull (their infinite triangles are not final), and the *walls*, directed edges that separate final
//!   triangles on their left from others.
//! * A node whose children are done triangulates the union of their residuals; triangles in the holes behind
//!   the walls are dropped; the rest is tested against the node's box. At the root all are final.
//!
//! `ARCHITECTURE.md` says why this is right. Data flow one way: [`arrivals`] sorts points into cells that are
//! done, [`node`] triangulates, [`patches`] writes, [`tree`] keeps residuals until their node is complete.

mod arrivals;
mod duplicates;
mod merge;
mod node;
mod partial;
mod patches;
mod pool;
mod residual;
mod run;
mod stats;
mod tree;

pub use duplicates::Duplicates;
pub use merge::merge;
pub use partial::Part;
pub use run::{Options, triangulate};
pub use stats::Stats;
