//! From points to a mesh that streams (thesis, chapter 5).
//!
//! | module | program |
//! |---|---|
//! | `finalize` | `spfinalize`, with `lines` and `polygons`: breaklines, water and areas |
//! | [`reduce`] | `spdelaunay2d`, `spdelaunay3d` |
//! | `plan` | `spnode`: plans of meshes that many jobs make |
//!
//! `flags`, with the feature of this name, has their command lines and that of `spinfo`. Without the feature
//! `files`, there is [`reduce`] alone, which knows streams only.

#[cfg(feature = "files")]
pub mod finalize;
#[cfg(feature = "flags")]
pub mod flags;
#[cfg(feature = "files")]
pub mod lines;
#[cfg(feature = "files")]
pub mod plan;
#[cfg(feature = "files")]
pub mod polygons;
pub mod reduce;
#[cfg(feature = "files")]
mod regions;
