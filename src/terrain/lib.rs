//! Terrain of triangle meshes: rasters and contour lines, drawn while triangles arrive; rasters of points;
//! heights above the ground; breaklines.
//!
//! | module | program |
//! |---|---|
//! | [`dem`], [`contours`], [`bends`], [`points`], [`files`] | `spdem` |
//! | [`height`] | `spheight` |
//! | [`canopy`], with [`height`], [`meshing`] and [`dem`] | `spcanopy` |
//! | [`ground`], with [`height`] and [`meshing`] | `spground` |
//! | [`constrain`] | `spconstrain` |
//! | [`report`], with [`height`] | `spreport` |
//! | [`diff`], with [`height`] | `spdiff` |
//! | [`simplify`], with [`height`] and [`meshing`] | `spsimplify` |
//! | [`tiles`], with [`simplify`] | `sptiles` |
//!
//! `flags`, with the feature of this name, has their command lines.

mod accumulators;
pub mod bends;
pub mod canopy;
pub mod constrain;
pub mod contours;
pub mod dem;
pub mod diff;
pub mod files;
#[cfg(feature = "flags")]
pub mod flags;
pub mod ground;
pub mod height;
pub mod meshing;
pub mod points;
pub mod report;
pub mod simplify;
mod surface;
pub mod tiles;
