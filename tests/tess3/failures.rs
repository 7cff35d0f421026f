//! Wrong usage, damaged input, and outputs that cannot be written.

use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;

use super::molecules::{cloud, pdb};
use crate::programs::{Folder, assert_silent_without_reader, cloud as scattered, outcome, run, tool};

#[test]
fn wrong_usage_says_what_would_be_right() {
    let folder = Folder::new();
    let file = folder.write("a.pdb", pdb(&cloud(10, 9_000, 1)));
    let other = folder.write("b.pdb", pdb(&cloud(10, 9_000, 1)));
    let out = folder.path("out");
    let cases: [(&[&str], &str); 12] = [
        (&[], "no input"),
        (&[&file, &other], "--out-dir"),
        (&["--out-dir", &out], "--lof"),
        (&["--out-dir", &out, "-o", "x", &file], "--out-dir"),
        (&["--resume", &file], "--out-dir"),
        (&["--out-dir", &out, "--resume", "--summary", "-", &file], "--summary"),
        (&["--out-dir", &out, "--lof", "-", "-"], "stdin"),
        (&["--strict", "--keep-going", "--out-dir", &out, &file], "--keep-going"),
        (&["--table", "--contacts", &file], "--contacts"),
        (&["--model", "one", &file], "neither the number of a model, FIRST..LAST, nor all"),
        (&["--hetatm", "maybe", &file], "on"),
        (&["--out-dir", &out, "--threads", "0", &file], "0"),
    ];
    for (arguments, word) in cases {
        let (code, message) = outcome(&run("tess3", arguments, &[]));
        assert_eq!(code, Some(2), "{arguments:?}: {message}");
        assert!(message.contains(word), "{arguments:?}: {message}");
    }
    assert!(!fs::exists(&out).unwrap());
}

#[test]
fn damaged_input_is_named_and_leaves_nothing() {
    let folder = Folder::new();
    let good = pdb(&cloud(10, 9_000, 1));
    let cases = [
        ("bad.pdb", good.replacen("A  10       ", "A  10    x  ", 1), 3),
        ("empty.pdb", String::new(), 3),
        ("header.pdb", "HEADER    NOTHING\nEND\n".into(), 3),
        ("words.txt", "not a structure\n".into(), 3),
    ];
    for (name, text, expected) in cases {
        let file = folder.write(name, text);
        for product in [&[][..], &["--table"]] {
            let output = folder.path("result");
            let (code, message) = outcome(&run("tess3", &[product, &["-o", &output, &file]].concat(), &[]));
            assert_eq!(code, Some(expected), "{message}");
            assert!(message.contains(name) && !message.contains("panicked"), "{message}");
            assert!(!fs::exists(&output).unwrap());
        }
    }
    let (code, message) = outcome(&run("tess3", &["--from", "off", "-"], b"1 2 3\n"));
    assert_eq!(code, Some(3));
    assert!(message.contains("OFF") && message.contains("line 1"), "{message}");
    let (code, message) = outcome(&run("tess3", &["no/such/file.pdb"], &[]));
    assert_eq!(code, Some(1));
    assert!(message.contains("no/such/file.pdb"), "{message}");
}

#[test]
fn a_closed_pipe_is_silent() {
    let folder = Folder::new();
    let file = folder.write("a.xyz", scattered(60_000));
    for product in ["--table", "--contacts", "--alpha=100"] {
        assert_silent_without_reader("tess3", &["-q", product, &file]);
    }
}

#[test]
fn a_summary_that_nobody_reads_ends_the_sweep_silently() {
    let folder = Folder::new();
    let files: Vec<String> =
        (0..40).map(|i| folder.write(&format!("{i}.pdb"), pdb(&cloud(400, 60_000, i)))).collect();
    let out = folder.path("out");
    let mut arguments = vec!["--out-dir", &out[..], "--summary", "-", "--threads", "2"];
    arguments.extend(files.iter().map(String::as_str));
    assert_silent_without_reader("tess3", &arguments);
}

