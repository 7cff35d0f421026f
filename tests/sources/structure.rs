//! Structures and points in space: formats are detected by content, and coordinates are stored exactly as
//! written.

use std::io::{Cursor, Write};
use std::path::Path;

use spmesh_base::error::{ErrorKind, Result};
use spmesh_formats::drivers::Format;
use spmesh_formats::molecules::{
    Altlocs, Atom, Models, Selection, Structure, read_structure, read_structure_from,
};
use spmesh_stream::{Coordinates, Header, Kind, StreamWriter};

use super::{assert_fails, sample};
use crate::programs::Folder;

/// Reads a structure from memory; messages call it "input".
pub fn read(content: impl AsRef<[u8]>) -> Result<Structure> {
    read_structure_from(Cursor::new(content.as_ref().to_vec()), "input", None)
}

/// All atoms with their texts and stored coordinates: `model serial name element altloc chain residue
/// number+code occupancy x y z`, with "-" for an empty field, and "*" after the name in HETATM records.
pub fn atoms(structure: &Structure) -> Vec<String> {
    let all = Selection { models: Models::All, altlocs: Altlocs::All, ..Selection::default() };
    let selected = structure.select(&all).expect("all atoms can be selected");
    let or_dash = |text: &str| if text.is_empty() { "-".to_string() } else { text.to_string() };
    let line = |index: usize| {
        let atom = selected.atom(index).expect("atoms have names");
        let number = atom.residue_number().map_or(String::new(), |number| number.to_string());
        let [x, y, z] = atom.point;
        [
            atom.model.to_string(),
            atom.atom.serial.to_string(),
            or_dash(atom.name()) + if atom.atom.is_hetatm { "*" } else { "" },
            or_dash(atom.element()),
            or_dash(atom.altloc()),
            or_dash(atom.chain()),
            or_dash(atom.residue_name()),
            or_dash(&(number + atom.insertion_code())),
            format!("{} {x} {y} {z}", atom.atom.occupancy),
        ]
        .join(" ")
    };
    (0..selected.points().len()).map(line).collect()
}

/// Stored coordinates of the first model.
fn points(structure: &Structure) -> &[[f64; 3]] {
    &structure.models[0].points
}

pub fn gzip(content: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(content).expect("memory takes all");
    encoder.finish().expect("memory takes all")
}

/// Scale of integer coordinates; `None` if they are floating-point numbers.
fn scale(structure: &Structure) -> Option<f64> {
    match structure.coordinates {
        Coordinates::F64 => None,
        Coordinates::I32 { scale, offset } => {
            assert_eq!((scale, offset), ([scale[0]; 3], [0.0; 3]));
            Some(scale[0])
        }
    }
}

#[test]
fn pdb_and_mmcif_of_one_entry_are_the_same() {
    let (pdb, cif) = (sample("1aki.pdb"), sample("1aki.cif"));
    let (pdb, cif) = (read_structure(&pdb, None).unwrap(), read_structure(&cif, None).unwrap());
    assert_eq!((scale(&pdb), scale(&cif)), (Some(0.001), Some(0.001)));
    assert_eq!(points(&pdb), points(&cif));
    // The TER record of PDB takes a serial number.
    let without_serial = |structure: &Structure| -> Vec<String> {
        let rest = |atom: String| atom.splitn(3, ' ').nth(2).unwrap().to_string();
        atoms(structure).into_iter().map(rest).collect()
    };
    assert_eq!(without_serial(&pdb), without_serial(&cif));
    assert_eq!(atoms(&pdb)[0], "1 1 N N - A LYS 1 1 35365 22342 -11980");
    assert_eq!(atoms(&pdb)[150], "1 1003 O* O - A HOH 130 1 23434 40063 -6661");
    assert_eq!(atoms(&pdb).len(), 170);
    assert!(pdb.warnings.is_empty() && cif.warnings.is_empty());
}

#[test]
fn compressed_models_are_read_one_by_one() {
    let structure = read_structure(&sample("1l2y.pdb.gz"), None).unwrap();
    let sizes: Vec<_> = structure.models.iter().map(|model| (model.number, model.atoms.len())).collect();
    assert_eq!(sizes, [(1, 304), (2, 304)]);
    assert_eq!(structure.models[1].points[0], [-6919.0, 6901.0, 917.0]);
}

