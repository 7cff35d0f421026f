//! What an input is, by its first bytes.

use std::io::Read;
use std::path::Path;

use super::scan::Supply;
use super::{nifti, nrrd, stream, text};
use crate::source::gzip::Plain;
use crate::source::origin::Origin;
use spmesh_core::error::{Error, Result};

/// Bytes from the start of an input that are looked at.
const HEAD_LEN: u64 = 1 << 12;

const HDF5: &str = "HDF5, netCDF-4 or MINC data: write its values as NRRD, NIfTI or raw numbers first";
const VTK: &str = "a VTK file: write its values as NRRD or raw numbers first";

/// First bytes of files that are given by mistake, and what to do about it.
const MISTAKEN: [(&[u8], &str); 11] = [
    (b"\x28\xb5\x2f\xfd", "zstd data: decompress it first, for example with zstdcat"),
    (b"PK\x03\x04", "a zip archive: unpack it first, for example with unzip -p"),
    (b"BZh", "bzip2 data: decompress it first, for example with bzcat"),
    (b"\xfd7zXZ\x00", "xz data: decompress it first, for example with xzcat"),
    (b"\x1f\x8b", "gzip data within gzip data: decompress it first, for example with zcat"),
    (b"\xff\xfe", "text in UTF-16: convert it first, for example with iconv -f utf-16 -t utf-8"),
    (b"CDF\x01", "netCDF data: write its values as NRRD or raw numbers first"),
    (b"CDF\x02", "netCDF data: write its values as NRRD or raw numbers first"),
    (b"\x89HDF", HDF5),
    (b"# vtk DataFile", VTK),
    (b"<", VTK),
];

/// Recognizes what `origin` holds and reads its header; `path` is where it is, if it has a name.
///
/// # Errors
/// If it is of no known format, or its header is malformed.
pub(super) fn open(origin: Origin, path: Option<&Path>, warnings: &mut Vec<String>) -> Result<Supply> {
    let reading = |e| Error::io("reading", e);
    let mut plain = Plain::new(origin.view()?).map_err(reading)?;
    let mut head = Vec::new();
    (&mut plain).take(HEAD_LEN).read_to_end(&mut head).map_err(reading)?;
    if head.starts_with(b"NRRD") {
        return nrrd::open(origin, path, warnings).map(Supply::Volume);
    }
    if nifti::is_header(&head) {
        return nifti::open(origin, &head, plain.is_compressed(), warnings).map(Supply::Volume);
    }
    if stream::is_head(&head) {
        return stream::open(origin, path, &head);
    }
    if let Some((_, what)) = MISTAKEN.iter().find(|(magic, _)| head.starts_with(magic)) {
        return Err(Error::malformed(format!("is {what}")));
    }
    if let Some(at) = head.iter().position(|&byte| byte == 0) {
        let message = "not text, and neither NRRD, NIfTI nor a spmesh stream; \
                       for raw numbers of a volume give sizes and type with --raw";
        return Err(Error::malformed(format!("zero byte at byte {at}: {message}")));
    }
    text::open(origin)
}
