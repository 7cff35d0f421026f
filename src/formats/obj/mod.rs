//! OBJ (Wavefront): meshes and points.

pub(crate) mod read;
pub(crate) mod write;
