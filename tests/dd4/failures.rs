//! Wrong usage, points without a volume, damaged input, and outputs that cannot be written.

use std::fs;
use std::io::{Read, Write};
use std::process::{Command, Stdio};

use super::diagram;
use crate::programs::{Folder, assert_silent_without_reader, outcome, run, skip, start, tool};

#[test]
fn points_without_a_volume_say_their_dimension() {
    let corners = ["1 1 1 1", "2 1 1 1", "1 2 1 1", "1 1 2 1", "1 1 1 2"];
    for count in 0..5 {
        let text = format!("x y z t\n{}\n", corners[..count].join("\n"));
        let (code, message) = outcome(&run("dd4", &["-"], text.as_bytes()));
        if count == 0 {
            assert_eq!(code, Some(3), "{message}");
            continue;
        }
        assert_eq!(code, Some(2), "{message}");
        let expected = match count {
            1 => "1 distinct point spans only 0 of 4 dimensions".to_owned(),
            _ => format!("{count} distinct points span only {} of 4 dimensions", count - 1),
        };
        assert!(message.contains(&expected), "{message}");
    }
    diagram(&["-"], corners.join("\n").as_bytes());
    for (grid, dimensions) in [("5x5x5x1", 3), ("1x7x1x7", 2), ("1x1x1x1", 0)] {
        let (code, message) = outcome(&run("dd4", &["--grid", grid], &[]));
        assert_eq!(code, Some(2), "{message}");
        assert!(message.contains(&format!("grid {grid}: ")), "{message}");
        assert!(message.contains(&format!("only {dimensions} of 4 dimensions")), "{message}");
    }
}

#[test]
fn each_failure_has_its_exit_code() {
    let points = run("spfinalize", &["-"], b"1 2 3\n4 5 7\n8 2 1\n3 3 9\n").stdout;
    let whole = diagram(&["--grid", "2x2x2x3"], &[]);
    let cases: [(&[&str], &[u8], i32, &str); 10] = [
        (&[], b"", 2, "no input"),
        (&["no/such/file"], b"", 1, "no/such/file"),
        (&["-"], b"1 2 3 4\n1 2 nan 4\n", 3, "line 2"),
        (&["-"], b"1 2 3 4\n1 2 3\n", 3, "line 2"),
        (&["-"], b"1 2 3 4 5\n1 2 3 3 inf\n", 3, "[1.0, 2.0, 3.0, 3.0]: the value is infinite"),
        (&["--quantum", "0", "-"], b"", 2, "not a number above 0"),
        (&["--grid", "4x4x4x4", "-o", "/no/such/folder/x.spm"], b"", 1, "/no/such/folder"),
        (&["-"], &points, 2, "kind points in 2 dimensions"),
        (&["-"], &whole[..whole.len() - 1], 3, "truncated"),
        (&["-"], &whole[..whole.len() / 2], 3, "stdin: block "),
    ];
    for (arguments, input, code, part) in cases {
        let (found, message) = outcome(&run("dd4", arguments, input));
        assert_eq!(found, Some(code), "{arguments:?}: {message}");
        assert!(message.contains(part) && !message.contains("panicked"), "{arguments:?}: {message}");
    }
}