#[test]
fn an_atom_is_small() {
    assert!(size_of::<Atom>() <= 32);
}

#[test]
fn coordinates_are_multiples_of_a_quantum_where_one_serves_all() {
    type Case<'c> = (&'c [&'c str], Option<f64>, &'c [[f64; 3]]);
    let cases: [Case; 12] = [
        (&["1.5 -2 0.001"], Some(1e-3), &[[1500.0, -2000.0, 1.0]]),
        (&["+1. -.5 -0.000"], Some(1e-3), &[[1000.0, -500.0, 0.0]]),
        (&["1.50000000 -2.00000 3"], Some(1e-3), &[[1500.0, -2000.0, 3000.0]]),
        (&["1 2 3", "1.0001 2 3"], Some(1e-4), &[[10000.0, 20000.0, 30000.0], [10001.0, 20000.0, 30000.0]]),
        (&["1 2 3.14159", "1.1 2 3"], Some(1e-5), &[[1e5, 2e5, 314159.0], [1.1e5, 2e5, 3e5]]),
        (&["2147483.647 -2147483.647 0"], Some(1e-3), &[[2147483647.0, -2147483647.0, 0.0]]),
        (&["2147483.648 0.1 0"], None, &[[2147483.648, 0.1, 0.0]]),
        (&["2147483 0 0", "0.0001 0 0"], None, &[[2147483.0, 0.0, 0.0], [0.0001, 0.0, 0.0]]),
        (&["0.1 0.2 0.3", "1e-4 0 0"], None, &[[0.1, 0.2, 0.3], [1e-4, 0.0, 0.0]]),
        (&["0.0000000001 0 0"], None, &[[1e-10, 0.0, 0.0]]),
        (&["0.12345678901234567 0.7 0"], None, &[[0.123_456_789_012_345_67, 0.7, 0.0]]),
        (&["123456789012345678 0 0", "0.1 0 0"], None, &[[123456789012345678.0, 0.0, 0.0], [0.1, 0.0, 0.0]]),
    ];
    for (lines, expected_scale, expected) in cases {
        let atoms: String = lines.iter().map(|line| format!("C {line}\n")).collect();
        let structure = read(format!("{}\n\n{atoms}", lines.len())).unwrap();
        assert_eq!(scale(&structure), expected_scale, "{lines:?}");
        let bits = |points: &[[f64; 3]]| -> Vec<u64> {
            points.as_flattened().iter().map(|value| value.to_bits()).collect()
        };
        assert_eq!(bits(points(&structure)), bits(expected), "{lines:?}");
    }
}

#[test]
fn all_models_share_one_quantum() {
    let frames = read("1\n\nC 1 2 3\n1\n\nC 0.00001 0 0\n").unwrap();
    assert_eq!(scale(&frames), Some(1e-5));
    assert_eq!(frames.models[0].points, [[1e5, 2e5, 3e5]]);
    assert_eq!(frames.models[1].points, [[1.0, 0.0, 0.0]]);
}

#[test]
fn xyz_frames_are_models() {
    let text = "2\r\nwater\r\n O 0.0 0.0 0.1173\r\nH\t0 0.7572 -0.4692 0.1 more\r\n\r\n 1 \n\nXe 1 2 3";
    let structure = read(text).unwrap();
    assert_eq!(
        atoms(&structure),
        [
            "1 1 O O - - - - 1 0 0 1173",
            "1 2 H H - - - - 1 0 7572 -4692",
            "2 1 Xe Xe - - - - 1 10000 20000 30000"
        ]
    );
    assert_eq!(structure.warnings.len(), 1, "the last line has no end");
    let by_number = read("1\n\n6 1 2 3\n").unwrap();
    assert_eq!(atoms(&by_number), ["1 1 6 C - - - - 1 1000 2000 3000"]);

    let cases: [(&str, &[&str]); 6] = [
        ("2\n\nC 0 0 0\n", &["line 4", "truncated", "atom 2 of 2"]),
        ("1\n\nC 0 0 0\nC 1 1 1\n", &["line 4", "\"1\"", "end of the line"]),
        ("2\n\nC 0 0 0\nC 1 nan 1\n", &["line 4", "\"nan\"", "number for y"]),
        ("2\n\nC 0 0 0\nC 1 1\n", &["line 4", "missing"]),
        ("1\n\nC 0 0 0\n99999999999999999999\n", &["line 4", "an integer"]),
        ("1\n\nC 0 0 0\n18446744073709551615\n\n", &["line 6", "truncated"]),
    ];
    for (text, parts) in cases {
        assert_fails(read(text), ErrorKind::Malformed, &[&["input: "], parts].concat());
    }
}

