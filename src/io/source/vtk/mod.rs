//! The points of VTK files: XML (VTU, VTP, VTS) and the legacy format, whatever else they hold.
//!
//! Source: "VTK file formats" (docs.vtk.org), and what VTK writes. Headers are read once; a pass then reads the arrays of
//! points alone. The reader is this project's own: `vtkio`, the crate there is, makes a model in memory of a whole file,
//! cells and attributes with it.

mod blocks;
mod elements;
mod framed;
mod legacy;
mod xml;

pub(super) use framed::Framed;
pub(super) use legacy::read as read_legacy;
pub(super) use xml::read as read_xml;

/// First bytes of the legacy format.
const LEGACY_START: &[u8] = b"# vtk DataFile";

/// Whether a file that starts with `head` is of the legacy format.
pub(super) fn is_legacy(head: &[u8]) -> bool {
    head.starts_with(LEGACY_START)
}

/// Whether a file that starts with `head` is one of the XML formats.
pub(super) fn is_xml(head: &[u8]) -> bool {
    const ROOT: &[u8] = b"<VTKFile";
    let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
    text.starts_with(ROOT)
        || (text.starts_with(b"<?xml") || text.starts_with(b"<!--"))
            && text.windows(ROOT.len()).any(|window| window == ROOT)
}
