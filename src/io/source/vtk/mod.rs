//! The points of VTK files: XML (VTU, VTP, VTS) and the legacy format, whatever else they hold.
//!
//! Source: "VTK file formats" (docs.vtk.org), and what VTK writes. Headers are read once; a pass then reads
//! the arrays of points alone. The reader is this project's own: `vtkio`, the crate there is, makes a model
//! in memory of a whole file, cells and attributes with it.

mod blocks;
mod elements;
mod framed;
mod legacy;
mod lengths;
mod xml;

pub(super) use framed::Framed;
pub(super) use legacy::read as read_legacy;
pub(super) use xml::read as read_xml;
