//! The program on the command line: exit codes, messages, and output files that are complete or absent.

use std::path::Path;
use std::process::Output;

use spmesh_stream::StreamReader;
use spmesh_stream::model::bounds::Bounds;

use super::samples;
use crate::programs::{Folder, assert_outcome};

fn spconvert(arguments: &[&str], input: &[u8]) -> Output {
    crate::programs::run("spconvert", arguments, input)
}

fn files_in(folder: &Path) -> usize {
    std::fs::read_dir(folder).unwrap().count()
}

#[test]
fn a_pipe_goes_round() {
    let stream = samples::mesh(samples::grids()[1]);
    let text = spconvert(&["--to", "text"], &stream);
    assert!(text.status.success() && text.stderr.is_empty());
    let back = spconvert(&["-", "-o", "-", "--to", "spm", "--from", "text"], &text.stdout);
    assert!(back.status.success() && back.stdout == stream);
}

#[test]
fn the_format_comes_from_the_name_of_the_output() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh.smb");
    let result = spconvert(&["-o", path.to_str().unwrap()], &samples::mesh(samples::grids()[1]));
    assert!(result.status.success());
    let notices = String::from_utf8(result.stderr).unwrap();
    assert!(notices.contains("spconvert: stdin: SMB holds no CRS"), "{notices}");
    assert_eq!(std::fs::read(&path).unwrap()[..4], [0, 0, 0, 0]);
    let quiet = spconvert(&[path.to_str().unwrap(), "--to", "obj", "--quiet"], b"");
    assert!(quiet.status.success() && quiet.stderr.is_empty() && quiet.stdout.starts_with(b"# OBJ"));
}

#[test]
fn a_cut_input_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let stream = samples::mesh(samples::grids()[0]);
    for name in ["mesh.ply", "mesh.txt", "mesh.sma", "mesh.spm"] {
        let path = folder.path().join(name);
        let result = spconvert(&["-o", path.to_str().unwrap()], &stream[..stream.len() - 20]);
        assert_eq!(result.status.code(), Some(3));
        let message = String::from_utf8(result.stderr).unwrap();
        assert!(message.starts_with("spconvert: stdin: block 13 at byte "), "{message}");
        assert_eq!(files_in(folder.path()), 0);
    }
}

#[test]
fn wrong_requests_are_told_apart() {
    let points = samples::points(2, true, false);
    let cases: [(&[&str], &[u8], i32, &str); 7] = [
        (&[], &points, 2, "--to"),
        (&["--to", "step"], &points, 2, "possible values"),
        (&["--to", "spm", "--from", "vtu"], &points, 2, "possible values"),
        (&["--to", "sma"], &points, 2, "cannot be written as SMA, which holds triangle mesh"),
        (&["--to", "spm", "--from", "ply"], &points, 3, "expected \"ply\""),
        (&["--to", "spm"], b"no mesh at all\n", 2, "--from"),
        (&["--to", "spm"], b"", 3, "empty: the input has no bytes"),
    ];
    for (arguments, input, code, expected) in cases {
        let result = spconvert(arguments, input);
        let message = String::from_utf8(result.stderr).unwrap();
        assert_eq!(result.status.code(), Some(code), "{message}");
        assert!(message.contains(expected), "{message}");
    }
}

/// A stream has its bounds before its vertices, which other formats do not state.
#[test]
fn files_of_other_programs_are_read_twice_for_their_bounds() {
    let folder = Folder::new();
    let mesh = "v 3 -1 7\nv 0 2 5\nv 9 9 -4\nf 1 2 3\n";
    folder.write("a.obj", mesh);
    let bounds = |stream: &[u8]| {
        let header = StreamReader::new(stream, "stream").unwrap().header().clone();
        header.bounds.map(|Bounds { min, max }| [min, max])
    };
    for ending in ["obj", "ply", "sma", "smb"] {
        let file = folder.path(&format!("a.{ending}"));
        if ending != "obj" {
            assert_outcome("spconvert", &[&folder.path("a.obj"), "-o", &file], &[], 0, "");
        }
        let stream = spconvert(&["--to", "spm", &file], &[]).stdout;
        assert_eq!(bounds(&stream), Some([[0.0, -1.0, -4.0], [9.0, 9.0, 7.0]]), "{ending}");
        let piped = spconvert(&["--from", ending, "--to", "spm", "-"], &std::fs::read(&file).unwrap()).stdout;
        assert_eq!(bounds(&piped), None, "{ending}");
        let local = spconvert(&["--to", "obj", "--local-origin", &file], &[]).stdout;
        assert!(String::from_utf8(local).unwrap().contains("# origin"), "{ending}");
    }
    let empty = folder.write("empty.obj", "# nothing\n");
    assert_eq!(bounds(&spconvert(&["--from", "obj", "--to", "spm", &empty], &[]).stdout), None);
}
