//! Files of other programs: points, meshes, molecules, volumes and rasters, read and written.

pub mod cad;
mod conversion;
pub mod crs;
pub mod detect;
pub mod drivers;
mod historical;
pub mod las;
pub mod ledger;
mod lines;
pub mod molecules;
mod npy;
mod obj;
pub mod outline;
mod ply;
pub mod raster;
mod raw;
pub mod sink;
pub mod source;
mod tables;
mod text;
mod twin;
pub mod volumes;
mod vtk;
