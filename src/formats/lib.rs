//! Files of other programs: points, meshes, molecules, volumes and rasters, read and written.

mod cell_index;
pub mod crs;
pub mod detect;
pub mod las;
pub mod outline;
pub mod raster;
pub mod sink;
pub mod source;
