//! Initial inputs: files of the tests, test vectors of the formats, short texts, and random bytes.

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

pub use crate::made::Made;

/// Most bytes taken from a sample: more would slow the fuzzer down and add little variety.
const SAMPLE_MAX: usize = 1 << 16;

/// Where samples come from.
#[derive(Debug, Clone, Copy)]
pub enum Samples {
    /// The streams of `formats/vectors`, valid and invalid.
    Vectors,
    /// Text twins of streams.
    Twins,
    /// Files of `tests/data` with these endings.
    Files(&'static [&'static str]),
    /// These texts.
    Texts(&'static [&'static str]),
    /// What the project makes of other files.
    Made(Made),
    /// Random bytes, which kernels read as points.
    Points,
}

/// A database of lines.
pub const LINES_GPKG: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/lines.gpkg");

/// A file of points that gets an index.
pub const INDEXED_LAS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/point10.las");

/// Lines of points.
pub const TEXTS: &[&str] = &[
    "0 0 1\n1 0 2\n0 1 3\n1 1 4\n0.5,0.25,1e-3\n",
    "x;y;z\n1;2;3\n4;5;6\n",
    "# comment\n 1\t2\n3\t4\n\n",
    "\u{feff}X,Y\n-1.5e300,2\n1e-300,NaN\n",
];

/// Streaming points by Isenburg, and raw heads of their binary form.
pub const SPA: &[&str] = &[
    "# npoints 3\n# bb_min_d 0 0 0\n# bb_max_d 1 1 1\nv 0 0 0\nv 1 0 0\nx cell 0\nv 1 1 1\nx cell 1\n",
    "# datatype int\n# finalizemethod quadtree 2\nv 1 2 3\nx cell 5\n",
    "\u{7}\u{1}\u{1}\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0",
];

/// PLY with faces, without, and binary.
pub const PLY: &[&str] = &[
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
     element face 2\nproperty list uchar int vertex_indices\nend_header\n\
     0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n4 0 1 2 3\n",
    "ply\nformat ascii 1.0\ncomment a\nelement vertex 2\nproperty double x\nproperty double y\nend_header\n1 2\n3 4\n",
    "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty short x\nproperty short y\nproperty short z\n\
     element face 1\nproperty list uchar uchar vertex_index\nend_header\nabcdefghijkl\u{3}\0\u{1}\0",
    "ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
     property list uchar float w\nend_header\nabcdefghijkl\u{2}12345678",
];

/// OBJ of all kinds of indices.
pub const OBJ: &[&str] = &[
    "# OBJ\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 0 0 1\nf 1 2 3\nf -1//1 -2 -3/1/1 1\no a\ns off\n",
    "mtllib a\nv 1 2 3 1.0\nv 4 5 6\nv 7 8 10\nf 1/1/1 2/2/2 3/3/3 \\\n 1\n",
];

/// Streaming meshes by Isenburg.
pub const SMA: &[&str] = &[
    "# nverts 4\n# nfaces 2\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nv 1 1 0\nf 2 4 -2\nx 1\nx -1\n",
    "v 0 0 0\nf 1 2 3\nv 1 0 0\nv 0 1 0\n",
];

