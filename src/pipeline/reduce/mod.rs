//! Streaming Delaunay triangulation as a reduction over a tree of bulk triangulations: a quadtree, or an
//! octree in space.
//!
//! Thesis 5.3 keeps one triangulation and inserts into it. Here, every cell of the finalization tree is
//! triangulated alone, and a node of the tree triangulates what its children could not finish:
//!
//! * A simplex, that is a triangle or a tetrahedron, is *final at a node* if its circumscribing ball
//!   certainly lies in the node's box ([`spmesh_delaunay::predicates::circle`],
//!   [`spmesh_delaunay::predicates::sphere`]). Final simplices are written and forgotten.
//! * The *residual* of a node consists of the vertices of all simplices that are not final, infinite ones
//!   included, and the *walls*, oriented facets that separate final simplices from others.
//! * A node whose children are done triangulates the union of their residuals, drops the simplices in the
//!   holes behind the walls, and tests the others against its box. At the root, all are final.
//!
//! `docs/theory/reduction.md` proves it. Data flow one way: [`reader`] reads points and holds them in a
//! [`cell_buffer`] until their cell is complete, [`schedule`] finds the nodes that can be triangulated,
//! [`node`] triangulates them and cuts [`patches`], and [`sequencer`] writes them in order. [`coordinator`]
//! does the same on several threads. A [`division`] cuts crowded cells, [`sample`] finds nodes that are not
//! worth triangulating, and [`budget`] keeps the limit of memory. [`merge`] joins the results of partial
//! runs, each of which is a [`tile`]. All of it is for D dimensions; [`bulk`] hides the differences between
//! [`plane`] and [`space`].

mod beside;
mod border;
mod boxes;
mod budget;
mod bulk;
mod cell_buffer;
mod coordinator;
mod cover;
mod disks;
mod division;
mod duplicates;
mod join;
mod merge;
mod merging;
mod misfit;
mod node;
mod origins;
mod partial;
mod patches;
mod plan;
mod plane;
mod reader;
mod regions;
mod residual;
mod rules;
mod run;
mod run_state;
mod sample;
mod schedule;
mod sequencer;
mod shape;
mod shared;
mod sides;
mod space;
mod stats;
mod tile;
mod walls;
mod worker;

pub use cover::missing_region;
pub use duplicates::Duplicates;
pub use join::{join_tetrahedra, join_triangles};
pub use merge::{merge_tetrahedra, merge_triangles};
pub use partial::Part;
pub use run::{Options, tetrahedralize, tetrahedralize_part, triangulate, triangulate_part};
pub use sequencer::Outputs;
#[cfg(feature = "files")]
pub(crate) use shape::are_on_surface;
pub use stats::Stats;
