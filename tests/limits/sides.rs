//! Limits of inputs at both sides: the last that is taken, and the first that is refused.

use std::fs::File;

use spmesh_base::limits::{
    BREAKLINE_VERTICES_MAX, CONDITION_DEPTH_MAX, CONDITION_LEN_MAX, CONTOURS_PER_TRIANGLE_MAX,
    LIST_FILES_MAX, MANIFEST_LEN_MAX, NPY_HEADER_MAX, NRRD_FILES_MAX, NRRD_HEADER_MAX, NUMBER_LEN_MAX,
    PLAN_LEN_MAX, STRUCTURE_LINE_MAX, TEXT_LINE_MAX, WKT_LEN_MAX, XML_DEPTH_MAX, XML_TAG_MAX,
};
use spmesh_formats::source::{read_polygons, read_polylines};
use spmesh_formats::volumes::Condition;
use spmesh_stream::{Coordinates, Crs};

use crate::programs::{Folder, outcome, run};

/// Runs a tool with an input of the size of a limit, and of one more. The second must be refused with `part`,
/// the first not: it is taken, or another message says what is wrong with it.
pub(super) fn assert_sides(arguments: &[&str], most: usize, part: &str, input: impl Fn(usize) -> Vec<u8>) {
    for (size, is_refused) in [(most, false), (most + 1, true)] {
        let (code, message) = outcome(&run(arguments[0], &arguments[1..], &input(size)));
        assert_eq!(message.contains(part), is_refused, "{arguments:?}, {size}: {code:?}, {message}");
        assert!(code.is_some() && (code != Some(0) || !is_refused), "{arguments:?}, {size}: {code:?}");
    }
}

/// A line of `len` bytes.
pub(super) fn padded(text: &str, len: usize) -> Vec<u8> {
    [text.as_bytes(), &vec![b' '; len - text.len()], b"\n"].concat()
}

#[test]
fn lines() {
    let point = |len| padded("1 2 3", len);
    assert_sides(&["spfinalize", "-"], TEXT_LINE_MAX, "line of more than 65536", point);
    let comment = |len| [padded("#", len), b"data_a\n".to_vec()].concat();
    let part = "line of more than 16777216";
    assert_sides(&["tess3", "--from", "mmcif", "-"], STRUCTURE_LINE_MAX, part, comment);
}

#[test]
fn lists_of_files() {
    let folder = Folder::new();
    for (count, is_refused) in [(LIST_FILES_MAX, false), (LIST_FILES_MAX + 1, true)] {
        let list = folder.write("list.txt", "a\n".repeat(count));
        let (code, message) = outcome(&run("spfinalize", &["--lof", &list], &[]));
        assert_eq!(message.contains("more than 1048576 files"), is_refused, "{message}");
        assert!(code.is_some_and(|code| code != 0), "{message}");
    }
}

#[test]
fn headers_of_arrays() {
    let array = |len: usize| {
        let head = format!("{:<1$}", "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 3), }", len - 1);
        let len = (len as u16).to_le_bytes();
        [&b"\x93NUMPY\x01\x00"[..], &len, head.as_bytes(), b"\n", &[0; 24]].concat()
    };
    assert_sides(&["spfinalize", "-"], NPY_HEADER_MAX as usize, "at most 10000", array);
}

#[test]
fn elements_and_tags() {
    let nested = |depth: usize| {
        let open = "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\">";
        [open, &"<a>".repeat(depth - 1)].concat().into_bytes()
    };
    assert_sides(&["spfinalize", "-"], XML_DEPTH_MAX, "more than 64 elements", nested);
    // The limit is of what lies between the angle brackets and what is read with them.
    let tag =
        |len: usize| format!("<VTKFile type=\"UnstructuredGrid\" version=\"1.0\"><a{}/>", " ".repeat(len));
    let outcome = |len: usize| outcome(&run("spfinalize", &["-"], tag(len).as_bytes())).1;
    assert!(!outcome(XML_TAG_MAX - 8).contains("more than 65536"), "{}", outcome(XML_TAG_MAX - 8));
    assert!(outcome(XML_TAG_MAX + 1).contains("more than 65536"), "{}", outcome(XML_TAG_MAX + 1));
}

