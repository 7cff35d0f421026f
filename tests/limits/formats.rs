//! Limits of headers, lists and texts at both sides.

use std::io::Write;

use flate2::Compression;
use flate2::write::GzEncoder;
use spmesh_base::limits::{
    CONFIGURATION_DEGREE_MAX, CRS_DEPTH_MAX, EXPANSION_FREE, PLY_ITEMS_MAX, PLY_LIST_MAX, PLY_STRIPS_MAX,
    RADII_LEN_MAX, SPA_COMMENTS_MAX, TEXT_HEADER_LINE_MAX,
};
use spmesh_formats::source::{SpReader, SpaReader};
use spmesh_stream::check_degree;

use super::sides::{assert_sides, padded};
use crate::programs::{Folder, assert_outcome, outcome, run, sample};

const VERTEX: &str = "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n";

#[test]
fn lists_of_ply() {
    let list = |len: usize| {
        let head = "ply\nformat binary_little_endian 1.0\nelement other 1\nproperty list uint uchar a\n";
        let len = (len as u32).to_le_bytes();
        [head.as_bytes(), VERTEX.as_bytes(), b"end_header\n", &len, &[7; PLY_LIST_MAX as usize + 1], &[0; 12]]
            .concat()
    };
    let part = "list of 65537 values, the maximum is 65536";
    assert_sides(&["spfinalize", "-"], PLY_LIST_MAX as usize, part, list);
}

/// Strips of a length that is stated alone: shorter ones are missing.
#[test]
fn strips_of_ply() {
    let head =
        "ply\nformat binary_little_endian 1.0\nelement tristrips 1\nproperty list uint int vertex_indices\n";
    for (len, part) in [(PLY_STRIPS_MAX, "truncated"), (PLY_STRIPS_MAX + 1, "the maximum is 16777216")] {
        let bytes =
            [head.as_bytes(), VERTEX.as_bytes(), b"end_header\n", &(len as u32).to_le_bytes()].concat();
        assert_outcome("spfinalize", &["-"], &bytes, 3, part);
    }
}

#[test]
fn headers_of_ply() {
    // Each line of the header counts, but for the first and the last one.
    let header = |lines: usize| {
        let mut text = format!("ply\nformat ascii 1.0\n{VERTEX}");
        let others = lines + 1 - text.lines().count();
        (0..others).for_each(|number| text += &format!("property uchar a{number}\n"));
        (text + "end_header\n1 2 3" + &" 0".repeat(others) + "\n").into_bytes()
    };
    assert_sides(&["spfinalize", "-"], PLY_ITEMS_MAX, "more than 1000 lines", header);
}

/// Comments beyond the limit are dropped.
#[test]
fn comments_of_spa() {
    // A comment counts with its line end.
    let kept = |last: usize| -> usize {
        let line = |len: usize| format!("# {}\n", "a".repeat(len));
        let text = line(1023).repeat(SPA_COMMENTS_MAX / 1024 - 1) + &line(last) + "v 0 0 0\n";
        let reader = SpaReader::new(text.as_bytes()).unwrap();
        reader.header().comments.iter().map(|comment| comment.len() + 1).sum()
    };
    assert_eq!(kept(1023), SPA_COMMENTS_MAX);
    assert_eq!(kept(1024), SPA_COMMENTS_MAX - 1024);
}

#[test]
fn brackets_of_systems() {
    let folder = Folder::new();
    for (depth, is_refused) in [(CRS_DEPTH_MAX, false), (CRS_DEPTH_MAX + 1, true)] {
        let path = folder.write("a.prj", "A[".repeat(depth) + "1" + &"]".repeat(depth));
        let (code, message) = outcome(&run("spfinalize", &["--crs", &path, &sample("hextest.las")], &[]));
        assert_eq!(message.contains("more than 32 levels of brackets"), is_refused, "{message}");
        assert!(!is_refused || code == Some(2), "{code:?}");
    }
}

#[test]
fn header_lines_of_twins() {
    let header = |len: usize| padded("#spmesh ", len);
    let part = "line of more than 8388608 bytes";
    assert_sides(&["spfinalize", "-"], TEXT_HEADER_LINE_MAX, part, header);
}

#[test]
fn files_of_radii() {
    let folder = Folder::new();
    for (len, is_refused) in [(RADII_LEN_MAX, false), (RADII_LEN_MAX + 1, true)] {
        let text = "#".repeat(63) + "\n";
        let text =
            text.repeat(len as usize / 64 - 1) + &format!("{:<1$}\n", "* * C 1.7", len as usize % 64 + 63);
        assert_eq!(text.len() as u64, len);
        let path = folder.write("radii.txt", text);
        let arguments = ["--radii", &path, &sample("1aki.pdb"), "-o", "/dev/null"];
        let (_, message) = outcome(&run("tess3", &arguments, &[]));
        assert_eq!(message.contains("more than 16 MB"), is_refused, "{message}");
    }
}

#[test]
fn degrees() {
    assert!(check_degree(CONFIGURATION_DEGREE_MAX).is_ok());
    let message = check_degree(CONFIGURATION_DEGREE_MAX + 1).unwrap_err().to_string();
    assert!(message.contains("degree 4097, the maximum is 4096"), "{message}");
}

/// Points that are held must not expand implausibly, in a file or a pipe. Points that pass may.
#[test]
fn expansion_of_points() {
    let folder = Folder::new();
    for (len, is_refused) in [(EXPANSION_FREE as usize, false), (EXPANSION_FREE as usize + 1, true)] {
        let last = padded("1 2 3", len % 6 + 5);
        let text = ["1 2 3\n".repeat(len / 6 - 1).as_bytes(), &last].concat();
        assert_eq!(text.len(), len);
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(&text).unwrap();
        let packed = encoder.finish().unwrap();
        let path = folder.write("points.xyz.gz", &packed);
        for (name, arguments) in
            [("tess3", &["-o", "/dev/null", &path][..]), ("tess3", &["-o", "/dev/null", "-"])]
        {
            let (code, message) = outcome(&run(name, arguments, &packed));
            assert_eq!(code, Some(if is_refused { 3 } else { 0 }), "{arguments:?}: {message}");
            let is_clear = message.contains("at most 100-fold") && message.contains("gunzip");
            assert_eq!(is_clear, is_refused, "{message}");
        }
        let (code, message) = outcome(&run("spfinalize", &["-qo", "/dev/null", &path], &[]));
        assert_eq!(code, Some(0), "{message}");
    }
}
