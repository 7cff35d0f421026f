//! Predicates, orders and kernels against slow and plain references.

mod arrays;
mod circle;
mod constrained;
mod constrained_triangulation;
mod curves;
mod forms;
mod grids;
mod insertion;
mod interpolation;
mod kernel;
mod kernel3;
mod kernel_predicates;
mod kernel_predicates3;
mod nearest;
mod noding;
mod order;
mod parallel;
mod promises;
mod queries;
mod references;
mod sphere;
mod voronoi;
