//! Wrong usage, points that determine nothing, damaged input, and outputs that cannot be written.

use std::fs;

use spmesh_base::error::ErrorKind;

use super::{knots, output, plane, points};
use crate::programs::{Folder, assert_silent_without_reader, kind_of_damage, outcome, run, skip};

#[test]
fn each_failure_has_its_exit_code() {
    let folder = Folder::new();
    let knots = folder.write("knots.txt", knots());
    let (line, far) =
        (folder.write("line.txt", "0 0\n1 1\n2 2\n3 3\n"), folder.write("far.txt", "0 0\n1e6 0\n0 1e6\n"));
    let pairs = folder.write("pairs.txt", "1 2\n");
    let plane = points(500, 1, plane);
    let filled = format!("{plane}5 5 1e30\n6 6 -9999\n7 7 -9999\n");
    let table = format!("x,y,lead,zinc\n{}", plane.replace(' ', ",").replace('\n', ",1\n"));
    let cases: [(&[&str], &[u8], i32, &str); 32] = [
        (&["fit", "no/such/file"], b"", 1, "no/such/file"),
        (&["fit"], b"", 3, "stdin: empty"),
        (&["fit"], b"0 0 1\n1 x 2\n", 3, "stdin: line 2"),
        (&["fit"], b"0 0\n1 1\n", 2, "stdin: points have no elevation"),
        (
            &["fit"],
            filled.as_bytes(),
            3,
            "2 points have z = -9999, 1 point has z = 1e30, far from all others (",
        ),
        (&["fit"], table.as_bytes(), 2, "stdin: line 1 names x, y, lead, zinc: which one is the value?"),
        (&["fit"], b"0 0 1\n1 0 2\n2 0 3\n", 2, "stdin: all observations have the same x or y"),
        (&["fit", "--knots", &knots, "--lambda", "1"], b"11 11 0\n22 22 0\n33 33 1\n", 2, "are on one line"),
        (&["fit", "--knots", &knots], b"11 11 1e200\n22 23 0\n33 32 1\n", 2, "too great for f64"),
        (&["fit", "--tol", "0"], b"", 2, "not a number above zero"),
        (&["fit", "--max-knots", "5"], plane.as_bytes(), 2, "5 knots: 29 are needed"),
        (&["fit", "--lambda", "-1"], b"", 2, "--lambda"),
        (&["fit", "--lambda=ml"], b"", 2, "expected a number that is not negative"),
        (&["fit", "--lambda", "cv:1"], b"", 2, "from 2 to 100"),
        (&["fit", "--lambda", "cv:101"], b"", 2, "from 2 to 100"),
        (&["fit", "--tension", "-1"], b"", 2, "from zero on"),
        (&["fit", "--tension", "1", "--robust", "huber"], b"", 2, "--robust"),
        (&["fit", "--tension", "1", "--step", "9", "--lambda", "gcv"], plane.as_bytes(), 2, "lambda reml"),
        (&["fit", "--degree", "3"], plane.as_bytes(), 2, "use configgen"),
        (&["fit", "--knots", &knots, "--degree", "3"], plane.as_bytes(), 2, "with configgen"),
        (&["fit", "--knots", &knots, "--tol", "1"], b"", 2, "cannot be used with"),
        (&["fit", "--knots", "-"], b"", 2, "points and --knots cannot both come from stdin"),
        (&["fit", "--knots", &line], plane.as_bytes(), 2, "line.txt: 4 points on one line"),
        (
            &["fit", "--knots", &far, "--lambda", "0"],
            b"-5 -5 1\n",
            2,
            "none of 1 observations is in the domain",
        ),
        (
            &["fit", "--knots", &knots, "--interpolate", "--lambda", "1"],
            plane.as_bytes(),
            2,
            "leave out --interpolate",
        ),
        (&["fit", "--knots", &knots, "--weights", &pairs], plane.as_bytes(), 3, "expected one weight"),
        (&["fit", "--rejected", "x.txt"], b"", 2, "--robust"),
        (&["fit", "-o", "/no/such/folder/x.spm"], b"", 1, "/no/such/folder"),
        (&["eval", &knots], b"", 2, "these are points, expected a spline"),
        (&["eval", "-", "--at", "-"], b"", 2, "the spline and --at cannot both come from stdin"),
        (&["eval", "-", "--at", &knots, "--step", "1"], b"", 2, "cannot be used with"),
        (&[], b"", 2, "Usage"),
    ];
    for (arguments, input, code, part) in cases {
        let (found, message) = outcome(&run("splinefit", arguments, input));
        assert_eq!(found, Some(code), "{arguments:?}: {message}");
        assert!(message.contains(part) && !message.contains("panicked"), "{arguments:?}: {message}");
    }
}

