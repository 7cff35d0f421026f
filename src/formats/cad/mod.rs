//! Meshes for drawing, printing and simulation: DXF, glTF, LandXML, Medit, STL, UGRID.

pub(crate) mod dxf;
pub mod glb;
pub(crate) mod landxml;
pub(crate) mod medit;
pub(crate) mod stl;
pub(crate) mod ugrid;
