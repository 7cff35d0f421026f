//! Recognizes formats by the first bytes of an input: one table for all tools. File names are not used: data
//! arrives through pipes, and extensions can be wrong.

mod binary;
mod readers;
mod text;

use std::io::{self, Read};

use spmesh_base::error::{Error, Result};

pub use readers::{
    CONFIGGEN, DD4, READERS, Reader, SPCANOPY, SPCONVERT, SPFINALIZE, SPHEIGHT, SPINFO, SPLINEFIT, TESS3,
};
pub(crate) use text::is_off;

/// Bytes from the start of an input that recognition needs.
pub const HEAD_LEN: u64 = 1 << 16;

/// The byte order mark that some editors write before UTF-8 text.
pub const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// The format of an input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// LAS, LAZ or COPC.
    Las,
    /// A binary stream of this project.
    Stream,
    /// The text twin of such a stream.
    Twin,
    /// Isenburg's streaming points, text.
    Spa,
    /// Isenburg's streaming points, binary.
    Spb,
    /// Isenburg's streaming meshes, text.
    Sma,
    /// Isenburg's streaming meshes, binary.
    Smb,
    /// Stanford PLY.
    Ply,
    /// Wavefront OBJ.
    Obj,
    /// Lines of `v`, possibly followed by lines of `f`: OBJ, or SMA or SPA without a header.
    VertexLines,
    /// OFF, the object file format of Geomview.
    Off,
    /// The legacy format of VTK.
    VtkLegacy,
    /// The XML formats of VTK.
    VtkXml,
    /// An array of numpy.
    Npy,
    /// PDB.
    Pdb,
    /// PDBx/mmCIF.
    Mmcif,
    /// XYZ of chemistry.
    Xyz,
    /// NRRD.
    Nrrd,
    /// NIfTI.
    Nifti,
    /// Lines of coordinates.
    Text,
    /// Text in which no line of coordinates was seen.
    OtherText,
    /// gzip.
    Gzip,
    /// Zstandard.
    Zstd,
    /// zip.
    Zip,
    /// bzip2.
    Bzip2,
    /// xz.
    Xz,
    /// compress, of older Unix systems.
    Compress,
    /// BinaryCIF.
    BinaryCif,
    /// Text in UTF-16.
    Utf16,
    /// PCD, of the Point Cloud Library.
    Pcd,
    /// HDF5.
    Hdf5,
    /// netCDF.
    Netcdf,
    /// Medit.
    Medit,
    /// INRIMAGE.
    Inrimage,
    /// TIFF.
    Tiff,
    /// XML or HTML of another kind.
    Xml,
    /// Bytes of no known format.
    Binary,
}

/// How a format is recognized.
enum Test {
    /// The input starts with one of these.
    Magic(&'static [&'static [u8]]),
    /// A test of the first bytes, after a byte order mark if there is one.
    Look(fn(&[u8]) -> bool),
    /// Text, recognized by its lines.
    Lines,
}

/// A format: a new one is one row in [`ROWS`].
struct Row {
    format: Format,
    /// With its article, for "this is ...".
    name: &'static str,
    /// For "TOOL reads ...".
    listed: &'static str,
    test: Test,
    /// What the user can do if the tool does not read the format.
    hint: &'static str,
}

const fn row(
    format: Format,
    name: &'static str,
    listed: &'static str,
    test: Test,
    hint: &'static str,
) -> Row {
    Row { format, name, listed, test, hint }
}

const NO_LIST: &str = "";
const VALUES: &str = "write its values as NRRD or raw numbers first";
const TO_POINTS: &str = "make a point stream of its atoms with spfinalize --octree, or use tess3";
const TO_STREAM: &str = "convert it first with spconvert";
const TO_PLY: &str = "convert it first with spconvert --to ply";

