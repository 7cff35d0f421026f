//! Headers that state sizes of which nothing is there.

use std::fs;

use crate::cases::{Case, accepted, malformed};

const POINTS: &str = "spfinalize IN.bin -o OUT.spm";

/// A sample with words written over it.
fn sample(name: &str, words: &[(usize, &[u8])]) -> Vec<u8> {
    let path = format!("{}/tests/data/{name}", env!("CARGO_MANIFEST_DIR"));
    let mut bytes = fs::read(path).expect("a sample");
    for (at, word) in words {
        bytes[*at..at + word.len()].copy_from_slice(word);
    }
    bytes
}

fn numpy(shape: &str) -> Vec<u8> {
    let text = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({shape}), }}");
    [b"\x93NUMPY\x01\x00\x76\x00", format!("{text:<117}\n").as_bytes()].concat()
}

/// The place of the first of some bytes.
fn place(bytes: &[u8], of: &[u8]) -> usize {
    bytes.windows(of.len()).position(|window| window == of).expect("they are there")
}

/// Points.
pub fn points() -> Vec<Case> {
    let most = &[0xff; 4][..];
    let laz = sample("autzen.laz", &[]);
    let word = |at: usize| u32::from_le_bytes(laz[at..at + 4].try_into().expect("four bytes")) as usize;
    let table = word(word(96));
    let laszip = place(&laz, b"laszip encoded") + 52;
    let changed = |words: &[(usize, &[u8])]| sample("autzen.laz", words);
    let vtk = b"# vtk DataFile Version 3.0\na\nBINARY\nDATASET POLYDATA\nPOINTS 2000000000 double\n";
    vec![
        malformed("points of LAS", POINTS, sample("hextest.las", &[(107, most)]), "truncated"),
        accepted("records of LAS", POINTS, sample("hextest.las", &[(100, most)])),
        malformed(
            "bytes of a point of LAS",
            POINTS,
            sample("hextest.las", &[(105, &[0xff; 2])]),
            "truncated",
        ),
        malformed("chunks of LAZ", POINTS, changed(&[(table + 4, &[0xff, 0xff, 0xff, 0x7f])]), "chunk table"),
        malformed("points of LAZ", POINTS, changed(&[(107, &[0xff, 0xff, 0xff, 0x7f])]), "chunk table"),
        malformed(
            "points of a chunk of LAZ",
            POINTS,
            changed(&[(107, &[0xff, 0xff, 0xff, 0x7f]), (laszip + 12, &[0xfe, 0xff, 0xff, 0xff])]),
            "end too early",
        ),
        malformed(
            "points in a chunk of LAZ",
            POINTS,
            changed(&[(laszip + 12, &[1, 0, 0, 0])]),
            "chunk table",
        ),
        malformed("items of LAZ", POINTS, changed(&[(laszip + 32, &[0xff, 0xff])]), "laszip record"),
        malformed("rows of an array", POINTS, numpy("60000000000, 3"), "truncated"),
        malformed("columns of an array", POINTS, numpy("1, 4000000000"), "expected (n, 2)"),
        malformed("points of VTK", POINTS, &vtk[..], "truncated"),
        malformed("points of SPA", POINTS, "# npoints 999999999\n".repeat(800) + "v 0 0 0\n", "999999999"),
        malformed(
            "atoms of XYZ",
            "tess3 --from xyz IN.xyz -o OUT.spm",
            "999999999\nc\nC 0 0 0\n",
            "truncated",
        ),
        malformed(
            "vertices of OFF",
            "tess3 --from off IN.off -o OUT.spm",
            "OFF\n999999999 9 9\n0 0 0\n",
            "truncated",
        ),
    ]
}

/// Meshes, lines and polygons.
pub fn meshes() -> Vec<Case> {
    const LINES: &str = "spconstrain --lines IN.shp MESH -o OUT.spm";
    const PLY: &str = "spconvert IN.ply -o OUT.spm";
    let head = "ply\nformat binary_little_endian 1.0\n";
    let vertex = "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
    let list = format!("{head}{vertex}element face 1\nproperty list uint int vertex_indices\nend_header\n");
    let list = [list.as_bytes(), &[0; 12], &[0xff, 0xff, 0xff, 0x7f]].concat();
    let gpkg = sample("water.gpkg", &[]);
    // Behind the mark of a geometry come a version, flags, a system and, by the flags, a box; then a byte and
    // a type.
    let blob = place(&gpkg, b"GP\0\x01");
    let envelope = [0, 32, 48, 48, 64][usize::from(gpkg[blob + 3] >> 1 & 7)];
    vec![
        malformed(
            "vertices of SMA",
            "spconvert IN.sma -o OUT.spm",
            "# nverts 999999999\nv 0 0 0\n",
            "999999999",
        ),
        malformed(
            "elements of PLY",
            PLY,
            format!("{head}{}end_header\n", "element a 999999999999\n".repeat(600)),
            "vertex",
        ),
        malformed("a list of PLY", PLY, list, "2147483647"),
        malformed(
            "elements without bytes",
            PLY,
            [format!("{head}element a 999999999999\n{vertex}end_header\n").as_bytes(), &[0; 12]].concat(),
            "rows of no properties",
        ),
        malformed(
            "bytes of a Shapefile",
            LINES,
            sample("lines.shp", &[(24, &[0x7f, 0xff, 0xff, 0xff])]),
            "cut off",
        ),
        malformed(
            "bytes of a shape",
            LINES,
            sample("lines.shp", &[(104, &[0x7f, 0xff, 0xff, 0xff])]),
            "cut off",
        ),
        malformed(
            "parts of a shape",
            LINES,
            sample("lines.shp", &[(144, &[0xff, 0xff, 0xff, 0x7f])]),
            "expected",
        ),
        malformed(
            "rings of a GeoPackage",
            "spconstrain --lines IN.gpkg MESH -o OUT.spm",
            sample("water.gpkg", &[(blob + 8 + envelope + 5, &[0xff, 0xff, 0xff, 0x7f])]),
            "items",
        ),
    ]
}

/// Volumes.
pub fn volumes() -> Vec<Case> {
    const DD4: &str = "dd4 IN.nrrd -o OUT.spm";
    let nrrd =
        |sizes: &str| format!("NRRD0004\ntype: uchar\ndimension: 4\nsizes: {sizes}\nencoding: raw\n\n");
    let nifti = [4i16, 32767, 32767, 32767, 100, 1, 1, 1].map(i16::to_le_bytes).concat();
    let files = "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 9 9 9 65535\nencoding: raw\ndata file: a%d.raw 1 65535 1 3\n\n";
    vec![
        malformed("sites of NRRD", DD4, nrrd("60000 60000 60000 10"), "more than 1099511627776"),
        malformed(
            "values of NRRD",
            "dd4 --where value>1 IN.nrrd -o OUT.spm",
            nrrd("1024 1024 64 1"),
            "truncated",
        ),
        malformed("files of NRRD", "dd4 IN.nhdr -o OUT.spm", files, "opening").with_code(1),
        malformed(
            "sites of NIfTI",
            DD4,
            sample("oblique_qform.nii", &[(40, &nifti)]),
            "more than 1099511627776",
        )
        .with_code(2),
    ]
}
