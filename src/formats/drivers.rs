//! The table of formats: their names, their first bytes, and what opens and writes them. What each tool
//! reads, the formats of `spconvert` and messages follow from it; text is recognized in `detect`.
//!
//! A new format is a folder with its reader and writer, and a row here.

use std::io::{BufReader, Read, Write};
use std::path::Path;

use crate::cad::{dxf::DxfSink, glb::GlbSink, landxml::LandXmlSink, medit::MeditSink};
use crate::cad::{stl::StlSink, ugrid::UgridSink};
use crate::detect::{Test, binary, structures};
use crate::historical::{read_sma::open_sma, read_smb::open_smb, sp_events::SpEvents};
use crate::historical::{read_spa, read_spa::SpaReader, read_spb, read_spb::SpbReader};
use crate::historical::{write_sma::SmaSink, write_smb::SmbSink, write_spa::SpaSink, write_spb::SpbSink};
use crate::lines::write_geojson::GeoJsonSink;
use crate::molecules::builder::StructureBuilder;
use crate::molecules::frames::{OpenFrames, dcd, texts, trr, xtc};
use crate::molecules::{atoms, binary_cif, gro, mmcif, pdb, xyz};
use crate::npy;
use crate::obj::{read as obj, write::ObjSink};
use crate::ply::{read as ply, write::PlySink};
use crate::sink::{EventSink, SinkOptions, SpmSink};
use crate::source::checked::Checked;
use crate::source::events::EventSource;
use crate::source::gzip::Use;
use crate::source::origin::Origin;
use crate::source::pass::{Content, Opening};
use crate::source::{point_arrays, records, stream};
use crate::text::lines::Lines;
use crate::text::read as text;
use crate::twin::{read::TwinSource, write::TwinSink};
use crate::volumes::scan::Supply;
use crate::volumes::{self, nifti, nrrd};
use crate::vtk::{self, vtu::VtuSink};
use spmesh_base::error::Result;
use spmesh_stream::{Header, StreamReader};

/// An input of any kind.
pub type AnyInput = Box<dyn Read + Send>;

/// The events of an input.
pub type Events = Box<dyn EventSource + Send>;

/// Opens an input, whose name is the second argument, as events. Points of formats that do not say have the
/// given number of dimensions.
pub type OpenEvents = fn(AnyInput, &str, u8) -> Result<Events>;

/// Opens the points in space of a file.
type OpenPoints = fn(&Opening, &mut Vec<String>) -> Result<Content>;

/// Reads the atoms of a structure.
type ReadAtoms = fn(Lines<AnyInput>, &mut StructureBuilder) -> Result<()>;

/// Opens the points in four dimensions of a file that may have a path, and starts with these bytes.
type OpenSites = fn(Origin, Option<&Path>, &[u8], &mut Vec<String>) -> Result<Supply>;

/// Starts an output.
type OpenSink = for<'a> fn(&'a mut dyn Write, &Header, &SinkOptions) -> Result<Box<dyn EventSink + 'a>>;

/// What the table says of a format.
pub(crate) struct Row {
    format: Format,
    /// With its article, for "this is ...".
    pub(crate) name: &'static str,
    /// For "TOOL reads ...".
    pub(crate) listed: &'static str,
    pub(crate) test: Test,
    /// What the user can do if the tool does not read the format.
    pub(crate) hint: &'static str,
    /// Value of `--from` and `--to`; empty if it has none.
    pub(crate) value: &'static str,
    /// Ending of names of files; empty if several or none stand for it.
    pub(crate) ending: &'static str,
    /// Whether a terminal cannot show what is written.
    is_binary: bool,
    /// Whether its parts are read in any order, so that a compressed file is unpacked first.
    pub(crate) is_in_parts: bool,
    pub(crate) points: Option<OpenPoints>,
    pub(crate) atoms: Option<ReadAtoms>,
    pub(crate) frames: Option<OpenFrames>,
    pub(crate) sites: Option<OpenSites>,
    pub(crate) events: Option<OpenEvents>,
    pub(crate) sink: Option<OpenSink>,
}

