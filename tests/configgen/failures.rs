//! Wrong usage, knots that do not span, damaged input, and outputs that cannot be written.

use std::fs;

use super::{lines, output, scattered};
use crate::programs::{Folder, assert_silent_without_reader, cloud, kind_of_damage, outcome, run, skip};

const SQUARE: &[u8] = b"0 0\n1 0\n1 1\n0 1\n";

#[test]
fn each_failure_has_its_exit_code() {
    let mesh = output(&["--centroids", "--degree", "1"], &lines(&scattered(1, 500)));
    let points4 = run("dd4", &["--grid", "2x2x2x2"], &[]).stdout;
    let cases: [(&[&str], &[u8], i32, &str); 22] = [
        (&["no/such/file"], b"", 1, "no/such/file"),
        (&[], b"", 3, "stdin: empty"),
        (&[], b"0 0\n1 x\n", 3, "stdin: line 2"),
        (&[], b"0 0\nnan 0\n", 3, "line 2"),
        (&["--degree", "2"], SQUARE, 2, "stdin: degree 2 needs at least 5 knots, there are 4"),
        (&["--degree", "4294967295"], SQUARE, 2, "degree 4294967295 needs"),
        (&["--degree", "4294967295", "--boundary", "clamped"], SQUARE, 2, "more than can be handled"),
        (&["--degree", "-1"], SQUARE, 2, "-1"),
        (&["--degree", "0"], b"0 0\n1 1\n2 2\n5 5\n", 2, "stdin: the knots lie on one line"),
        (&["--degree", "0"], b"3 3\n3 3\n3 3\n", 2, "stdin: the knots lie on one line"),
        (&["--boundary", "clamped"], b"0 0\n1 1\n2 2\n5 5\n", 2, "the knots lie on one line"),
        (&["--pull-apart", "1,4"], SQUARE, 2, "unknown knot 4: there are 4"),
        (&["--rule", "aligned:x"], SQUARE, 2, "no angle"),
        (&["--rule", "convex"], SQUARE, 2, "expected delaunay, "),
        (&["--flip", "random:x"], SQUARE, 2, "not an integer"),
        (&["--rule", "data"], SQUARE, 2, "--values FILE"),
        (&["--rule", "data", "--values", "-"], SQUARE, 2, "both come from stdin"),
        (&["--values", "values.txt"], SQUARE, 2, "--values is for the rules"),
        (
            &["--rule", "lifted:weights"],
            b"0 0 1\n1 0 1\n0 1 1\n0 0 1\n",
            2,
            "does not tell knots at one place apart",
        ),
        (&["--rule", "lifted:heights"], b"0 0 0\n9 0 0\n0 9 0\n2 2 5\n", 2, "knot 3: the lift is not convex"),
        (&[], &mesh[..mesh.len() - 9], 3, "truncated"),
        (&[], &points4, 2, "expected points"),
    ];
    for (arguments, input, code, part) in cases {
        let (found, message) = outcome(&run("configgen", &[&["--centroids"], arguments].concat(), input));
        assert_eq!(found, Some(code), "{arguments:?}: {message}");
        assert!(message.contains(part) && !message.contains("panicked"), "{arguments:?}: {message}");
    }
}

#[test]
fn the_greatest_numbers_are_no_failure() {
    let extreme = b"1e308 1e308\n-1e308 1e308\n1e308 -1e308\n-1e308 -1e308\n0 0\n1e300 5\n";
    let folder = Folder::new();
    let values = folder.write("values.txt", "1e308\n-1e308\n1e308\n-1e308\n3\n0\n");
    let gradients = folder.write("gradients.txt", "1e308 -1e308\n-1e308 1e308\n1e308 0\n0 0\n3 1e308\n0 1\n");
    for rule in ["min-weight", "aligned:17", "random", "ear", "fan", "delaunay"] {
        output(&["--degree", "2", "--rule", rule], extreme);
    }
    for file in [values, gradients] {
        output(&["--degree", "2", "--rule", "data", "--values", &file], extreme);
    }
}

#[test]
fn a_failure_leaves_no_file_and_keeps_the_old_one() {
    let folder = Folder::new();
    folder.file("old.spm", "old");
    for name in ["old.spm", "new.spm"] {
        let failed = run("configgen", &["--centroids", "-o", &folder.path(name)], b"1 2\n2 3\n3 4\n4 5\n");
        assert_eq!(outcome(&failed).0, Some(2));
    }
    assert_eq!(fs::read_to_string(folder.path("old.spm")).unwrap(), "old");
    assert_eq!(folder.names(""), ["old.spm"]);
    output(&["--centroids", "-o", &folder.path("new.spm")], SQUARE);
    assert!(run("spinfo", &[&folder.path("new.spm")], &[]).status.success());
}

#[test]
fn damaged_meshes_are_never_taken() {
    let mesh = output(&["--centroids", "--degree", "1"], &lines(&scattered(9, 60)));
    for cut in (0..mesh.len()).step_by(97) {
        let (code, message) = outcome(&run("configgen", &["--centroids", "-o", "/dev/null"], &mesh[..cut]));
        assert_eq!(code, Some(3), "{cut}: {message}");
    }
    for place in (8..mesh.len()).step_by(211) {
        let mut damaged = mesh.clone();
        damaged[place] ^= 4;
        let (code, message) = outcome(&run("configgen", &["--centroids", "-o", "/dev/null"], &damaged));
        assert_eq!(code, Some(kind_of_damage(place).exit_code().into()), "{place}: {message}");
    }
}

#[test]
fn a_closed_pipe_is_silent() {
    let folder = Folder::new();
    let knots = folder.write("knots.txt", cloud(40_000));
    assert_silent_without_reader("configgen", &["--centroids", "-q", &knots]);
}

#[test]
fn a_full_disk_is_an_error_with_its_reason() {
    if !std::path::Path::new("/dev/full").exists() {
        skip("there is no /dev/full");
        return;
    }
    let (code, message) = outcome(&run("configgen", &["--centroids", "-o", "/dev/full"], SQUARE));
    assert_eq!(code, Some(1), "{message}");
    assert!(message.contains("No space left on device"), "{message}");
}

#[test]
fn a_folder_that_is_not_there_is_known_before_the_work() {
    let arguments = ["--centroids", "-o", "/no/such/folder/x.spm", "/no/such/input"];
    let (code, message) = outcome(&run("configgen", &arguments, &[]));
    assert_eq!(code, Some(1), "{message}");
    assert!(message.contains("/no/such/folder"), "{message}");
}