/// XYZ, OFF, and points.
pub const MOLECULES: &[&str] = &[
    "3\nwater\nO 0 0 0\nH 0.757 0.586 0\nH -0.757 0.586 0\n",
    "OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n",
    "data_a\nloop_\n_atom_site.id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n1 1.0 2 3\n2 'a b' ? .\n",
    "1 2 3\n4 5 6\n",
    "data_a\n_entity.id 1\n_entity.type polymer\n_struct_asym.id A\n_struct_asym.entity_id 1\nloop_\n\
     _pdbx_struct_assembly_gen.assembly_id\n_pdbx_struct_assembly_gen.oper_expression\n\
     _pdbx_struct_assembly_gen.asym_id_list\n1 (1-2)(P) A,B\n1 1,2 B\nloop_\n_pdbx_struct_oper_list.id\n\
     _pdbx_struct_oper_list.matrix[1][1]\n_pdbx_struct_oper_list.matrix[1][2]\n\
     _pdbx_struct_oper_list.matrix[1][3]\n_pdbx_struct_oper_list.vector[1]\n\
     _pdbx_struct_oper_list.matrix[2][1]\n_pdbx_struct_oper_list.matrix[2][2]\n\
     _pdbx_struct_oper_list.matrix[2][3]\n_pdbx_struct_oper_list.vector[2]\n\
     _pdbx_struct_oper_list.matrix[3][1]\n_pdbx_struct_oper_list.matrix[3][2]\n\
     _pdbx_struct_oper_list.matrix[3][3]\n_pdbx_struct_oper_list.vector[3]\n\
     1 1 0 0 0 0 1 0 0 0 0 1 0\n2 0 1 0 9 -1 0 0 8 0 0 1 7\nP 1 0 0 1e9 0 1 0 0 0 0 1 0\nloop_\n\
     _atom_site.id\n_atom_site.label_asym_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n\
     _atom_site.Cartn_z\n1 A 1.0 2 3\n2 B 4 5 6.125\n",
    "SEQRES   1 A    2  ALA MSE\nMODRES 1ABC MSE A   2  MET  SELENOMETHIONINE\n\
     REMARK 350 BIOMOLECULE: 1\nREMARK 350 APPLY THE FOLLOWING TO CHAINS: A,\n\
     REMARK 350                    AND CHAINS: B\n\
     REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000\n\
     REMARK 350   BIOMT2   1  0.000000  1.000000  0.000000        0.00000\n\
     REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        5.00000\n\
     ATOM      1  N   ALA A   1       1.000   2.000   3.000  1.00  0.00           N\n\
     HETATM    2  N   MSE A   2       4.000   5.000   6.000  1.00  0.00           N\nTER\n",
];

/// Breaklines, corners, values.
pub const POLYLINES: &[&str] = &[
    "corner 1 2\ncrease 0 0 1 1 2 0\nsmooth-crease 5 5 6 6\nlinear 0 1 1 0\n",
    r#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"kind":"crease"},
    "geometry":{"type":"LineString","coordinates":[[0,0],[1,1,5]]}},{"type":"Feature","geometry":null}]}"#,
    r#"{"type":"GeometryCollection","geometries":[{"type":"MultiLineString","coordinates":[[[0,0],[1,1]],[[2,2],[3,3]]]},
    {"type":"Polygon","coordinates":[[[0,0],[1,0],[0,1],[0,0]]]},{"type":"MultiPoint","coordinates":[[1,2]]}]}"#,
    "1\n2.5\n-3e4\n",
    "1 2\n3;4\n",
];

/// Polygons, as text too.
pub const POLYGONS: &[&str] = &[
    "POLYGON ((0 0, 4 0, 4 4, 0 4, 0 0), (1 1, 2 1, 2 2, 1 2, 1 1))",
    "SRID=25832;MULTIPOLYGON Z (((0 0 1, 4 0 1, 4 4 1, 0 0 1)), ((5 5 1, 6 5 2, 6 6 1, 5 5 1)))",
    r#"{"type":"Polygon","coordinates":[[[1,1,5],[8,1,5],[8,8,5],[1,8,5],[1,1,5]]]}"#,
    "line 1 1 10 8 2 11\nsoft 2 2 3 7\n7 7 nan\n",
];

/// Coordinate reference systems.
pub const SYSTEMS: &[&str] = &[
    r#"COMPD_CS["a",PROJCS["UTM",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],
    PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],
    PARAMETER["central_meridian",-123],PARAMETER["scale_factor",0.9996],PARAMETER["false_easting",500000],
    UNIT["metre",1],AUTHORITY["EPSG","26910"]],VERT_CS["h",VERT_DATUM["d",2005],UNIT["foot",0.3048]]]"#,
    r#"GEOGCRS["a",DATUM["b",ELLIPSOID["c",6378137,298.25]],CS[ellipsoidal,2],AXIS["lat",north],
    AXIS["lon",east],ANGLEUNIT["degree",0.017],ID["EPSG",4326]]"#,
];