#[test]
fn extended_xyz_states_its_columns() {
    let frame = |comment: &str, atom: &str| read(format!("1\n{comment}\n{atom}\n"));
    for (comment, atom) in [
        ("Properties=species:S:1:forces:R:3:pos:R:3", "C 9 9 9 1.5 2 3"),
        ("Properties=id:I:1:species:S:1:pos:R:3 energy=1", "7 C 1.5 2 3"),
        ("pbc=\"T T T\" properties='pos:R:3:Z:I:1'", "1.5 2 3 6"),
        ("no Properties: here", "C 1.5 2 3"),
    ] {
        let structure = frame(comment, atom).unwrap();
        let model = &structure.models[0];
        assert_eq!(
            (model.points[0], model.atoms[0].atomic_number),
            ([1500.0, 2000.0, 3000.0], 6),
            "{comment}"
        );
        assert!(structure.warnings.is_empty());
    }
    let periodic =
        frame("Lattice=\"9 0 0 0 9 0 0 0 9\" Properties=species:S:1:pos:R:3", "C 1.5 2 3").unwrap();
    assert!(periodic.models[0].periodic_box.is_some());
    let notices = |is_periodic| periodic.notices(&Selection::default(), is_periodic);
    assert!(notices(false)[0].contains("--periodic"));
    assert!(notices(true).is_empty());
    for list in [
        "species:S:1:pos:R",
        "species:S:1:pos:R:2",
        "pos:Q:3",
        "species:S:1",
        "pos:R:3:pos:R:3",
        "pos:R:0",
        "",
    ] {
        let words = ["input: line 2", "Properties"];
        assert_fails(frame(&format!("Properties={list}"), "C 1 2 3").map(drop), ErrorKind::Malformed, &words);
    }
    let short = frame("Properties=species:S:1:forces:R:3:pos:R:3", "C 1 2 3").map(drop);
    assert_fails(short, ErrorKind::Malformed, &["input: line 3"]);
}

/// Aligned files could be read as PDB, but for radii.
#[test]
fn pqr_states_radii() {
    let aligned = "REMARK   1 PQR file generated by PDB2PQR\n\
                   ATOM      1  N   ALA A   1       0.169   7.698  13.415 -0.4700 1.8500\n\
                   HETATM    2 ZN   ZN  A   2       1.320   8.028  14.229  2.0000 0.0000\nTER\nEND\n";
    let unaligned =
        "ATOM 1 N ALA 1 0.169 7.698 -113.415 -0.47 1.85\nHETATM 2 ZN ZN B22A 1.32 8.028 14.229 2 0\n";
    for (text, chains) in [(aligned, vec!["A"]), (unaligned, vec!["", "B"])] {
        let structure = read(text).unwrap();
        let atoms = &structure.models[0].atoms;
        let found: Vec<_> = atoms.iter().map(|atom| (atom.radius(), atom.atomic_number)).collect();
        assert_eq!(found, [(Some(1850), 7), (Some(0), 30)]);
        assert_eq!(structure.chains(), chains);
    }
    // Neither tabs nor the length of a line count.
    let spread = read(unaligned.replace(' ', "\t         ")).unwrap();
    assert_eq!(spread.models[0].atoms[0].radius(), Some(1850));
    let pdb = "ATOM      1  N   ALA A   1       0.169   7.698  13.415  1.00 20.50\n";
    assert_eq!(read(pdb).unwrap().models[0].atoms[0].radius(), None);
    for (wrong, words) in [
        ("ATOM 2 N ALA 1 0.169 7.698 13.415 -0.47\n", "line 3: found 8 fields"),
        ("ATOM 2 N ALA 1 0.169 7.698 x -0.47 1\n", "line 3: found \"x\", expected a number for z"),
        ("ATOM 2 N ALA 1 0.169 7.698 1 -0.47 -1\n", "expected a radius of 0 to 65 Å"),
    ] {
        assert_fails(read(unaligned.to_string() + wrong).map(drop), ErrorKind::Malformed, &[words]);
    }
}

