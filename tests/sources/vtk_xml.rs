//! Points of the XML formats of VTK.

use spmesh_base::error::ErrorKind;
use spmesh_formats::source::{Input, SourceOptions};
use spmesh_stream::model::bounds::{Bounds, Point};

use super::vtk_file::{Form, Packing, VtkXml};
use super::{assert_fails, bits, damage, flat, points, points_of, sample};
use crate::programs::{Folder, outcome, run};

const FORMS: [Form; 4] = [Form::Ascii, Form::Binary, Form::AppendedRaw, Form::AppendedBase64];
const PACKINGS: [Packing; 3] = [Packing::Plain, Packing::Zlib, Packing::Lz4];

/// Points whose coordinates fit a float, including the least and the greatest ones.
fn cloud(count: u32) -> Vec<Point> {
    let odd = [-0.0, f64::from(f32::MAX), f64::from(f32::from_bits(1)), -1.5];
    let value = |i: u32| match i {
        0..4 => odd[i as usize],
        _ => f64::from(i.wrapping_mul(2_654_435_761) as f32) / 1024.0 - 1e6,
    };
    (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2].map(value).map(|x| f64::from(x as f32))).collect()
}

/// A file for each way to write the arrays.
fn files(pieces: &[Vec<Point>]) -> Vec<VtkXml> {
    let mut files = Vec::new();
    for number in 0..96 {
        files.push(VtkXml {
            form: FORMS[number % 4],
            packing: PACKINGS[number / 4 % 3],
            is_wide: number / 12 % 2 == 0,
            is_big: number / 24 % 2 == 0,
            is_double: number / 48 % 2 == 0,
            ..VtkXml::of(pieces.to_vec())
        });
    }
    files
}

#[test]
fn points_are_the_same_bits_however_they_are_written() {
    let all = cloud(70);
    for pieces in [vec![all.clone()], vec![all[..25].to_vec(), Vec::new(), all[25..].to_vec()]] {
        for file in files(&pieces) {
            let found = points_of(file.bytes()).unwrap_or_else(|e| panic!("{e}: {file:?}"));
            assert_eq!(bits(&found), bits(&all), "{file:?}");
        }
    }
    for (packing, block_len) in
        [(Packing::Zlib, 1), (Packing::Lz4, 14), (Packing::Zlib, 840), (Packing::Lz4, 1 << 20)]
    {
        let file = VtkXml { packing, block_len, ..VtkXml::of(vec![all.clone()]) };
        assert_eq!(bits(&points_of(file.bytes()).unwrap()), bits(&all), "{packing:?} {block_len}");
    }
}

#[test]
fn batches_and_buffers_end_anywhere() {
    let all = cloud(40_000);
    for form in FORMS {
        for packing in PACKINGS {
            let file = VtkXml { form, packing, block_len: 32_768, ..VtkXml::of(vec![all.clone()]) };
            assert!(bits(&points_of(file.bytes()).unwrap()) == bits(&all), "{form:?} {packing:?}");
        }
    }
}

#[test]
fn other_elements_and_spaces_do_not_matter() {
    let text = "\u{feff}\n<VTKFile  type = 'PolyData'\n byte_order='LittleEndian'>\
                <Other><Points><DataArray>9 9</DataArray></Points></Other>\
                <PolyData><Piece NumberOfPoints=' 2 ' NumberOfVerts='0'>\
                <Verts><DataArray type='Int32' format='ascii'></DataArray></Verts>\
                <Points ><DataArray type='Float32' NumberOfComponents='3'><!-- two -->\
                <InformationKey name='x'><Value index='0'>7</Value></InformationKey>\n1 2\t3\r\n4 5 nan </DataArray ></Points>\
                </Piece></PolyData></VTKFile>";
    assert_fails(
        points_of(text),
        ErrorKind::Malformed,
        &["piece 1, point 2", "not finite", "--skip-invalid"],
    );
    assert_eq!(points_of(text.replace("nan", "-6e3")).unwrap(), [[1.0, 2.0, 3.0], [4.0, 5.0, -6000.0]]);
    let options = SourceOptions { skip_invalid: true, ..flat() };
    let folder = Folder::new();
    assert_eq!(points(&[folder.file("a.vtp", text)], &options).unwrap(), [[1.0, 2.0, 3.0]]);
    let grid =
        text.replace("PolyData", "StructuredGrid").replace("NumberOfPoints=' 2 '", "Extent='0 0 -1 0 5 5'");
    assert_eq!(points_of(grid.replace("nan", "6")).unwrap().len(), 2);
    let none = "<VTKFile type='PolyData'><PolyData><Piece NumberOfPoints='0'/></PolyData></VTKFile>";
    assert_eq!(points_of(none).unwrap(), [[0.0; 3]; 0]);
}

