//! Values between the vertices: linear in each triangle, or smooth by natural neighbours.
//!
//! Both interpolators remember the triangle of their last target, so that targets along a line, a raster or a
//! curve each cost a few steps; to other targets they walk from the nearest of many triangles. What they
//! answer does not depend on the targets before.
//!
//! ```
//! use spmesh_delaunay::delaunay2::interpolation::{Linear, NaturalNeighbours};
//! use spmesh_delaunay::delaunay2::triangulate;
//!
//! let mesh = triangulate(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [2.0, 2.0]])?;
//! let heights = [0.0, 4.0, 8.0, 4.0, 4.0];
//! assert_eq!(Linear::new(&mesh).interpolate(&heights, [2.0, 1.0]), Some(3.0));
//! let mut natural = NaturalNeighbours::new(&mesh);
//! let height = natural.interpolate(&heights, [2.0, 1.0]).expect("a target inside");
//! assert!((height - 3.0).abs() < 1e-11);
//! assert_eq!(natural.weights([4.0, 1.0]), Some(&[(1, 0.75), (2, 0.25)][..]));
//! assert_eq!(natural.interpolate(&heights, [5.0, 1.0]), None);
//! # Ok::<(), spmesh_delaunay::Error>(())
//! ```

mod cavity;
mod exact_areas;
mod gradients;
mod linear;
mod natural;
mod stolen_areas;

pub use linear::Linear;
pub use natural::NaturalNeighbours;