/// All formats. The first row whose test passes is the format of an input.
const ROWS: [Row; 37] = [
    row(Format::Las, "a LAS, LAZ or COPC file", "LAS, LAZ, COPC", Test::Magic(&[b"LASF"]), ""),
    row(Format::Stream, "a spmesh stream", "spmesh streams", Test::Magic(&[b"\x89S"]), ""),
    row(
        Format::Twin,
        "the text twin of a spmesh stream",
        "their text twins",
        Test::Magic(&[b"#spmesh "]),
        "",
    ),
    row(Format::Nrrd, "an NRRD volume", "NRRD", Test::Magic(&[b"NRRD"]), "dd4 reads it"),
    row(Format::Nifti, "a NIfTI volume", "NIfTI", Test::Look(binary::is_nifti), "dd4 reads it"),
    row(
        Format::Npy,
        "an array of numpy",
        "NPY",
        Test::Magic(&[b"\x93NUMPY"]),
        "make a point stream of it with spfinalize",
    ),
    row(
        Format::Gzip,
        "gzip data within gzip data",
        NO_LIST,
        Test::Magic(&[b"\x1f\x8b"]),
        "decompress it first, for example with zcat",
    ),
    row(
        Format::Zstd,
        "zstd data",
        NO_LIST,
        Test::Magic(&[b"\x28\xb5\x2f\xfd"]),
        "decompress it first, for example with zstdcat",
    ),
    row(
        Format::Zip,
        "a zip archive",
        NO_LIST,
        Test::Magic(&[b"PK\x03\x04"]),
        "unpack it first, for example with unzip -p",
    ),
    row(
        Format::Bzip2,
        "bzip2 data",
        NO_LIST,
        Test::Magic(&[b"BZh"]),
        "decompress it first, for example with bzcat",
    ),
    row(
        Format::Xz,
        "xz data",
        NO_LIST,
        Test::Magic(&[b"\xfd7zXZ\x00"]),
        "decompress it first, for example with xzcat",
    ),
    row(
        Format::Compress,
        "data of compress (.Z)",
        NO_LIST,
        Test::Magic(&[b"\x1f\x9d"]),
        "decompress it first, for example with uncompress -c FILE.Z",
    ),
    row(
        Format::BinaryCif,
        "a BinaryCIF file",
        NO_LIST,
        Test::Look(binary::is_binary_cif),
        "download the entry as .cif or .cif.gz, or convert it first, for example with biotite",
    ),
    row(
        Format::Utf16,
        "text in UTF-16",
        NO_LIST,
        Test::Magic(&[b"\xff\xfe", b"\xfe\xff"]),
        "convert it first, for example with iconv -f utf-16 -t utf-8",
    ),
    row(
        Format::Pcd,
        "a PCD file",
        NO_LIST,
        Test::Magic(&[b"# .PCD", b"VERSION .7", b"VERSION 0.7"]),
        "convert it first, for example with pdal translate",
    ),
    row(
        Format::Hdf5,
        "HDF5, netCDF-4 or MINC data",
        NO_LIST,
        Test::Magic(&[b"\x89HDF"]),
        "write it as VTU, NRRD or raw numbers first, for example with ParaView or h5dump",
    ),
    row(Format::Netcdf, "netCDF data", NO_LIST, Test::Magic(&[b"CDF\x01", b"CDF\x02", b"CDF\x05"]), VALUES),
    row(
        Format::Medit,
        "a Medit mesh",
        NO_LIST,
        Test::Magic(&[b"MeshVersionFormatted"]),
        "convert it first, for example with meshio convert IN.mesh OUT.ply",
    ),
    row(
        Format::Inrimage,
        "an INRIMAGE, which holds voxels",
        NO_LIST,
        Test::Magic(&[b"#INRIMAGE"]),
        "list the wanted ones as lines of x y z",
    ),
    row(
        Format::Tiff,
        "a TIFF image",
        NO_LIST,
        Test::Magic(&[b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"]),
        "list its cells as lines of x y z, for example with gdal2xyz",
    ),
    row(Format::Ply, "a PLY file", "PLY", Test::Magic(&[b"ply\n", b"ply\r"]), ""),
    row(
        Format::VtkLegacy,
        "a VTK file of the legacy format",
        "VTK",
        Test::Magic(&[binary::VTK_LEGACY_START]),
        VALUES,
    ),
    row(Format::VtkXml, "a VTK file in XML", "VTK", Test::Look(binary::is_vtk_xml), VALUES),
    row(
        Format::Xml,
        "XML or HTML",
        NO_LIST,
        Test::Magic(&[b"<?xml", b"<!DOCTYPE", b"<!doctype", b"<html", b"<HTML"]),
        "it may be the error page of a failed download",
    ),
    row(Format::Spb, "an SPB file", "SPB", Test::Look(binary::is_spb), TO_STREAM),
    row(Format::Smb, "an SMB mesh", "SMB", Test::Look(binary::is_smb), TO_PLY),
    row(Format::Binary, "of no known format", NO_LIST, Test::Look(|head| head.contains(&0)), ""),
    row(Format::Xyz, "an XYZ file of chemistry", "XYZ of chemistry", Test::Lines, TO_POINTS),
    row(Format::Pdb, "a PDB file", "PDB", Test::Lines, TO_POINTS),
    row(Format::Mmcif, "an mmCIF file", "mmCIF", Test::Lines, TO_POINTS),
    row(Format::Off, "an OFF file", "OFF", Test::Lines, "tess3 reads its vertices"),
    row(Format::Obj, "an OBJ file", "OBJ", Test::Lines, ""),
    row(Format::Spa, "an SPA file", "SPA", Test::Lines, TO_STREAM),
    row(Format::Sma, "an SMA mesh", "SMA", Test::Lines, TO_STREAM),
    row(Format::VertexLines, "lines of v: an OBJ, SMA or SPA file", "OBJ", Test::Lines, ""),
    row(Format::Text, "lines of numbers", "lines of coordinates", Test::Lines, ""),
    row(Format::OtherText, "text of no known format", "lines of coordinates", Test::Lines, ""),
];

impl Format {
    fn row(self) -> &'static Row {
        ROWS.iter().find(|row| row.format == self).expect("every format has its row")
    }

    /// All formats, in the order in which they are tried.
    pub fn all() -> impl Iterator<Item = Format> {
        ROWS.iter().map(|row| row.format)
    }

    /// Name of the format in messages, with an article.
    pub fn name(self) -> &'static str {
        self.row().name
    }
}

/// The format of an input that starts with `head`, its first [`HEAD_LEN`] bytes or all it has.
///
/// # Errors
/// Malformed, if the input is empty.
pub fn detect(head: &[u8]) -> Result<Format> {
    if head.is_empty() {
        return Err(Error::malformed("empty: the input has no bytes"));
    }
    let body = head.strip_prefix(BYTE_ORDER_MARK).unwrap_or(head);
    let fits = |row: &&Row| match row.test {
        Test::Magic(starts) => starts.iter().any(|start| body.starts_with(start)),
        Test::Look(fits) => fits(body),
        Test::Lines => false,
    };
    Ok(ROWS.iter().find(fits).map_or_else(|| text::detect(body), |row| row.format))
}

/// The first bytes of `input`, as many as [`detect`] needs.
///
/// # Errors
/// If reading fails.
pub fn read_head(input: &mut impl Read) -> io::Result<Vec<u8>> {
    let mut head = Vec::new();
    input.take(HEAD_LEN).read_to_end(&mut head)?;
    Ok(head)
}
