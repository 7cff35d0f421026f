//! Endless inputs that are no points: every tool refuses them after their first bytes.

use std::io::Write;
use std::process::Stdio;
use std::time::{Duration, Instant};

use crate::programs::{Folder, assert_outcome, cloud, outcome, run, skip, start};

/// Bytes after which a tool must have given up, with room for pipes and buffers.
const READ_MAX: usize = 32 << 20;

/// Runs a tool on endless repetitions of `pattern`, which it must refuse.
fn assert_refuses_endless(tool: &str, arguments: &[&str], pattern: &[u8]) {
    let started = Instant::now();
    let mut child = start(tool, arguments, Stdio::piped());
    let mut stdin = child.stdin.take().expect("a pipe");
    let block = pattern.repeat((1 << 16) / pattern.len());
    let mut written = 0;
    while written < READ_MAX && stdin.write_all(&block).is_ok() {
        written += block.len();
    }
    drop(stdin);
    let (code, message) = outcome(&child.wait_with_output().expect("it ends"));
    let what = format!("{tool} {arguments:?} on {:?}", String::from_utf8_lossy(&pattern[..1]));
    assert!(written < READ_MAX, "{what} does not stop reading: {message}");
    assert!(matches!(code, Some(2 | 3)), "{what}: {code:?}: {message}");
    assert!(message.contains("stdin") && !message.contains("panicked"), "{what}: {message}");
    assert!(started.elapsed() < Duration::from_secs(20), "{what}");
}

/// The arguments of every way to read from a path, with the path as `PATH`.
fn readings<'a>(points: &'a str, mesh: &'a str, spline: &'a str, cells: &'a str) -> Vec<[&'a str; 8]> {
    let pad = |words: &[&'a str]| -> [&'a str; 8] {
        let mut padded = [""; 8];
        padded[..words.len()].copy_from_slice(words);
        padded
    };
    [
        &["spfinalize", "PATH"][..],
        &["spfinalize", "--octree", "PATH"],
        &["spfinalize", "--lof", "PATH"],
        &["spdelaunay2d", "PATH"],
        &["spdelaunay3d", "PATH"],
        &["spdem", "--step", "1", "PATH", "-o", "/dev/null"],
        &["spview", "PATH"],
        &["tess3", "PATH"],
        &["tess3", "--from", "pdb", "PATH"],
        &["tess3", "--from", "mmcif", "PATH"],
        &["tess3", "--lof", "PATH", "--out-dir", "/nowhere"],
        &["dd4", "PATH"],
        &["dd4", "--raw", "4x4x4x4:u8", "PATH"],
        &["dd4", cells, "--at-file", "PATH"],
        &["configgen", "--degree", "1", "PATH"],
        &["configgen", "--degree", "1", points, "--features", "PATH"],
        &["configgen", "--degree", "1", points, "--patches", "PATH"],
        &["spinfo", "PATH"],
        &["spinfo", "--audit", mesh, "--points", "PATH"],
        &["spconvert", "PATH", "--to", "text"],
        &["spconvert", "PATH", "--from", "smb", "--to", "text"],
        &["spconvert", "PATH", "--from", "sma", "--to", "text"],
        &["spconvert", "PATH", "--from", "spb", "--to", "text"],
        &["splinefit", "fit", "PATH"],
        &["splinefit", "fit", points, "--knots", "PATH"],
        &["splinefit", "fit", points, "--weights", "PATH"],
        &["splinefit", "fit", points, "--features", "PATH"],
        &["splinefit", "eval", "PATH", "--step", "1", "-o", "/dev/null"],
        &["splinefit", "eval", spline, "--at", "PATH"],
        &["splinefit", "info", "PATH"],
        &["splinefit", "info", spline, "PATH"],
        &["splinefit", "mesh", "PATH"],
    ]
    .into_iter()
    .map(pad)
    .collect()
}

/// Calls `check` with a tool and its arguments for every way to read `path`.
fn for_each_reading(path: &str, mut check: impl FnMut(&str, &[&str])) {
    let folder = Folder::new();
    let points = folder.write("points.xyz", cloud(60));
    let [stream, mesh, spline, cells] = ["p.spm", "m.spm", "s.spm", "c.spm"].map(|name| folder.path(name));
    assert_outcome("spfinalize", &[&points, "-o", &stream], &[], 0, "");
    assert_outcome("spdelaunay2d", &[&stream, "-o", &mesh], &[], 0, "");
    assert_outcome("splinefit", &["fit", &points, "--tol", "1000", "-o", &spline], &[], 0, "");
    assert_outcome("dd4", &["--grid", "3x3x3x3", "-o", &cells], &[], 0, "");
    for words in readings(&points, &mesh, &spline, &cells) {
        let words = words.iter().filter(|word| !word.is_empty());
        let words: Vec<&str> = words.map(|&word| if word == "PATH" { path } else { word }).collect();
        check(words[0], &words[1..]);
    }
}

#[test]
fn zeros_and_lines_without_numbers_are_refused_after_their_first_bytes() {
    for_each_reading("-", |tool, arguments| {
        for pattern in [&b"\0"[..], b"y\n"] {
            assert_refuses_endless(tool, arguments, pattern);
        }
    });
}

#[test]
fn devices_without_end_are_refused() {
    if !std::path::Path::new("/dev/zero").exists() {
        skip("there is no /dev/zero");
        return;
    }
    for_each_reading("/dev/zero", |tool, arguments| {
        assert_outcome(tool, arguments, &[], 2, "/dev/zero: is a device");
    });
    assert_outcome("spfinalize", &["--raw", "f32le", "/dev/zero"], &[], 2, "is a device");
    // The empty device is an empty file.
    assert_outcome("spfinalize", &["/dev/null"], &[], 3, "empty");
}

#[test]
fn compressed_zeros_are_refused_after_their_first_bytes() {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    encoder.write_all(&vec![0; 1 << 28]).expect("memory takes all");
    let bomb = encoder.finish().expect("memory takes all");
    let started = Instant::now();
    for tool in ["spfinalize", "tess3", "dd4", "spinfo"] {
        let (code, message) = outcome(&run(tool, &["-"], &bomb));
        assert_eq!(code, Some(3), "{tool}: {message}");
    }
    assert!(started.elapsed() < Duration::from_secs(10));
}

#[test]
fn comments_may_be_longer_than_what_is_recognized() {
    let comment = "# a comment\n".repeat(20_000);
    for (names, code) in [("", 0), ("x y z\n", 0), ("no\nnames\n", 3)] {
        let text = format!("{comment}{names}{}", cloud(20));
        assert_outcome("spfinalize", &["-", "-o", "/dev/null"], text.as_bytes(), code, "");
    }
}