/// Radii of atoms.
pub const RADII: &[&str] = &["table bondi\nC 1.7\nALA CA 1.88\n* OXT 1.4\n# all\n", "table charmm\nN 1.55\n"];

/// Values of flags.
pub const FLAGS: &[&str] = &[
    "1",
    "x",
    "comma",
    "f64le",
    "4x3x2x1:f32be",
    "4x3x2x1",
    "0.5:lowest",
    "1.4",
    "0.001",
    "3,7",
    "-inf,2",
    "gcv",
    "cv:5",
    "auto",
    "space-time",
];

/// Features, grids, values, sites, and lists of files.
pub const PARTS: &[&str] = &[
    "corner 0 1\ncrease 2 3 4\nsmooth-crease 5 6\nlinear 7 8\n",
    "0 0 1 0 0 1 3 3\n",
    "1\n2\n3\n4\n5\n6\n7\n8\n9\n10\n",
    "0.5 0.5 0.5 0.5\n1 0 1 0\n",
    "# files\npoints.txt\n",
];

/// Conditions on points.
pub const CONDITIONS: &[&str] =
    &["value > 100", "x >= 3 and (t < 2 or not y == 1)", "value != nan && z <= -1.5e3 || !(x > 1)"];

impl Samples {
    /// The samples, in an order that depends on nothing else.
    ///
    /// # Panics
    /// If the files of the project cannot be read.
    #[must_use]
    pub fn load(self) -> Vec<Vec<u8>> {
        let mut samples = match self {
            Samples::Vectors => {
                let folders = ["formats/vectors/pass", "formats/vectors/fail"];
                let files = folders.into_iter().flat_map(|folder| files(folder, &["hex"]));
                files.map(|path| of_hex(&fs::read_to_string(path).expect("a vector"))).collect()
            }
            Samples::Twins => read(files("formats/vectors/pass", &["txt"])),
            Samples::Files(endings) => read(files("tests/data", endings)),
            Samples::Texts(texts) => texts.iter().map(|text| text.as_bytes().to_vec()).collect(),
            Samples::Made(made) => made.load(),
            Samples::Points => return Vec::new(),
        };
        assert!(!samples.is_empty(), "no samples of {self:?}");
        samples.iter_mut().for_each(|sample| sample.truncate(SAMPLE_MAX));
        samples
    }
}

/// A sample of the tests.
pub fn data(name: &str) -> Vec<u8> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data");
    fs::read(Path::new(folder).join(name)).expect("a sample")
}

/// The geometries of a database: from the mark of each one to the next, or a few hundred bytes.
pub fn blobs(database: &[u8]) -> Vec<Range<usize>> {
    let starts: Vec<usize> = (0..database.len()).filter(|&at| database[at..].starts_with(b"GP\0")).collect();
    let ends = starts.iter().skip(1).copied().chain([database.len()]);
    starts.iter().zip(ends).map(|(&start, end)| start..end.min(start + 300)).collect()
}

fn read(paths: Vec<PathBuf>) -> Vec<Vec<u8>> {
    paths.into_iter().map(|path| fs::read(path).expect("a sample")).collect()
}

/// Files of a folder of the project with these endings, by name.
fn files(folder: &str, endings: &[&str]) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..").join(folder);
    let entries = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let is_wanted =
        |path: &PathBuf| endings.iter().any(|ending| path.extension().is_some_and(|e| e == *ending));
    let mut paths: Vec<PathBuf> =
        entries.map(|entry| entry.expect("an entry").path()).filter(is_wanted).collect();
    paths.sort_unstable();
    paths
}

/// The bytes of a vector: hexadecimal, with comments.
fn of_hex(text: &str) -> Vec<u8> {
    let data = text.lines().filter_map(|line| line.split('#').next());
    data.flat_map(str::split_whitespace)
        .map(|byte| u8::from_str_radix(byte, 16).expect("two digits"))
        .collect()
}
