//! Plain data that kernels, streams and tools share. Nothing here reads, writes or decides.
//!
//! | module | what it holds |
//! |---|---|
//! | [`attributes`] | what points carry beside their coordinates |
//! | [`points`] | points of the plane and of space, as arrays of f64 |
//! | [`bounds`] | closed bounding boxes, and half-open regions for tiles |
//! | [`bits`] | interleaved bits: Morton keys and location codes |
//! | [`cells`] | the finalization tree: a quadtree or octree whose cell borders are exact |
//! | [`cells4`] | cells of 4D diagrams in flat arrays |
//! | [`configurations`] | configurations of one degree, and links of k-sets |
//! | [`decimal`] | numbers as canonical decimals |
//! | [`functions`] | functions of quadratic splines, as sums of B-splines |
//!
//! The rest of this crate reads and writes these types.
//!
//! # Example
//!
//! ```
//! use spmesh_stream::model::bounds::Bounds;
//! use spmesh_stream::model::cells::{CellCode, CellTree};
//!
//! let bounds = Bounds::of_points(&[[0.0, 0.0, 0.0], [10.0, 7.0, 0.0]]).expect("two points");
//! let tree = CellTree::covering(&bounds, 2, 4).expect("a finite cube");
//! let cell = tree.cell_of([3.0, 4.0, 0.0], 2);
//! assert_eq!(tree.level(cell), 2);
//! assert_eq!(tree.parent(cell).and_then(|parent| tree.parent(parent)), Some(CellCode::ROOT));
//! ```

pub mod attributes;
pub mod bits;
pub mod bounds;
pub mod cells;
pub mod cells4;
pub mod configurations;
pub mod decimal;
pub mod diagram4;
pub mod functions;
pub mod points;
