//! Command lines of `spfinalize`, `spdelaunay2d`, `spdelaunay3d`, `spnode` and `spinfo`.

pub mod lines;
pub mod point_filters;
mod reduction;
pub mod roots;
pub mod spdelaunay2d;
pub mod spdelaunay3d;
pub mod spfinalize;
pub mod spinfo;
pub mod spnode;
