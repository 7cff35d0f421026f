//! Meshes for drawing and simulation: DXF, LandXML, Medit.

pub(crate) mod dxf;
pub(crate) mod landxml;
pub(crate) mod medit;
