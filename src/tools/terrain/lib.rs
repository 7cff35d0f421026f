//! Rasters and contour lines of triangle meshes, drawn while triangles arrive.

pub mod contours;
pub mod dem;
mod surface;