#[test]
fn a_failure_leaves_no_file_and_keeps_the_old_one() {
    let folder = tempfile::tempdir().unwrap();
    let old = folder.path().join("old.spm");
    fs::write(&old, "old").unwrap();
    for name in ["old.spm", "new.spm"] {
        let path = folder.path().join(name);
        let output = run("dd4", &["-o", path.to_str().unwrap(), "-"], b"1 2 3 4\n1 2 3 5\n");
        assert_eq!(outcome(&output).0, Some(2));
    }
    assert_eq!(fs::read_to_string(&old).unwrap(), "old");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_killed_producer_leaves_no_result() {
    let folder = tempfile::tempdir().unwrap();
    let result = folder.path().join("result.spm");
    let mut producer = start("dd4", &["--grid", "8x8x8x8"], Stdio::null());
    let mut part = vec![0; 50_000];
    producer.stdout.as_mut().unwrap().read_exact(&mut part).unwrap();
    producer.kill().unwrap();
    producer.wait().unwrap();
    let mut consumer = tool("dd4");
    consumer.args(["-o", result.to_str().unwrap(), "-"]).stdin(Stdio::piped());
    let mut consumer = consumer.spawn().unwrap();
    consumer.stdin.take().unwrap().write_all(&part).unwrap();
    let (code, message) = outcome(&consumer.wait_with_output().unwrap());
    assert_eq!(code, Some(3), "{message}");
    assert!(message.contains("truncated"), "{message}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    let (code, message) = outcome(&run("spinfo", &["--audit", "-"], &part));
    assert_eq!(code, Some(3), "{message}");
}

#[test]
fn a_closed_pipe_is_silent() {
    assert_silent_without_reader("dd4", &["--grid", "12x12x12x8"]);
}

#[test]
fn a_full_disk_is_an_error_with_its_reason() {
    if !std::path::Path::new("/dev/full").exists() {
        skip("there is no /dev/full");
        return;
    }
    let (code, message) = outcome(&run("dd4", &["--grid", "4x4x4x4", "-o", "/dev/full"], &[]));
    assert_eq!(code, Some(1), "{message}");
    assert!(message.contains("No space left on device"), "{message}");
}

#[test]
fn too_little_memory_has_its_exit_code() {
    let dd4 = env!("CARGO_BIN_EXE_dd4");
    // The first diagram needs more than its least estimate, the second one cannot be begun.
    for (grid, part) in [
        ("21x21x21x21", "dd4: not enough memory: give --memory, or take fewer points"),
        ("21x21x21x21 --memory 2G", "dd4: not enough memory: give less --memory, or take fewer points"),
        (
            "30x30x30x30",
            "grid 30x30x30x30: not enough memory: the diagram of 810000 points takes at least 541 MiB",
        ),
    ] {
        // `ulimit -v` counts address space in units of 1024 bytes, including pages that are never used.
        let limited = format!("ulimit -v 150000 || exit 99; exec '{dd4}' --grid {grid} -o /dev/null");
        let mut shell = Command::new("sh");
        let output = shell.args(["-c", &limited]).env("RUST_BACKTRACE", "0").output().unwrap();
        let (code, message) = outcome(&output);
        if code == Some(99) {
            skip("memory cannot be limited here");
            return;
        }
        assert_eq!(code, Some(5), "{message}");
        // Other systems do not tell their memory beforehand.
        let is_early = !cfg!(target_os = "linux") || message.contains(part);
        assert!(is_early && message.contains("not enough memory"), "{message}");
    }
}

#[test]
fn selections_that_do_not_fit_the_memory_are_refused_before_the_work() {
    let folder = Folder::new();
    let volume = folder.write("volume.raw", vec![0; 4 * 810_000]);
    let dd4 = env!("CARGO_BIN_EXE_dd4");
    // Only the condition tells how many points are selected: all, half of them, and few.
    for (condition, code) in [("value >= 0", 5), ("x < 15", 5), ("t < 2 and z < 2 and x < 5 and y < 5", 0)] {
        let limited = format!(
            "ulimit -v 100000 || exit 99; exec '{dd4}' '{volume}' --raw 30x30x30x30:f32le --where '{condition}' -o /dev/null"
        );
        let output = Command::new("sh").args(["-c", &limited]).env("RUST_BACKTRACE", "0").output().unwrap();
        let (found, message) = outcome(&output);
        if found == Some(99) || !cfg!(target_os = "linux") {
            skip("memory cannot be limited here, or is not told");
            return;
        }
        let early = "the diagram of 146286 points takes at least 98 MiB, there are 98";
        assert!(found == Some(code) && (code == 0 || message.contains(early)), "{condition}: {message}");
    }
}