#[test]
fn headers_of_volumes() {
    let head = "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 2 2 2 2\nencoding: raw\n";
    let volume = |len: usize| {
        let comment = "#".repeat(60_000) + "\n";
        let mut text = head.to_string();
        while len - text.len() > comment.len() + 10 {
            text += &comment;
        }
        text += &"#".repeat(len - text.len() - 2);
        [text.as_bytes(), b"\n\n", &[0; 16]].concat()
    };
    assert_sides(&["dd4", "-"], NRRD_HEADER_MAX as usize, "more than 1048576 bytes", volume);
    let files = |count: usize| format!("{head}data file: a%d.raw 1 {count} 1 3\n\n").into_bytes();
    let folder = Folder::new();
    for (count, is_refused) in [(NRRD_FILES_MAX, false), (NRRD_FILES_MAX + 1, true)] {
        let path = folder.write("a.nhdr", files(count));
        let (_, message) = outcome(&run("dd4", &[&path], &[]));
        assert_eq!(message.contains("expected from 1 to 65536"), is_refused, "{message}");
    }
    let number = |len: usize| {
        let values = format!("0.{}\n{}", "1".repeat(len - 2), "1\n".repeat(15));
        format!("{}\n{values}", head.replace("raw", "ascii").replace("uchar", "double")).into_bytes()
    };
    assert_sides(&["dd4", "-"], NUMBER_LEN_MAX, "at most 128 bytes", number);
}

/// Files without data on the disk: a longer one is not read at all.
#[test]
fn manifests_and_plans() {
    let folder = Folder::new();
    let limits = [
        (MANIFEST_LEN_MAX, r#"{"format":"spmesh mesh in parts","#, "spinfo", &[][..]),
        (PLAN_LEN_MAX, r#"{"format":"spmesh plan","#, "spnode", &["list"]),
    ];
    for (most, start, name, words) in limits {
        let path = folder.write("long.json", start);
        File::options().write(true).open(&path).unwrap().set_len(most + 1).unwrap();
        let (code, message) = outcome(&run(name, &[words, &[&path]].concat(), &[]));
        let expected = format!("{} bytes, the maximum is {most}", most + 1);
        assert!(code == Some(3) && message.contains(&expected), "{code:?} {message}");
    }
}

#[test]
fn conditions() {
    let long = |len: usize| format!("{:<len$}", "x > 1").parse::<Condition>();
    assert!(long(CONDITION_LEN_MAX).is_ok());
    assert!(long(CONDITION_LEN_MAX + 1).unwrap_err().contains("longer than 4096"));
    let deep = |depth: usize| format!("{}x > 1{}", "(".repeat(depth), ")".repeat(depth)).parse::<Condition>();
    assert!(deep(CONDITION_DEPTH_MAX).is_ok(), "{:?}", deep(CONDITION_DEPTH_MAX));
    assert!(deep(CONDITION_DEPTH_MAX + 1).unwrap_err().contains("at most 32 parentheses"));
}

#[test]
fn breaklines_and_masks() {
    let line = |count: usize| -> String {
        let places = (0..count).map(|place| format!(" {place} 0"));
        "smooth-crease".to_string() + &places.collect::<String>()
    };
    // Lines of text are short, so there are several.
    let lines = |count: usize| -> String {
        let (mut text, mut left) = (String::new(), count);
        while left > 0 {
            // No line is left with a single vertex.
            let part = if left <= 5_001 { left } else { 5_000 };
            text = text + &line(part) + "\n";
            left -= part;
        }
        text
    };
    let folder = Folder::new();
    let read = |count: usize| {
        let path = folder.file("lines.txt", lines(count));
        read_polylines(&path).map_err(|error| error.to_string())
    };
    assert!(read(BREAKLINE_VERTICES_MAX).is_ok(), "{:?}", read(BREAKLINE_VERTICES_MAX).err());
    assert!(read(BREAKLINE_VERTICES_MAX + 1).unwrap_err().contains("more than 1048576 vertices"));
    let mask = |len: usize| {
        let text = padded("POLYGON((0 0,4 0,4 4,0 0))", len - 1);
        let path = folder.file("mask.wkt", text);
        read_polygons(&[path], &Coordinates::F64, &Crs::Unknown, u64::MAX).map_err(|error| error.to_string())
    };
    let most = WKT_LEN_MAX as usize;
    assert!(mask(most).is_ok());
    assert!(mask(most + 1).unwrap_err().contains("more than 33554432 bytes"));
}

#[test]
fn levels_through_a_triangle() {
    let high = CONTOURS_PER_TRIANGLE_MAX;
    for (top, is_refused) in [(high, false), (high + 1, true)] {
        // Levels are the whole numbers from 1 on.
        let points = format!("0 0 0.5\n9 0 {top}.5\n0 9 0.5\n");
        let points = run("spfinalize", &["-"], points.as_bytes()).stdout;
        let mesh = run("spdelaunay2d", &[], &points).stdout;
        let (code, message) = outcome(&run("spdem", &["--contours", "1", "--format", "geojson"], &mesh));
        assert_eq!(code == Some(2), is_refused, "{message}");
        assert_eq!(message.contains("at most 131072 may"), is_refused, "{message}");
    }
}
