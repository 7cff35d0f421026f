//! The points of VTK files: XML (VTU, VTP, VTS) and the legacy format. Everything else in the files is
//! ignored.
//!
//! Source: "VTK file formats" (docs.vtk.org), and the output of VTK. Headers are read once; a pass then reads
//! only the arrays of points. The reader is this project's own, because the crate `vtkio` builds a model of
//! the whole file in memory, including cells and attributes.

mod blocks;
mod elements;
mod framed;
mod legacy;
mod lengths;
mod xml;

pub(super) use framed::Framed;
pub(super) use legacy::read as read_legacy;
pub(super) use xml::read as read_xml;