#[test]
fn compression_is_told_by_the_content() {
    let folder = Folder::new();
    let whole = std::fs::read(sample("1aki.pdb")).unwrap();
    let expected = atoms(&read(&whole).unwrap());
    let path = folder.file("structure.pdb", gzip(&whole));
    assert_eq!(atoms(&read_structure(&path, None).unwrap()), expected);
    // Concatenated gzip members form one file.
    let halves = [gzip(&whole[..5000]), gzip(&[]), gzip(&whole[5000..])].concat();
    assert_eq!(atoms(&read(halves).unwrap()), expected);
    let text = gzip(b"1 2 3\n4 5 6\n");
    assert_eq!(points(&read(text).unwrap()), [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
}

#[test]
fn damaged_compression_names_the_byte() {
    let whole = gzip(&std::fs::read(sample("1aki.pdb")).unwrap());
    for len in (2..whole.len()).step_by(17).chain(whole.len() - 9..whole.len()) {
        let parts = ["input: ", "ends early", &format!("byte {len}")];
        assert_fails(read(&whole[..len]), ErrorKind::Malformed, &parts);
    }
    let with_more = [&whole[..], b"more than a header of gzip"].concat();
    assert_fails(read(with_more), ErrorKind::Malformed, &["input: ", "damaged", "byte"]);
    let mut flipped = whole.clone();
    let last = flipped.len() - 6;
    flipped[last] ^= 1;
    assert_fails(read(flipped), ErrorKind::Malformed, &["damaged"]);
}

#[test]
fn points_are_read_as_elsewhere() {
    let folder = Folder::new();
    let expected = [[1.5, -2.0, 3e-3], [4.0, 5.0, 6.0]];
    let texts = [
        "1.5 -2 3e-3\n4 5 6\n",
        "# cloud\nx,y,z,w\n1.5,-2,0.003,1\n4,5,6,7\n",
        "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty double z\n\
         end_header\n1.5 -2 0.003\n4 5 6\n",
        "# from a modeller\nv 1.5 -2 0.003\nv 4 5 6\n",
        "OFF\n2 0 0\n\n1.5 -2 0.003\n4 5 6 # second\n",
        "# faces are not looked at\nCOFF 2 1 0\n1.5 -2 0.003 255 0 0\n4 5 6 255 0 0\n3 0 1 1\n",
    ];
    for text in texts {
        for content in [text.as_bytes().to_vec(), gzip(text.as_bytes())] {
            let structure = read(&content).unwrap();
            assert_eq!((scale(&structure), points(&structure)), (None, &expected[..]), "{text:?}");
            assert!(structure.models[0].atoms.is_empty());
            let path = folder.file("points", &content);
            assert_eq!(points(&read_structure(&path, None).unwrap()), expected, "{text:?}");
        }
    }
}

/// A column of numbers before the coordinates is taken for x; only a warning can tell the user.
#[test]
fn points_that_are_numbered_are_warned_of() {
    let order = [3, 1, 8, 2, 6, 7, 5, 4];
    let lines = |first: u32| -> String {
        order.iter().map(|n| format!("{} {} {n}.5 0.25\n", n - 1 + first, n * n % 7)).collect()
    };
    for (text, last) in [(lines(1), "up to 8 once"), (lines(0), "up to 7 once")] {
        let warnings = read(&text).unwrap().warnings;
        assert!(warnings.len() == 1 && warnings[0].contains(last), "{warnings:?}");
        let twice = text.replace("\n4 ", "\n5 ");
        assert_ne!(twice, text);
        for text in [lines(2), twice, text.replacen(' ', ".5 ", 1)] {
            assert!(read(&text).unwrap().warnings.is_empty(), "{text}");
        }
    }
}

#[test]
fn meshes_need_not_say_when_vertices_are_final() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    assert!(read(text).unwrap().warnings.is_empty());
}

#[test]
fn streams_of_points_are_read_in_their_coordinates() {
    let coordinates = Coordinates::I32 { scale: [0.01; 3], offset: [5.0, 0.0, 0.0] };
    let header = Header::new(Kind::Points, coordinates, 3, false);
    let mut writer = StreamWriter::new(Vec::new(), header).unwrap();
    writer.points(&[[1.0, 2.0, 3.0], [-4.0, 5.0, 6.0]]).unwrap();
    let stream = writer.end(2, 0).unwrap();
    for content in [stream.clone(), gzip(&stream)] {
        let structure = read(content).unwrap();
        assert_eq!(points(&structure), [[1.0, 2.0, 3.0], [-4.0, 5.0, 6.0]]);
        assert_eq!(structure.coordinates, coordinates);
    }
    assert_fails(read(&stream[..stream.len() - 1]), ErrorKind::Malformed, &["input: ", "truncated"]);
}

#[test]
fn what_is_not_read_is_named() {
    let cases: [(&[u8], &[&str]); 15] = [
        (b"", &["empty"]),
        (b"\n\n", &["empty"]),
        (b"\x28\xb5\x2f\xfd....", &["zstd data is damaged", "byte"]),
        (b"BZh91AY", &["bzip2"]),
        (b"HEADER    NOTHING\nEND\n", &["no atom"]),
        (b"data_empty\n_cell.length_a 1\n", &["no atom"]),
        (b"OFF\n3 0 0\n0 0 0\n1 1 1\n", &["line 5", "vertex 3 of 3"]),
        (b"OFF BINARY\n", &["binary OFF"]),
        (b"OFF\n0 0 0\n", &["no point"]),
        (b"# nothing\n", &["no point"]),
        (b"ATOM\0\0\0", &["zero byte"]),
        (b"# vtk DataFile Version 4.2\nvtk output\nBINARY\n\0", &["line 4", "expected POINTS"]),
        (b"# vtk DataFile Version 4.1\nvtk output\nASCII\n", &["line 4", "truncated"]),
        (b"MeshVersionFormatted 1\nDimension 3\nVertices\n1\n0 0 0 0\n", &["Medit", "convert it first"]),
        (b"#INRIMAGE-4#{\nXDIM=2\n##}\n\0", &["INRIMAGE", "x y z"]),
    ];
    for (content, parts) in cases {
        assert_fails(read(content), ErrorKind::Malformed, &[&["input: "], parts].concat());
    }
    assert_fails(read("1 2\n3 4\n"), ErrorKind::Usage, &["input: ", "no third coordinate"]);
    assert_fails(read_structure(Path::new("/none"), None), ErrorKind::Io, &["/none: ", "opening"]);
    assert_fails(read_structure(Path::new("/"), None), ErrorKind::Usage, &["/: ", "is a folder"]);
}

#[test]
fn the_format_can_be_given() {
    let as_points = read_structure_from(Cursor::new(b"1 2 3\n"), "input", Some(Format::Text)).unwrap();
    assert_eq!(points(&as_points), [[1.0, 2.0, 3.0]]);
    let as_pdb = read_structure_from(Cursor::new(b"1 2 3\n"), "input", Some(Format::Pdb));
    assert_fails(as_pdb, ErrorKind::Malformed, &["no atom"]);
    let as_off = |text: &'static str| read_structure_from(Cursor::new(text), "input", Some(Format::Off));
    assert_eq!(points(&as_off("OFF 1 0 0\n1 2 3\n").unwrap()), [[1.0, 2.0, 3.0]]);
    assert_fails(as_off("1 2 3\n"), ErrorKind::Malformed, &["line 1", "OFF"]);
    let as_cif = read_structure_from(Cursor::new(b"1 2 3\n"), "input", Some(Format::Mmcif));
    assert_fails(as_cif, ErrorKind::Malformed, &["line 1, column 1", "\"1\""]);
}
