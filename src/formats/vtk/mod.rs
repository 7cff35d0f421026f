//! The points of VTK files: XML (VTU, VTP, VTS) and the legacy format. Everything else in the files is
//! ignored.
//!
//! Source: "VTK file formats" (docs.vtk.org), and the output of VTK. Headers are read once; a pass then reads
//! only the arrays of points. The reader is this project's own, because the crate `vtkio` builds a model of
//! the whole file in memory, including cells and attributes.

pub(crate) mod base64;
pub(crate) mod blocks;
pub(crate) mod elements;
pub(crate) mod framed;
pub(crate) mod legacy;
pub(crate) mod lengths;
pub(crate) mod vtu;
pub(crate) mod xml;

pub(crate) use framed::Framed;
pub(crate) use legacy::read as read_legacy;
pub(crate) use xml::read as read_xml;