#[test]
fn integers_are_points() {
    let text = |kind: &str, values: &str| {
        format!(
            "<VTKFile type='PolyData'><PolyData><Piece NumberOfPoints='1'><Points><DataArray type='{kind}' \
             NumberOfComponents='3'>{values}</DataArray></Points></Piece></PolyData></VTKFile>"
        )
    };
    assert_eq!(points_of(text("Int16", "-32768 0 7")).unwrap(), [[-32768.0, 0.0, 7.0]]);
    assert_fails(points_of(text("UInt8", "1 256 7")), ErrorKind::Malformed, &["piece 1, point 1", "\"256\""]);
}

#[test]
fn files_of_vtk_and_meshio_are_read() {
    let expected: Vec<Point> = (0..40u32)
        .map(|i| [f64::from(i) / 8.0, f64::from(i * i % 17), -f64::from((i as f32) / 3.0)])
        .collect();
    for name in ["vtk_zlib.vtu", "vtk_lz4_base64.vtp", "meshio_zlib.vtu", "vtk_fields.vtk"] {
        let found = points(&[sample(name)], &flat()).unwrap();
        assert_eq!(bits(&found), bits(&expected), "{name}");
    }
}

#[test]
fn points_come_from_files_or_pipes_and_are_finalized_in_space() {
    let folder = Folder::new();
    let file = VtkXml { packing: Packing::Zlib, ..VtkXml::of(vec![cloud(3000)[4..].to_vec()]) }.bytes();
    let path = folder.write("a.vtu", &file);
    let from_file = run("spfinalize", &["--octree", &path], b"");
    let from_pipe = run("spfinalize", &["--octree", "-q"], &file);
    assert_eq!(outcome(&from_file), (Some(0), String::new()));
    assert!(from_file.stdout == from_pipe.stdout && from_file.stdout.len() > 2996 * 24);
    let meshed = run("tess3", &["-q", &path, "-o", "-"], b"");
    assert_eq!(meshed.status.code(), Some(0), "{}", outcome(&meshed).1);
    let info = run("spinfo", &["-"], &meshed.stdout);
    assert!(
        String::from_utf8_lossy(&info.stdout).contains("2996"),
        "{}",
        String::from_utf8_lossy(&info.stdout)
    );
}

#[test]
fn bounds_and_grids_hold_for_them_as_for_others() {
    let folder = Folder::new();
    let path = folder.file("a.vtu", VtkXml::of(vec![vec![[1.0, 1.0, 5.0], [3.5, 1.0, 6.25]]]).bytes());
    let bounds = Some(Bounds { min: [2.0, 0.0, 0.0], max: [4.0, 4.0, 9.0] });
    let options = SourceOptions { bounds, grid: Some(([0.25; 3], [0.0; 3])), ..flat() };
    assert_eq!(points(&[path], &options).unwrap(), [[14.0, 4.0, 25.0]]);
}

/// A whole file in which `to` replaces `from`, which the file must contain.
fn changed(file: &VtkXml, from: &str, to: &str) -> Vec<u8> {
    let bytes = file.bytes();
    let at = bytes.windows(from.len()).position(|window| window == from.as_bytes());
    let at = at.unwrap_or_else(|| panic!("{from} is not in the file"));
    [&bytes[..at], to.as_bytes(), &bytes[at + from.len()..]].concat()
}

