//! Inputs within gzip that expand a thousandfold.

use std::io::Write;

use flate2::Compression;
use flate2::write::GzEncoder;

use crate::INPUT_MAX;
use crate::cases::{Case, accepted, malformed};

/// Gzip data of `head`, as many copies of `unit` as fit, and `tail`; and how long they are.
fn bomb(head: &[u8], unit: &[u8], tail: &[u8]) -> (Vec<u8>, usize) {
    bomb_of(INPUT_MAX, [head, unit, tail])
}

/// As [`bomb`], in `most` bytes.
fn bomb_of(most: usize, [head, unit, tail]: [&[u8]; 3]) -> (Vec<u8>, usize) {
    let made = |copies: usize| -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(head).expect("memory takes it");
        (0..copies).try_for_each(|_| encoder.write_all(unit)).expect("memory takes it");
        encoder.write_all(tail).expect("memory takes it");
        encoder.finish().expect("memory takes it")
    };
    let mut copies = (most << 10) / unit.len();
    loop {
        let bytes = made(copies);
        if bytes.len() <= most {
            return (bytes, head.len() + copies * unit.len() + tail.len());
        }
        copies = copies * (most - 100) / bytes.len();
    }
}

/// A bomb that a program may accept in the memory of one that streams.
fn streamed_one(name: &'static str, line: &'static str, [head, unit, tail]: [&str; 3]) -> Case {
    accepted(name, line, bomb(head.as_bytes(), unit.as_bytes(), tail.as_bytes()).0)
}

/// What programs read without holding it.
pub fn streamed() -> Vec<Case> {
    // More sites than there are values.
    let head = "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 999 999 99 1\nencoding: gzip\n\n";
    let volume = bomb_of(INPUT_MAX - head.len(), [&[], &[0; 1000], &[]]).0;
    let volume = [head.as_bytes(), &volume].concat();
    let numpy = "{'descr': '<f8', 'fortran_order': True, 'shape': (9, 3), }";
    let numpy = [b"\x93NUMPY\x01\x00\x76\x00", format!("{numpy:<117}\n").as_bytes()].concat();
    vec![
        streamed_one("points", "spfinalize IN.txt -o OUT.spm", ["", "1 2 3\n", ""]),
        streamed_one("points in space", "spfinalize --octree IN.txt -o OUT.spm", ["", "1 2 3\n", ""]),
        streamed_one("comments", "spfinalize IN.txt -o OUT.spm", ["1 2 3\n", "#\n", ""]),
        malformed("a line", "spfinalize IN.txt -o OUT.spm", bomb(b"1", b"1", b"").0, "more than 65536 bytes"),
        malformed("an array", "spfinalize IN.npy -o OUT.spm", bomb(&numpy, &[0; 24], b"").0, "array"),
        streamed_one("vertices", "spconvert IN.obj -o OUT.spm", ["", "v 1 2 3\n", ""]),
        streamed_one(
            "faces",
            "spconvert IN.obj -o OUT.spm",
            ["v 0 0 0\nv 1 0 0\nv 0 1 0\n", "f 1 2 3\n", ""],
        ),
        malformed(
            "a polygon",
            "spconvert IN.obj -o OUT.spm",
            bomb(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf", b" 1 2 3", b"").0,
            "more than 65536 bytes",
        ),
        malformed(
            "a value of mmCIF",
            "tess3 IN.cif -o OUT.spm",
            bomb(b"data_a\n_a.b ", b"x", b"\n").0,
            "more than 16777216 bytes",
        ),
        malformed(
            "columns of mmCIF",
            "tess3 IN.cif -o OUT.spm",
            bomb(b"data_a\nloop_\n", b"_atom_site.id\n", b"").0,
            "a second time",
        ),
        malformed(
            "properties of GeoJSON",
            "spconstrain --lines IN.geojson MESH -o OUT.spm",
            bomb(
                b"{\"type\":\"Feature\",\"properties\":{",
                b"\"a\":[[[1]]],",
                b"\"b\":1},\"geometry\":null}",
            )
            .0,
            "found no lines",
        ),
        malformed("a volume", "dd4 --where value>1 IN.nrrd -o OUT.spm", volume, "truncated"),
    ]
}

/// A bomb whose atoms or vertices a program holds.
fn held_one(name: &'static str, line: &'static str, [head, unit, tail]: [&str; 3]) -> Case {
    let (bytes, held) = bomb(head.as_bytes(), unit.as_bytes(), tail.as_bytes());
    Case { held, ..accepted(name, line, bytes) }
}

/// What programs hold.
pub fn held() -> Vec<Case> {
    let atoms = "data_a\nloop_\n_atom_site.id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n";
    vec![
        held_one("points as atoms", "tess3 IN.txt -o OUT.spm", ["", "1 2 3\n", ""]),
        held_one("atoms", "tess3 IN.cif -o OUT.spm", [atoms, "1 1 2 3\n", ""]),
        held_one(
            "a line of GeoJSON",
            "spconstrain --lines IN.geojson MESH -o OUT.spm",
            ["{\"type\":\"LineString\",\"coordinates\":[", "[0,0],", "[1,1]]}"],
        ),
        held_one(
            "a line of text",
            "spconstrain --lines IN.txt MESH -o OUT.spm",
            ["line 1 2 3\n", "4 5 6\n", ""],
        ),
        held_one("a mask", "spdem --columns 9 --mask IN.wkt MESH -o OUT.tif", ["POLYGON((", "0 0,", "0 0))"]),
    ]
}