macro_rules! formats {
    ($($format:ident($name:literal, $listed:expr, $test:expr, $hint:expr) {
        $($field:ident: $value:expr),*
    })*) => {
        /// The format of an input or an output.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Format {
            $(#[doc = concat!("This is ", $name, ".")] $format,)*
        }

        /// All formats, in the order of messages. The first one whose test passes is the format of an input.
        pub(crate) static ROWS: &[Row] = &[$(Row {
            $($field: $value,)*
            ..row(Format::$format, $name, $listed, $test, $hint)
        },)*];
    };
}

const fn row(
    format: Format,
    name: &'static str,
    listed: &'static str,
    test: Test,
    hint: &'static str,
) -> Row {
    Row {
        format,
        name,
        listed,
        test,
        hint,
        value: "",
        ending: "",
        is_binary: false,
        is_in_parts: false,
        points: None,
        atoms: None,
        frames: None,
        sites: None,
        events: None,
        sink: None,
    }
}

const NO_LIST: &str = "";
const VALUES: &str = "write its values as NRRD or raw numbers first";
const TO_POINTS: &str = "make a point stream of its atoms with spfinalize --octree, or use tess3";
const TO_STRUCTURE: &str = "convert it to PDB or mmCIF first, for example with gemmi or obabel";
const WITH_TOPOLOGY: &str = "tess3 reads its frames with the structure that names the atoms: --top FILE";
const TO_STREAM: &str = "convert it first with spconvert";
const BY_PDAL: &str = "convert it first, for example with pdal translate IN OUT.laz";
const BY_MESHIO: &str = "convert it first, for example with meshio convert IN OUT.ply";
const AS_LINES: &str = "write its points as lines of x y z first";
const OF_FEATURES: &str =
    "it is read where features are, as by spfinalize --lines; write its points as lines of x y z first";
const OF_CELLS: &str = "list its cells as lines of x y z, for example with gdal2xyz";
const TO_PLY: &str = "convert it first with spconvert --to ply";