#[test]
fn what_is_wrong_is_said_and_where() {
    let raw = VtkXml::of(vec![cloud(9)]);
    let ascii = VtkXml { form: Form::Ascii, ..raw.clone() };
    let cases: [(&VtkXml, &str, &str, ErrorKind, &[&str]); 22] = [
        (
            &raw,
            "type=\"UnstructuredGrid\"",
            "type=\"ImageData\"",
            ErrorKind::Usage,
            &["ImageData", "lattice"],
        ),
        (&raw, "type=\"UnstructuredGrid\"", "type=\"PUnstructuredGrid\"", ErrorKind::Usage, &["give those"]),
        (
            &raw,
            "type=\"UnstructuredGrid\"",
            "type=\"PolyData\"",
            ErrorKind::Malformed,
            &["no pieces of PolyData"],
        ),
        (&raw, "LittleEndian", "PDP", ErrorKind::Malformed, &["byte_order", "PDP"]),
        (&raw, "UInt64", "UInt16", ErrorKind::Malformed, &["header_type"]),
        (
            &raw,
            "header_type",
            "compressor='vtkLZMADataCompressor' header_type",
            ErrorKind::Usage,
            &["LZMA", "zlib"],
        ),
        (&raw, "\"9\"", "\"8\"", ErrorKind::Malformed, &["piece 1", "216 bytes", "need 192"]),
        (&raw, "\"9\"", "\"18446744073709551615\"", ErrorKind::Malformed, &["no file holds as many"]),
        (&raw, "\"9\"", "\"-9\"", ErrorKind::Malformed, &["Piece", "number of points"]),
        (&raw, "\"3\"", "\"2\"", ErrorKind::Malformed, &["NumberOfComponents"]),
        (&raw, "offset=\"80\"", "offset=\"8000\"", ErrorKind::Malformed, &["offset 8000", "beyond"]),
        (&raw, "offset=\"80\"", "offset=\"18446744073709551615\"", ErrorKind::Malformed, &["beyond"]),
        (&raw, "offset=\"80\"", "", ErrorKind::Malformed, &["no offset"]),
        (&raw, "encoding=\"raw\"", "encoding=\"hex\"", ErrorKind::Malformed, &["hex", "raw or base64"]),
        (&raw, "\n  _", "\n  ", ErrorKind::Malformed, &["underscore"]),
        (&raw, "</VTKFile>", "</VTKFil>", ErrorKind::Malformed, &["truncated", "</VTKFile>"]),
        (&raw, "</Points>", "</Point>", ErrorKind::Malformed, &["damaged XML", "byte"]),
        (&raw, "<Points>\n", "<Nodes>\n", ErrorKind::Malformed, &["damaged XML", "byte"]),
        (&ascii, "\"9\"", "\"8\"", ErrorKind::Malformed, &["piece 1, point 9", "more behind the 24 numbers"]),
        (&ascii, "\"9\"", "\"10\"", ErrorKind::Malformed, &["piece 1, point 10", "found 27 of 30"]),
        (&ascii, "-1.5", "-1.5x", ErrorKind::Malformed, &["piece 1, point 2", "\"-1.5x\""]),
        (&ascii, "</VTKFile>", "", ErrorKind::Malformed, &["truncated", "within the element VTKFile"]),
    ];
    for (file, from, to, kind, parts) in cases {
        assert_fails(points_of(changed(file, from, to)), kind, parts);
    }
}