#[test]
fn splines_that_cannot_be_evaluated_are_refused() {
    let folder = Folder::new();
    let knots = folder.write("knots.txt", knots());
    let set = run("configgen", &[&knots], &[]).stdout;
    let spline = output(&["fit"], points(500, 1, plane).as_bytes());
    let cases: [(&[&str], &[u8], i32, &str); 8] = [
        (&["eval", "-"], &set, 2, "configurations without coefficients"),
        (&["eval", "-", "--kind", "gradient", "--format", "tif"], &spline, 2, "take .npy or --format text"),
        (&["eval", "-", "--cog"], &spline, 2, "--cog and --no-data are for rasters"),
        (&["eval", "-", "--step", "-1"], &spline, 2, "must be finite and above zero"),
        (&["eval", "-", "--step", "0"], &spline, 2, "must be finite and above zero"),
        (&["eval", "-", "--step", "1e-12"], &spline, 2, "take larger cells"),
        (&["eval", "-", "--bounds", "3,0,1,1"], &spline, 2, "bounds 3,0,1,1 are empty"),
        (&["fit", "--knots", "-", "--degree", "3", &knots], &set, 2, "no elevation"),
    ];
    for (arguments, input, code, part) in cases {
        let (found, message) = outcome(&run("splinefit", arguments, input));
        assert_eq!(found, Some(code), "{arguments:?}: {message}");
        assert!(message.contains(part) && !message.contains("panicked"), "{arguments:?}: {message}");
    }
    let plane = folder.write("plane.txt", points(500, 1, plane));
    let (code, message) = outcome(&run("splinefit", &["fit", "--knots", "-", "--degree", "4", &plane], &set));
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("stdin: there are no configurations of degree 3"), "{message}");
}

#[test]
fn damaged_splines_are_never_taken() {
    let spline = output(&["fit"], points(400, 1, plane).as_bytes());
    let check = |bytes: &[u8], place: usize, expected: ErrorKind| {
        let (code, message) = outcome(&run("splinefit", &["eval", "-", "--rows", "2"], bytes));
        assert_eq!(code, Some(expected.exit_code().into()), "{place}: {message}");
    };
    for place in (0..spline.len()).step_by(spline.len() / 12) {
        check(&spline[..place], place, ErrorKind::Malformed);
    }
    for place in (9..spline.len()).step_by(spline.len() / 12) {
        let mut damaged = spline.clone();
        damaged[place] ^= 4;
        check(&damaged, place, kind_of_damage(place));
    }
}

#[test]
fn a_failure_leaves_no_file_and_keeps_the_old_one() {
    let folder = Folder::new();
    folder.file("old.spm", "old");
    for name in ["old.spm", "new.spm"] {
        let arguments = ["fit", "-o", &folder.path(name), "--residuals", &folder.path("list.txt")];
        assert_eq!(outcome(&run("splinefit", &arguments, b"0 0 1\n1 1 1\nx")).0, Some(3));
    }
    assert_eq!(fs::read_to_string(folder.path("old.spm")).unwrap(), "old");
    assert_eq!(folder.names(""), ["old.spm"]);
}

#[test]
fn closed_pipes_are_silent() {
    let folder = Folder::new();
    let plane = folder.write("points.txt", points(3_000, 1, plane));
    let spline = folder.path("spline.spm");
    output(&["fit", &plane, "-o", &spline], &[]);
    assert_silent_without_reader("splinefit", &["eval", "-q", &spline]);
    assert_silent_without_reader("splinefit", &["eval", "-q", &spline, "--format", "asc"]);
}

#[test]
fn full_disks_are_errors_with_their_reason() {
    if !std::path::Path::new("/dev/full").exists() {
        skip("there is no /dev/full");
        return;
    }
    let spline = output(&["fit"], points(500, 1, plane).as_bytes());
    let plane = points(500, 1, plane);
    let cases: [(&[&str], &[u8]); 5] = [
        (&["fit", "-o", "/dev/full"], plane.as_bytes()),
        (&["fit", "-o", "/dev/null", "--residuals", "/dev/full"], plane.as_bytes()),
        (&["eval", "-", "-o", "/dev/full"], &spline),
        (&["eval", "-", "-o", "/dev/full", "--format", "asc"], &spline),
        (&["eval", "-", "-o", "/dev/full", "--format", "tif"], &spline),
    ];
    for (arguments, input) in cases {
        let (code, message) = outcome(&run("splinefit", arguments, input));
        assert_eq!(code, Some(1), "{arguments:?}: {message}");
        assert!(message.contains("No space left on device"), "{arguments:?}: {message}");
    }
}
