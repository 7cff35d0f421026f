//! Streaming Delaunay triangulation as a reduction over a tree of bulk triangulations: a quadtree, or an octree in space.
//!
//! Thesis 5.3 keeps one triangulation and inserts into it; here every cell of the finalization tree is
//! triangulated alone, and a node of the tree triangulates what its children could not finish:
//!
//! * A simplex, that is a triangle or a tetrahedron, is *final at a node* if its circumscribing ball certainly lies in the
//!   node's box ([`spmesh_geometry::predicates::circle`], [`spmesh_geometry::predicates::sphere`]). Final simplices are written and forgotten.
//! * The *residual* of a node is what is left: the vertices of all simplices that are not final, all vertices
//!   of the hull (their infinite simplices are not final), and the *walls*, oriented facets that separate final
//!   simplices from others.
//! * A node whose children are done triangulates the union of their residuals; simplices in the holes behind
//!   the walls are dropped; the rest is tested against the node's box. At the root all are final.
//!
//! `ARCHITECTURE.md` says why this is right. Data flow one way: [`reader`] reads points and holds them until their
//! cell is done, [`schedule`] says which node can be triangulated, [`node`] does that and cuts [`patches`], and
//! [`sequencer`] writes them in order. [`coordinator`] is the same on several threads. [`merge`] joins what partial runs have left,
//! each of which is a [`tile`]. All of it is for D dimensions; what differs between them is behind [`bulk`]: [`plane`] and
//! [`space`].

mod border;
mod boxes;
mod bulk;
mod cell_buffer;
mod coordinator;
mod disks;
mod duplicates;
mod merge;
mod node;
mod partial;
mod patches;
mod plan;
mod plane;
mod reader;
mod residual;
mod run;
mod sample;
mod schedule;
mod sequencer;
mod space;
mod stats;
mod tile;
mod walls;
mod worker;

pub use duplicates::Duplicates;
pub use merge::{merge_tetrahedra, merge_triangles};
pub use partial::Part;
pub use run::{Options, tetrahedralize, triangulate};
pub use stats::Stats;
