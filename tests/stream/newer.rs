//! Streams and text twins of other versions: every program says what it lacks.

use spmesh_base::error::ErrorKind;
use spmesh_formats::drivers::Format;

use crate::convert::{converted, text_of};
use crate::programs::{Folder, assert_outcome};
use crate::vectors::load;

/// Programs with arguments to read a stream on stdin, and whether they read points.
const READERS: [(&str, &[&str], bool); 13] = [
    ("spfinalize", &["-"], true),
    ("spdelaunay2d", &["-"], true),
    ("spdelaunay3d", &["-"], false),
    ("spdelaunay2d", &["--merge", "-"], false),
    ("spdem", &["--step", "1", "-"], false),
    ("spview", &["-"], true),
    ("tess3", &["-"], true),
    ("dd4", &["-"], false),
    ("configgen", &["--degree", "1", "-"], true),
    ("splinefit", &["fit", "-"], true),
    ("splinefit", &["eval", "--step", "1", "-"], false),
    ("spinfo", &["--audit", "-"], true),
    ("spconvert", &["--to", "text", "-"], true),
];

#[test]
fn every_program_says_what_it_lacks_and_leaves_no_file() {
    let folder = Folder::new();
    let output = folder.path("output");
    let in_header = ["version", "version-1", "kind", "feature-bit", "coordinate-type", "record-required"];
    let in_block = "tag-unknown-after-skipped";
    let names = in_header.into_iter().chain([in_block]);
    let vectors = load("fail", "err");
    for vector in names.map(|name| vectors.iter().find(|vector| vector.name == name).unwrap()) {
        for (program, arguments, _) in
            READERS.into_iter().filter(|(.., reads_points)| *reads_points || vector.name != in_block)
        {
            let to: &[&str] = if program == "spinfo" { &[] } else { &["-o", &output] };
            assert_outcome(program, &[arguments, to].concat(), &vector.bytes, 6, &vector.expected);
            assert!(folder.names("").is_empty(), "{program} on {}", vector.name);
        }
    }
}

#[test]
fn twins_of_other_versions_are_refused_as_such() {
    let vector = load("pass", "txt").into_iter().find(|vector| vector.name == "points-tagged").unwrap();
    for (version, words) in [
        ("0", "version 0; this program reads version 2 only: an older spmesh made it"),
        ("1", "version 1; this program reads version 2 only: an older spmesh made it"),
        ("3", "version 3; this program reads version 2: a newer spmesh made it"),
        ("70000", "version 70000; this program reads version 2: a newer spmesh made it"),
    ] {
        let twin = vector.expected.replacen("version 2", &format!("version {version}"), 1);
        let error = converted(twin.as_bytes(), Format::Twin, Format::Stream).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Unsupported, "{error}");
        assert!(error.to_string().starts_with(&format!("test: line 1: {words}")), "{error}");
    }
}

/// Programs that make a stream from another leave out what they skipped.
#[test]
fn conversions_leave_out_what_they_skip() {
    for vector in load("pass", "txt").into_iter().filter(|vector| vector.name.contains("skipped")) {
        assert_eq!(text_of(&vector.bytes), vector.expected, "{}", vector.name);
        let stream = converted(&vector.bytes, Format::Stream, Format::Stream).unwrap();
        assert_eq!(text_of(&stream), vector.expected, "{}", vector.name);
        assert!(!stream.windows(4).any(|bytes| bytes == b"note"), "{}", vector.name);
    }
}
