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
//! `ARCHITECTURE.md` says why this is right. Data flow one way: [`intake`] reads points and holds them until their
//! cell is done, [`schedule`] says which node can be triangulated, [`node`] does that and cuts [`patches`], and
//! [`sequencer`] writes them in order. [`crew`] is the same on several threads.

mod arrivals;
mod boxes;
mod crew;
mod disks;
mod duplicates;
mod intake;
mod merge;
mod node;
mod partial;
mod patches;
mod plan;
mod residual;
mod run;
mod schedule;
mod sequencer;
mod stats;
mod worker;

pub use duplicates::Duplicates;
pub use merge::merge;
pub use partial::Part;
pub use run::{Options, triangulate};
pub use stats::Stats;
