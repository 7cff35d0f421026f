//! Recognises files by their content. Names say little: data arrives through pipes, and endings lie.

use std::io::Read;

use super::lines::number;
use super::origin::FileView;
use super::vtk;
use spmesh_core::error::{Error, Result};

/// Bytes from the start of a file that are looked at.
const HEAD_LEN: u64 = 1 << 16;

/// What a file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Format {
    /// LAS, LAZ or COPC.
    Las,
    /// A stream of this project.
    Stream,
    /// The text twin of such a stream.
    Twin,
    /// Streaming points as text, by Isenburg.
    Spa,
    /// Streaming points as bytes, by Isenburg.
    Spb,
    /// Vertices, and maybe faces, with a header that says how they are written.
    Ply,
    /// Vertices and faces as lines of statements.
    Obj,
    /// Legacy files of VTK.
    VtkLegacy,
    /// XML files of VTK.
    VtkXml,
    /// Lines of coordinates.
    Text,
}

const PCD: &str = "a PCD file: convert it first, for example with pdal translate";

const HDF: &str = "an HDF5 file: write it as VTU or raw numbers first, for example with ParaView or h5dump";
const MEDIT: &str = "a Medit mesh: convert it first, for example with meshio convert IN.mesh OUT.ply";
const INR: &str = "an INRIMAGE: it holds voxels and no points; list those that are wanted as lines of x y z";

const PDB: &str = "a PDB file, which tess3 reads: give points as lines of x y z";
const MMCIF: &str = "an mmCIF file, which tess3 reads: give points as lines of x y z";

/// First bytes of files that are often given by mistake, and what to do about it.
const MISTAKEN: [(&[u8], &str); 18] = [
    (b"\x1f\x8b", "gzip data: decompress it first, for example with zcat"),
    (b"\x28\xb5\x2f\xfd", "zstd data: decompress it first, for example with zstdcat"),
    (b"PK\x03\x04", "a zip archive: unpack it first, for example with unzip -p"),
    (b"BZh", "bzip2 data: decompress it first, for example with bzcat"),
    (b"\xfd7zXZ\x00", "xz data: decompress it first, for example with xzcat"),
    (b"\xff\xfe", "text in UTF-16: convert it first, for example with iconv -f utf-16 -t utf-8"),
    (b"# .PCD", PCD),
    (b"VERSION .7", PCD),
    (b"VERSION 0.7", PCD),
    (b"\x89HDF", HDF),
    (b"MeshVersionFormatted", MEDIT),
    (b"#INRIMAGE", INR),
    (b"HEADER  ", PDB),
    (b"REMARK  ", PDB),
    (b"CRYST1 ", PDB),
    (b"ATOM  ", PDB),
    (b"HETATM", PDB),
    (b"data_", MMCIF),
];

/// What `file` is.
///
/// # Errors
/// If it is empty or of no known format.
pub(super) fn detect(file: &FileView) -> Result<Format> {
    let mut head = Vec::new();
    let mut start = file.range(0, file.len()).take(HEAD_LEN);
    start.read_to_end(&mut head).map_err(|e| Error::io("reading", e))?;
    if head.is_empty() {
        return Err(Error::malformed("empty: no point file has no bytes at all"));
    }
    if head.starts_with(b"LASF") {
        return Ok(Format::Las);
    }
    if head.starts_with(b"\x89SPM") {
        return Ok(Format::Stream);
    }
    if head.starts_with(b"#spmesh ") {
        return Ok(Format::Twin);
    }
    if let Some((_, what)) = MISTAKEN.iter().find(|(magic, _)| head.starts_with(magic)) {
        return Err(Error::malformed(format!("is {what}")));
    }
    if head.starts_with(b"ply\n") || head.starts_with(b"ply\r") {
        return Ok(Format::Ply);
    }
    if vtk::is_legacy(&head) {
        return Ok(Format::VtkLegacy);
    }
    if vtk::is_xml(&head) {
        return Ok(Format::VtkXml);
    }
    // Version 7, byte order 0 or 1, then data type (two bits) and finalization method.
    if let [7, 0 | 1, flags, ..] = head[..]
        && flags & 3 < 3
        && flags >> 2 <= 4
    {
        return Ok(Format::Spb);
    }
    if let Some(at) = head.iter().position(|&byte| byte == 0) {
        return Err(Error::malformed(format!(
            "zero byte at byte {at}: not text, and neither LAS, LAZ, SPB, VTK nor a spmesh stream"
        )));
    }
    if head.starts_with(b"# OBJ") || is_mesh(&head) {
        return Ok(Format::Obj);
    }
    Ok(if is_spa(&head) { Format::Spa } else { Format::Text })
}

/// Whether lines of vertices have others beside them that only meshes have: faces, normals, materials, groups.
fn is_mesh(head: &[u8]) -> bool {
    let (mut has_vertex, mut has_more) = (false, false);
    for line in head.split(|&byte| byte == b'\n') {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        match words.next() {
            Some(b"v") => has_vertex |= words.next().and_then(number).is_some(),
            Some(b"f" | b"vn" | b"vt" | b"mtllib" | b"usemtl" | b"o" | b"g" | b"s") => has_more = true,
            _ => {}
        }
    }
    has_vertex && has_more
}

/// Whether text is SPA: by its first event, or by the fields of its header.
fn is_spa(head: &[u8]) -> bool {
    let mut has_fields = false;
    for line in head.split(|&byte| byte == b'\n') {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        let Some(first) = words.next() else { continue };
        if first.starts_with(b"#") {
            let field = words.next().unwrap_or_default();
            has_fields |= matches!(field, b"npoints" | b"datatype" | b"finalizemethod")
                || field.starts_with(b"bb_min")
                || field.starts_with(b"bb_max");
            continue;
        }
        let second = words.next().unwrap_or_default();
        return match first {
            b"v" | b"p" => number(second).is_some(),
            b"x" => second == b"cell",
            _ => false,
        };
    }
    has_fields
}