#[test]
fn hostile_elements_are_refused_within_bounded_memory() {
    let start = "<VTKFile type='PolyData'><PolyData>";
    let deep = format!("{start}{}", "<a>".repeat(100_000));
    let long = format!("{start}<Piece a='{}'", "x".repeat(10_000_000));
    let comment = format!("{start}<!-- {}", "x".repeat(10_000_000));
    for (text, part) in
        [(deep, "in each other"), (long, "more than 65536 bytes"), (comment, "more than 65536 bytes")]
    {
        let folder = Folder::new();
        let path = folder.file("hostile", text);
        let largest = crate::allocation::largest_during(|| {
            assert_fails(Input::open(&[path], &flat()), ErrorKind::Malformed, &[part, "byte"]);
        });
        assert!(largest < 1 << 20, "a request of {largest} bytes");
    }
}

/// Blocks that state more than they hold.
#[test]
fn hostile_blocks_are_refused_within_bounded_memory() {
    let zeros = vec![vec![[0.0; 3]; 1000]];
    for packing in [Packing::Zlib, Packing::Lz4] {
        let whole =
            VtkXml { packing, block_len: 24_000, is_wide: false, ..VtkXml::of(zeros.clone()) }.bytes();
        // The points are the second of three arrays, each of which states the length of blocks.
        let mut lengths =
            whole.windows(4).enumerate().filter(|(_, window)| *window == 24_000u32.to_le_bytes());
        let (at, _) = lengths.nth(1).unwrap();
        // The number of blocks, the length of a block, the length of the last block, and its compressed
        // length.
        for (place, value) in
            [(at - 4, u32::MAX), (at, u32::MAX), (at, 1), (at + 4, 5), (at + 8, 3), (at + 8, u32::MAX)]
        {
            let mut damaged = whole.clone();
            damaged[place..place + 4].copy_from_slice(&value.to_le_bytes());
            let largest = crate::allocation::largest_during(|| {
                assert_fails(points_of(damaged), ErrorKind::Malformed, &["piece 1, point 1"]);
            });
            assert!(largest < 1 << 20, "a request of {largest} bytes");
        }
    }
}

#[test]
fn damaged_zlib_blocks_are_named() {
    let folder = Folder::new();
    let whole = VtkXml { packing: Packing::Zlib, block_len: 1 << 15, ..VtkXml::of(vec![cloud(900)]) }.bytes();
    let is_zlib = |bytes: &[u8]| bytes[0] == 0x78 && matches!(bytes[1], 0x01 | 0x5e | 0x9c | 0xda);
    let starts: Vec<usize> = (0..whole.len() - 1).filter(|&at| is_zlib(&whole[at..])).collect();
    let damaged = starts.iter().filter_map(|start| {
        let mut damaged = whole.clone();
        // The code of a block of deflate that is reserved.
        damaged[start + 2] = 0xff;
        points(&[folder.file("damaged.vtu", damaged)], &flat()).err()
    });
    let messages: Vec<String> = damaged
        .map(|error| {
            assert_eq!(error.kind(), ErrorKind::Malformed, "{error}");
            error.to_string()
        })
        .collect();
    let is_named = |message: &String| {
        message.contains("damaged.vtu") && message.contains("compressed block 1: corrupt deflate stream")
    };
    assert!(messages.iter().any(is_named), "{messages:?}");
}

#[test]
fn damage_is_survived_and_no_cut_passes_for_a_whole_file() {
    let folder = Folder::new();
    for (form, packing) in [
        (Form::Ascii, Packing::Plain),
        (Form::Binary, Packing::Zlib),
        (Form::AppendedRaw, Packing::Plain),
        (Form::AppendedRaw, Packing::Lz4),
        (Form::AppendedBase64, Packing::Zlib),
    ] {
        let whole = VtkXml { form, packing, block_len: 50, ..VtkXml::of(vec![cloud(7)]) }.bytes();
        damage::damage_bytes(&whole, (0..whole.len()).step_by(5));
        // Only a line feed follows the last element, so every shorter file is incomplete.
        for len in (1..whole.len() - 1).step_by(3) {
            let path = folder.file("cut", &whole[..len]);
            assert!(points(&[path], &flat()).is_err(), "{form:?} {packing:?} cut at {len}");
        }
    }
}
