//! Plans of meshes that many jobs make, on one machine or on many.
//!
//! A [`Plan`] divides the box of all points into the boxes of leaves, and says which files reach into each of
//! them; the nodes above join what their children left. It is made from the headers of files alone
//! ([`plan_of`]). A node writes its part of the mesh, its residual, and a [`NodeReport`], which says that it
//! is complete. All of them have its name, a hash of all that they depend on: so plans share what is the same
//! in them. A [`Maker`] makes nodes, and [`collect()`] makes all parts one mesh, after it has compared the
//! reports of all nodes with what the files state. [`incomplete`] says what is to be made, and [`spent`] what
//! no plan needs any more.

mod align;
mod check;
mod clean;
mod collect;
mod files;
mod folder;
mod lattice;
mod leaf;
mod make;
mod names;
mod node;
mod planning;
mod report;
mod skipping;
mod states;
mod tree;

pub use clean::{Spent, remove, spent};
pub use collect::collect;
pub use files::{Naming, PlannedFile, Roots};
pub use make::{Again, Maker, Work};
pub use node::{Node, NodeBox, NodeKind};
pub use planning::{Plan, Planning, plan_of};
pub use report::{FileCount, FileSize, NodeReport, hash_of_file};
pub use skipping::SkipList;
pub use states::{batches, expected, incomplete};
