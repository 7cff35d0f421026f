//! Inputs within gzip that expand a thousandfold.

use std::io::Write;

use flate2::write::GzEncoder;
use flate2::{Compression, GzBuilder};
use spmesh_base::limits::EXPANSION_MAX;

use crate::INPUT_MAX;
use crate::cases::{Case, accepted, malformed};

/// Gzip data of `head`, as many copies of `unit` as fit, and `tail`.
fn bomb(head: &[u8], unit: &[u8], tail: &[u8]) -> Vec<u8> {
    bomb_of(INPUT_MAX, [head, unit, tail])
}

/// As [`bomb`], in `most` bytes.
fn bomb_of(most: usize, [head, unit, tail]: [&[u8]; 3]) -> Vec<u8> {
    let made = |copies: usize| -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(head).expect("memory takes it");
        // Many at a time: a copy may be of one byte.
        let many = unit.repeat(copies.min(10_000));
        (0..copies / 10_000).try_for_each(|_| encoder.write_all(&many)).expect("memory takes it");
        encoder.write_all(&many[..copies % 10_000 * unit.len()]).expect("memory takes it");
        encoder.write_all(tail).expect("memory takes it");
        encoder.finish().expect("memory takes it")
    };
    // As many as two small ones let expect.
    let few = (most << 6) / unit.len();
    let [one, two] = [1, 2].map(|times| made(times * few).len());
    let mut copies = few + few * (most - 100 - one) / (two - one);
    loop {
        let bytes = made(copies);
        if bytes.len() <= most {
            return bytes;
        }
        copies = copies * (most - 100) / bytes.len();
    }
}

/// A bomb that a program may accept in the memory of one that streams.
fn streamed_one(name: &'static str, line: &'static str, [head, unit, tail]: [&str; 3]) -> Case {
    accepted(name, line, bomb(head.as_bytes(), unit.as_bytes(), tail.as_bytes()))
}

