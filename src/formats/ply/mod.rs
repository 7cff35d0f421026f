//! PLY (Stanford): points, meshes and surfaces.

pub(crate) mod header;
pub(crate) mod properties;
pub(crate) mod read;
pub(crate) mod surface;
pub(crate) mod write;