// Of each: its name with an article and in lists, its test, and a hint for tools that do not read it.
formats! {
    Las("a LAS, LAZ or COPC file", "LAS, LAZ, COPC", Test::Magic(&[b"LASF"]), "") {
        is_in_parts: true, points: Some(records::open)
    }
    Text("lines of numbers", "lines of coordinates", Test::Lines, "") {
        value: "points", points: Some(text::open), sites: Some(text_of_sites)
    }
    OtherText("text of no known format", "lines of coordinates", Test::Lines, "") {
        points: Some(text::open), sites: Some(text_of_sites)
    }
    Nrrd("an NRRD volume", "NRRD", Test::Magic(&[b"NRRD"]), "dd4 reads it") {
        sites: Some(|origin, path, _, warnings| nrrd::open(origin, path, warnings).map(Supply::of_volume))
    }
    Nifti("a NIfTI volume", "NIfTI", Test::Look(binary::is_nifti), "dd4 reads it") {
        sites: Some(|origin, _, head, warnings| nifti::open(origin, head, warnings).map(Supply::of_volume))
    }
    // Its preamble may look like an SMB mesh.
    Dicom("a DICOM image", NO_LIST, Test::Look(binary::is_dicom),
        "write it as NIfTI or NRRD first, for example with dcm2niix") {}
    Stream("a spmesh stream", "spmesh streams", Test::Magic(&[b"\x89S"]), "") {
        value: "spm", ending: "spm", is_binary: true,
        points: Some(|file, _| stream::open(file, open_stream, false)),
        sites: Some(|origin, path, _, _| volumes::stream::open(origin, path, false).map(Supply::Stream)),
        events: Some(open_stream),
        sink: Some(|to, header, how| {
            let header = Header { compressed: how.compress, ..header.clone() };
            Ok(Box::new(SpmSink::new(to, &header)?))
        })
    }
    Twin("the text twin of a spmesh stream", "their text twins", Test::Magic(&[b"#spmesh "]), "") {
        value: "text", ending: "txt",
        points: Some(|file, _| stream::open(file, open_twin, true)),
        sites: Some(|origin, path, _, _| volumes::stream::open(origin, path, true).map(Supply::Stream)),
        events: Some(open_twin),
        sink: Some(|to, header, _| Ok(Box::new(TwinSink::new(to, header)?)))
    }
    Spa("an SPA file", "SPA", Test::Lines, TO_STREAM) {
        value: "spa", ending: "spa",
        points: Some(|file, _| read_spa::open(file)),
        events: Some(|input, name, dims| SpEvents::open(SpaReader::new(input), name, dims)),
        sink: Some(|to, header, _| Ok(Box::new(SpaSink::new(to, header)?)))
    }
    Spb("an SPB file", "SPB", Test::Look(binary::is_spb), TO_STREAM) {
        value: "spb", ending: "spb", is_binary: true,
        points: Some(|file, _| read_spb::open(file)),
        events: Some(|input, name, dims| {
            SpEvents::open(SpbReader::new(BufReader::with_capacity(1 << 18, input)), name, dims)
        }),
        sink: Some(|to, header, _| Ok(Box::new(SpbSink::new(to, header)?)))
    }
    Ply("a PLY file", "PLY", Test::Magic(&[b"ply\n", b"ply\r"]), "") {
        value: "ply", ending: "ply", is_binary: true,
        points: Some(|file, _| stream::open(file, ply::open_vertices, true)), events: Some(ply::open_ply),
        sink: Some(|to, header, how| Ok(Box::new(PlySink::new(to, header, how)?)))
    }
    Obj("an OBJ file", "OBJ", Test::Lines, "") {
        value: "obj", ending: "obj",
        points: Some(vertices_of_obj), events: Some(|input, name, _| Ok(obj::open_obj(input, name))),
        sink: Some(|to, header, how| Ok(Box::new(ObjSink::new(to, header, how)?)))
    }
    // Vertex lines of SMA are those of OBJ; its other lines are skipped.
    Sma("an SMA mesh", "SMA", Test::Lines, TO_STREAM) {
        value: "sma", ending: "sma",
        points: Some(vertices_of_obj), events: Some(|input, name, _| open_sma(input, name)),
        sink: Some(|to, header, _| Ok(Box::new(SmaSink::new(to, header)?)))
    }
    Smb("an SMB mesh", "SMB", Test::Look(binary::is_smb), TO_PLY) {
        value: "smb", ending: "smb", is_binary: true,
        events: Some(|input, name, _| open_smb(input, name)),
        sink: Some(|to, header, how| Ok(Box::new(SmbSink::new(to, header, how.temp_dir.as_deref())?)))
    }
    // Possibly followed by lines of `f`: SMA or SPA without a header look like OBJ.
    VertexLines("lines of v: an OBJ, SMA or SPA file", "OBJ", Test::Lines, "") {
        points: Some(vertices_of_obj)
    }
    VtkLegacy("a VTK file of the legacy format", "VTK", Test::Magic(&[b"# vtk DataFile"]), VALUES) {
        is_in_parts: true,
        points: Some(|file, _| {
            Ok(point_arrays::content(vec![vtk::read_legacy(&file.origin.view()?, file.name)?]))
        })
    }
    VtkXml("a VTK file in XML", "VTK", Test::Look(binary::is_vtk_xml), VALUES) {
        value: "vtu", ending: "vtu", is_binary: true, is_in_parts: true,
        points: Some(|file, _| Ok(point_arrays::content(vtk::read_xml(&file.origin.view()?)?))),
        sink: Some(|to, header, how| Ok(Box::new(VtuSink::new(to, header, how.temp_dir.as_deref())?)))
    }
    Npy("an array of numpy", "NPY", Test::Magic(&[b"\x93NUMPY"]),
        "make a point stream of it with spfinalize") {
        is_in_parts: true, points: Some(|file, _| npy::read::open(file))
    }
    Pdb("a PDB file", "PDB", Test::Lines, TO_POINTS) {
        points: Some(atoms::open), atoms: Some(|mut lines, builder| pdb::read(&mut lines, builder, false)),
        frames: Some(texts::open_pdb)
    }
    Pqr("a PQR file", "PQR", Test::Lines, TO_POINTS) {
        points: Some(atoms::open), atoms: Some(|mut lines, builder| pdb::read(&mut lines, builder, true)),
        frames: Some(texts::open_pqr)
    }
    Mmcif("an mmCIF file", "mmCIF", Test::Lines, TO_POINTS) {
        points: Some(atoms::open), atoms: Some(mmcif::read)
    }
    BinaryCif("a BinaryCIF file", "BinaryCIF", Test::Look(binary::is_binary_cif), TO_POINTS) {
        points: Some(atoms::open), atoms: Some(binary_cif::read)
    }
    Xyz("an XYZ file of chemistry", "XYZ of chemistry", Test::Lines, TO_POINTS) {
        points: Some(atoms::open), atoms: Some(|mut lines, builder| xyz::read(&mut lines, builder)),
        frames: Some(texts::open_xyz)
    }
    Gro("a GRO file of GROMACS", "GRO", Test::Look(gro::is_gro), TO_POINTS) {
        points: Some(atoms::open), atoms: Some(|mut lines, builder| gro::read(&mut lines, builder)),
        frames: Some(texts::open_gro)
    }
    Xtc("an XTC trajectory of GROMACS", NO_LIST, Test::Magic(&[b"\0\0\x07\xcb", b"\0\0\x07\xe7"]), WITH_TOPOLOGY) {
        frames: Some(xtc::open)
    }
    Trr("a TRR trajectory of GROMACS", NO_LIST, Test::Magic(&[b"\0\0\x07\xc9"]), WITH_TOPOLOGY) {
        frames: Some(trr::open)
    }
    Dcd("a DCD trajectory", NO_LIST, Test::Look(dcd::is_dcd), WITH_TOPOLOGY) {
        frames: Some(dcd::open)
    }
    Off("an OFF file", "OFF", Test::Lines, "tess3 reads its vertices") {}
    Medit("a Medit mesh", NO_LIST, Test::Magic(&[b"MeshVersionFormatted"]),
        "convert it first, for example with meshio convert IN.mesh OUT.ply") {
        value: "medit", ending: "mesh",
        sink: Some(|to, header, how| Ok(Box::new(MeditSink::new(to, header, how.temp_dir.as_deref())?)))
    }
    Dxf("a DXF file", NO_LIST, Test::Never, "") {
        value: "dxf", ending: "dxf",
        sink: Some(|to, header, how| Ok(Box::new(DxfSink::new(to, header, how)?)))
    }
    LandXml("a LandXML file", NO_LIST, Test::Never, "") {
        value: "landxml", ending: "xml",
        sink: Some(|to, header, how| Ok(Box::new(LandXmlSink::new(to, header, how)?)))
    }
    GeoJson("a GeoJSON file", NO_LIST, Test::Never, "") {
        value: "geojson", ending: "geojson",
        sink: Some(|to, header, _| Ok(Box::new(GeoJsonSink::new(to, header)?)))
    }
    Gzip("gzip data within compressed data", NO_LIST, Test::Magic(&[b"\x1f\x8b"]),
        "decompress it first, for example with zcat") {}
    Zstd("zstd data within compressed data", NO_LIST, Test::Magic(&[b"\x28\xb5\x2f\xfd"]),
        "decompress it first, for example with zstdcat") {}
    Zip("a zip archive", NO_LIST, Test::Magic(&[b"PK\x03\x04"]),
        "unpack it first, for example with unzip -p") {}
    Bzip2("bzip2 data", NO_LIST, Test::Magic(&[b"BZh"]), "decompress it first, for example with bzcat") {}
    Xz("xz data", NO_LIST, Test::Magic(&[b"\xfd7zXZ\x00"]), "decompress it first, for example with xzcat") {}
    Compress("data of compress (.Z)", NO_LIST, Test::Magic(&[b"\x1f\x9d"]),
        "decompress it first, for example with uncompress -c FILE.Z") {}
    Mmtf("an MMTF file", NO_LIST, Test::Look(binary::is_mmtf), TO_STRUCTURE) {}
    Lammps("a data or dump file of LAMMPS", NO_LIST, Test::Look(structures::is_lammps),
        "convert it to XYZ first, for example with ovito or ase") {}
    Mol2("a MOL2 file", NO_LIST, Test::Look(structures::is_mol2), TO_STRUCTURE) {}
    Sdf("an SDF or MOL file", NO_LIST, Test::Look(structures::is_sdf), TO_STRUCTURE) {}
    Utf16("text in UTF-16", NO_LIST, Test::Magic(&[b"\xff\xfe", b"\xfe\xff"]),
        "convert it first, for example with iconv -f utf-16 -t utf-8") {}
    Pcd("a PCD file", NO_LIST, Test::Magic(&[b"# .PCD", b"VERSION .7", b"VERSION 0.7"]), BY_PDAL) {}
    E57("an E57 file", NO_LIST, Test::Magic(&[b"ASTM-E57"]), BY_PDAL) {}
    Bpf("a BPF file", NO_LIST, Test::Magic(&[b"BPF!"]), BY_PDAL) {}
    Rdbx("a RIEGL database (RDBX)", NO_LIST, Test::Magic(&[b"RIEGL LMS RDB"]), BY_PDAL) {}
    Compound("an OLE file, such as a scan of FARO (FLS)", NO_LIST,
        Test::Magic(&[b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"]),
        "export it as LAS, PLY or lines of x y z first, with the program that wrote it") {}
    Ptx("a PTX scan", NO_LIST, Test::Look(binary::is_ptx), BY_PDAL) {}
    Stl("an STL surface", NO_LIST, Test::Look(binary::is_stl), BY_MESHIO) {
        value: "stl", ending: "stl", is_binary: true,
        sink: Some(|to, header, how| Ok(Box::new(StlSink::new(to, header, how.temp_dir.as_deref())?)))
    }
    Gltf("a glTF file", NO_LIST, Test::Magic(&[b"glTF"]), BY_MESHIO) {
        value: "glb", ending: "glb", is_binary: true,
        sink: Some(|to, header, how| Ok(Box::new(GlbSink::new(to, header, how.temp_dir.as_deref())?)))
    }
    Gmsh("a Gmsh mesh", NO_LIST, Test::Magic(&[b"$MeshFormat"]), BY_MESHIO) {}
    Fbx("an FBX file", NO_LIST, Test::Magic(&[b"Kaydara FBX Binary"]),
        "export it as PLY or OBJ first, for example with Blender") {}
    Dwg("a DWG drawing", NO_LIST, Test::Magic(&[b"AC10"]), AS_LINES) {}
    DxfDrawing("a DXF drawing", NO_LIST, Test::Look(binary::is_dxf), AS_LINES) {}
    Shapefile("a Shapefile", NO_LIST, Test::Magic(&[b"\0\0\x27\x0a"]), OF_FEATURES) {}
    Sqlite("an SQLite database, such as a GeoPackage", NO_LIST, Test::Magic(&[b"SQLite format 3\0"]),
        OF_FEATURES) {}
    FlatGeobuf("a FlatGeobuf file", NO_LIST, Test::Magic(&[b"fgb\x03"]), OF_FEATURES) {}
    Json("JSON", NO_LIST, Test::Look(binary::is_json), OF_FEATURES) {}
    Parquet("a Parquet file", NO_LIST, Test::Magic(&[b"PAR1"]), AS_LINES) {}
    AsciiGrid("an ASCII grid of Esri", NO_LIST, Test::Look(binary::is_ascii_grid), OF_CELLS) {}
    SurferGrid("a grid of Surfer", NO_LIST, Test::Magic(&[b"DSAA", b"DSBB", b"DSRB"]), OF_CELLS) {}
    MetaImage("a MetaImage", NO_LIST, Test::Magic(&[b"ObjectType = Image"]), VALUES) {}
    Picture("a picture", NO_LIST, Test::Magic(&[b"\x89PNG", b"\xff\xd8\xff"]), "") {}
    Pdf("a PDF document", NO_LIST, Test::Magic(&[b"%PDF"]), "") {}
    Hdf5("HDF5, netCDF-4 or MINC data", NO_LIST, Test::Magic(&[b"\x89HDF"]),
        "write it as VTU, NRRD or raw numbers first, for example with ParaView or h5dump") {}
    Netcdf("netCDF data", NO_LIST, Test::Magic(&[b"CDF\x01", b"CDF\x02", b"CDF\x05"]), VALUES) {
        value: "ugrid", ending: "nc", is_binary: true,
        sink: Some(|to, header, how| Ok(Box::new(UgridSink::new(to, header, how.temp_dir.as_deref())?)))
    }
    Inrimage("an INRIMAGE, which holds voxels", NO_LIST, Test::Magic(&[b"#INRIMAGE"]),
        "list the wanted ones as lines of x y z") {}
    Tiff("a TIFF image", NO_LIST, Test::Magic(&[b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"]),
        OF_CELLS) {}
    Xml("XML or HTML", NO_LIST, Test::Magic(&[b"<?xml", b"<!DOCTYPE", b"<!doctype", b"<html", b"<HTML"]),
        "it may be the error page of a failed download") {}
    Binary("of no known format", NO_LIST, Test::Look(|head| head.contains(&0)), "") {}
}

/// The formats whose rows fulfil a condition, in the order of the table.
pub(crate) fn formats_with(is_wanted: impl Fn(&Row) -> bool) -> Vec<Format> {
    ROWS.iter().filter(|row| is_wanted(row)).map(|row| row.format).collect()
}

impl Format {
    pub(crate) fn row(self) -> &'static Row {
        &ROWS[self as usize]
    }

    /// All formats that are recognized by their content, in the order in which they are tried.
    pub fn all() -> impl Iterator<Item = Format> {
        formats_with(|row| !matches!(row.test, Test::Never)).into_iter()
    }

    /// Name of the format in messages, with an article.
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// Name of the format on the command line of `spconvert`; empty if it has none.
    pub fn value(self) -> &'static str {
        self.row().value
    }

    /// Whether the format is binary, so that a terminal cannot show it.
    pub fn is_binary(self) -> bool {
        self.row().is_binary
    }

    /// What opens an input as the events of a stream; `None` if its points are read as those of files.
    pub fn events(self) -> Option<OpenEvents> {
        self.row().events
    }
}

fn open_stream(input: AnyInput, name: &str, _: u8) -> Result<Events> {
    let input = BufReader::with_capacity(1 << 18, input);
    Ok(Box::new(Checked::new(StreamReader::new(input, name)?)))
}

fn open_twin(input: AnyInput, name: &str, _: u8) -> Result<Events> {
    Ok(Box::new(Checked::new(TwinSource::new(input, name)?)))
}

fn vertices_of_obj(file: &Opening, _: &mut Vec<String>) -> Result<Content> {
    stream::open(file, obj::open_vertices, true)
}

fn text_of_sites(origin: Origin, _: Option<&Path>, _: &[u8], _: &mut Vec<String>) -> Result<Supply> {
    volumes::text::open(origin.of_use(Use::Held)).map(Supply::Text)
}