#[test]
fn a_full_disk_is_an_error_with_its_reason() {
    let text = pdb(&cloud(300, 9_000, 1));
    let folder = Folder::new();
    let out = folder.path("out");
    let file = folder.write("a.pdb", &text);
    let cases: [&[&str]; 4] = [
        &["-o", "/dev/full", "-"],
        &["--table", "-o", "/dev/full", "-"],
        &["--contacts", "-o", "/dev/full", "-"],
        &["--out-dir", &out, "--summary", "/dev/full", &file],
    ];
    for arguments in cases {
        let (code, message) = outcome(&run("tess3", arguments, text.as_bytes()));
        assert_eq!(code, Some(1), "{arguments:?}: {message}");
        assert!(message.contains("No space left on device"), "{arguments:?}: {message}");
    }
}

#[test]
fn outputs_that_cannot_be_made_are_failures_of_their_files() {
    let folder = Folder::new();
    let file = folder.write("a.pdb", pdb(&cloud(10, 9_000, 1)));
    let in_the_way = folder.write("out", "a file");
    let (code, message) = outcome(&run("tess3", &["--out-dir", &in_the_way, &file], &[]));
    assert_eq!(code, Some(1), "{message}");
    assert!(message.contains("out"), "{message}");
    // The mesh of a stream of points would be written in place of the stream.
    let points =
        folder.write("points.spm", run("spfinalize", &["-"], b"1 2 3\n4 5 7\n8 2 1\n3 3 9\n").stdout);
    let before = fs::read(&points).unwrap();
    let (code, message) = outcome(&run("tess3", &["--out-dir", &folder.path(""), &points], &[]));
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("would replace") && message.contains("points.spm"), "{message}");
    assert_eq!(fs::read(&points).unwrap(), before);
}

#[test]
fn other_files_are_no_summaries() {
    let folder = Folder::new();
    let file = folder.write("a.pdb", pdb(&cloud(10, 9_000, 1)));
    let other = folder.write("notes.txt", "dear diary\n");
    let arguments = ["--out-dir", &folder.path("out"), "--resume", "--summary", &other, &file];
    let (code, message) = outcome(&run("tess3", &arguments, &[]));
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("notes.txt") && message.contains("not a summary"), "{message}");
    assert_eq!(fs::read_to_string(&other).unwrap(), "dear diary\n");
}

#[test]
fn statistics_are_text_or_json() {
    let text = pdb(&cloud(100, 9_000, 1));
    let output = run("tess3", &["--stats=json", "-o", "/dev/null", "-"], text.as_bytes());
    let (code, message) = outcome(&output);
    assert_eq!(code, Some(0), "{message}");
    let stats: serde_json::Value = serde_json::from_str(&message).unwrap();
    assert_eq!(stats["points"], 100);
    assert!(stats["tetrahedra"].as_u64().unwrap() > 300);
    assert!(stats["seconds"].as_f64().unwrap() > 0.0);
    let (_, message) = outcome(&run("tess3", &["--stats", "-o", "/dev/null", "-"], text.as_bytes()));
    assert!(message.contains("tetrahedra"), "{message}");
    assert!(message.lines().all(|line| line.len() <= 60), "{message}");
}

#[test]
fn names_that_are_no_text_stand_for_no_other_file() {
    let folder = Folder::new();
    // The first name is written as the second one.
    let names = [OsStr::from_bytes(b"u\xff.xyz"), OsStr::new("u\u{fffd}.xyz")];
    for (name, height) in names.into_iter().zip([1, 2]) {
        let atoms = format!("0 0 0\n4 0 0\n0 4 0\n0 0 {height}\n");
        fs::write(Path::new(&folder.path("")).join(name), atoms).unwrap();
    }
    let sweep = |names: &[&OsStr]| {
        let mut tess3 = tool("tess3");
        tess3.current_dir(folder.path("")).args(["--out-dir", "out", "--resume"]).args(names);
        let output = tess3.output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{:?}", outcome(&output));
    };
    sweep(&names[..1]);
    sweep(&names[1..]);
    let output = Path::new(&folder.path("out")).join(OsStr::from_bytes(b"u\xff.spm"));
    let first = fs::read(&output).unwrap();
    fs::remove_file(&output).unwrap();
    sweep(&names);
    assert_eq!(fs::read(&output).unwrap(), first, "its output is not that of the other file");
}
