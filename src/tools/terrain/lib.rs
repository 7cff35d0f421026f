//! Rasters and contour lines of triangle meshes, drawn while triangles arrive; and rasters of points.

mod accumulators;
pub mod contours;
pub mod dem;
pub mod files;
pub mod points;
mod surface;
