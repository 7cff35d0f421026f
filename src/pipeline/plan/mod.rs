//! Plans of meshes that many jobs make, on one machine or on many.
//!
//! A [`Plan`] divides the box of all points into the boxes of leaves, and says which files reach into each of
//! them; the nodes above join what their children left. It is made from the headers of files alone
//! ([`plan_of`]). A node writes its part of the mesh, its residual, and a [`NodeReport`], which says that it
//! is complete. A [`Maker`] makes nodes, and [`collect()`] makes all parts one mesh, after it has compared
//! the reports of all nodes with what the files state.

mod align;
mod check;
mod collect;
mod files;
mod folder;
mod leaf;
mod make;
mod node;
mod planning;
mod report;
mod tree;

pub use collect::collect;
pub use files::PlannedFile;
pub use make::{Maker, Work};
pub use node::{Node, NodeBox, NodeKind};
pub use planning::{Plan, Planning, plan_of};
pub use report::{FileCount, FileSize, NodeReport, hash_of_file};