/// What programs read without holding it.
pub fn streamed() -> Vec<Case> {
    // More sites than there are values.
    let head = "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 999 999 99 1\nencoding: gzip\n\n";
    let volume = bomb_of(INPUT_MAX - head.len(), [&[], &[0; 1000], &[]]);
    let volume = [head.as_bytes(), &volume].concat();
    let numpy = "{'descr': '<f8', 'fortran_order': True, 'shape': (9, 3), }";
    let numpy = [b"\x93NUMPY\x01\x00\x76\x00", format!("{numpy:<117}\n").as_bytes()].concat();
    vec![
        streamed_one("points", "spfinalize IN.txt -o OUT.spm", ["", "1 2 3\n", ""]),
        streamed_one("points in space", "spfinalize --octree IN.txt -o OUT.spm", ["", "1 2 3\n", ""]),
        streamed_one("comments", "spfinalize IN.txt -o OUT.spm", ["1 2 3\n", "#\n", ""]),
        malformed("a line", "spfinalize IN.txt -o OUT.spm", bomb(b"1", b"1", b""), "more than 65536 bytes"),
        malformed("an array", "spfinalize IN.npy -o OUT.spm", bomb(&numpy, &[0; 24], b""), "array"),
        streamed_one("vertices", "spconvert IN.obj -o OUT.spm", ["", "v 1 2 3\n", ""]),
        streamed_one(
            "faces",
            "spconvert IN.obj -o OUT.spm",
            ["v 0 0 0\nv 1 0 0\nv 0 1 0\n", "f 1 2 3\n", ""],
        ),
        malformed(
            "a polygon",
            "spconvert IN.obj -o OUT.spm",
            bomb(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf", b" 1 2 3", b""),
            "more than 65536 bytes",
        ),
        malformed(
            "a value of mmCIF",
            "tess3 IN.cif -o OUT.spm",
            bomb(b"data_a\n_a.b ", b"x", b"\n"),
            "at most 100-fold",
        ),
        malformed(
            "columns of mmCIF",
            "tess3 IN.cif -o OUT.spm",
            bomb(b"data_a\nloop_\n", b"_atom_site.id\n", b""),
            "a second time",
        ),
        malformed(
            "properties of GeoJSON",
            GEOJSON,
            bomb(
                b"{\"type\":\"Feature\",\"properties\":{",
                b"\"a\":[[[1]]],",
                b"\"b\":1},\"geometry\":null}",
            ),
            "at most 100-fold",
        ),
        malformed("a volume", "dd4 --where value>1 IN.nrrd -o OUT.spm", volume, "truncated"),
    ]
}

/// The command that reads records which it holds, what the input is made of, and the exit code for records
/// that repeat.
type Held = (&'static str, &'static str, [&'static str; 3], i32);

const ATOMS: &str =
    "data_a\nloop_\n_atom_site.id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n";
const GEOJSON: &str = "spconstrain --lines IN.geojson MESH -o OUT.spm";
const TEXT: &str = "spconstrain --lines IN.txt MESH -o OUT.spm";
const MASK: &str = "spdem --columns 9 --mask IN.wkt MESH -o OUT.tif";
const FIT: &str = "splinefit fit --features IN.txt DATA/hextest.las -o OUT.spm";

const HELD: [Held; 17] = [
    ("points as atoms", "tess3 IN.txt -o OUT.spm", ["", "1 2 3\n", ""], 0),
    ("vertices as atoms", "tess3 IN.obj -o OUT.spm", ["", "v 1 2 3\n", ""], 0),
    ("atoms", "tess3 IN.cif -o OUT.spm", [ATOMS, "1 1 2 3\n", ""], 0),
    ("a line of GeoJSON", GEOJSON, ["{\"type\":\"LineString\",\"coordinates\":[", "[0,0],", "[1,1]]}"], 0),
    ("points of GeoJSON", GEOJSON, ["{\"type\":\"MultiPoint\",\"coordinates\":[", "[0,0],", "[1,1]]}"], 0),
    ("a line of text", TEXT, ["line 1 2 3\n", "4 5 6\n", ""], 0),
    ("a line without z", TEXT, ["soft 1 2\n", "4 5\n", ""], 0),
    ("lines of text", TEXT, ["", "soft 0 0 1 1\n", ""], 0),
    ("areas", "spfinalize --clip IN.wkt DATA/hextest.las -o OUT.spm", ["", SQUARE, ""], 0),
    ("a mask", MASK, ["POLYGON((", "0 0,", "0 0))"], 0),
    ("polygons of a mask", MASK, ["", SQUARE, ""], 0),
    (
        "a mask of GeoJSON",
        "spdem --columns 9 --mask IN.geojson MESH -o OUT.tif",
        ["{\"type\":\"Polygon\",\"coordinates\":[[", "[0,0],", "[0,0]]]}"],
        0,
    ),
    (
        "points of a spline",
        "splinefit fit IN.txt -o OUT.spm",
        ["0 0 1\n5 5 2\n0 5 6\n4 1 2\n", "1 2 3\n", ""],
        0,
    ),
    ("features", FIT, ["", "corner 1 1\n", ""], 2),
    (
        "points of space and time",
        "dd4 IN.txt -o OUT.spm",
        ["0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "1 2 3 4\n", ""],
        0,
    ),
    ("points of an audit", "spinfo --audit --points IN.txt MESH", ["", "1 2 3\n", ""], 4),
    ("files of a list", "tess3 --lof IN.txt --out-dir OUT.d", ["", "a\n", ""], 2),
];

const SQUARE: &str = "POLYGON((0 0,9 0,9 9,0 0))\n";

/// Gzip data that expands as much as data of records may. A name in its header makes it as long as that
/// takes.
fn plausible([head, unit, tail]: [&str; 3]) -> Vec<u8> {
    let packed = |name: Vec<u8>, copies: usize| {
        let mut encoder = GzBuilder::new().filename(name).write(Vec::new(), Compression::best());
        encoder.write_all(head.as_bytes()).expect("memory takes it");
        encoder.write_all(unit.repeat(copies).as_bytes()).expect("memory takes it");
        encoder.write_all(tail.as_bytes()).expect("memory takes it");
        encoder.finish().expect("memory takes it")
    };
    let copies = |named: usize| (named * EXPANSION_MAX as usize - head.len() - tail.len()) / unit.len();
    let named = INPUT_MAX - packed(vec![b'x'], copies(INPUT_MAX)).len();
    packed(vec![b'x'; named], copies(named))
}

/// What programs hold: records that are too many for the data, and as many as may be.
pub fn held() -> Vec<Case> {
    let both = |&(name, line, parts, code): &Held| {
        let [head, unit, tail] = parts.map(str::as_bytes);
        let refused = malformed(name, line, bomb(head, unit, tail), "at most 100-fold");
        [refused, accepted(name, line, plausible(parts)).with_code(code)]
    };
    HELD.iter().flat_map(both).chain(knots()).collect()
}

/// Knots: a copy of one counts as another knot, and takes 270 bytes. This is all that exceeds the usual
/// memory.
fn knots() -> [Case; 2] {
    let (name, line) = ("knots", "configgen --degree 1 IN.txt -o OUT.spm");
    let [head, unit] = ["0 0\n5 5\n0 5\n4 1\n", "1 2\n"];
    let refused = malformed(name, line, bomb(head.as_bytes(), unit.as_bytes(), b""), "at most 100-fold");
    [refused, Case { memory_max: 112.0, ..accepted(name, line, plausible([head, unit, ""])) }]
}

/// Lines that share what is long: the properties of their feature.
pub fn shared() -> Vec<Case> {
    let feature = format!(
        "{{\"type\":\"Feature\",\"properties\":{{\"river\":\"{}\"}},\
         \"geometry\":{{\"type\":\"MultiPoint\",\"coordinates\":[",
        "a".repeat(500_000)
    );
    vec![accepted("properties of lines", GEOJSON, plausible([&feature, "[0,0],", "[1,1]]}}"]))]
}
