//! What is refused, and what a failure leaves.

use crate::programs::{Folder, outcome, run, sample};

#[test]
fn wrong_usage_is_refused() {
    let folder = Folder::new();
    let tile = sample("autzen.laz");
    let out = folder.path("out.laz");
    for (arguments, word) in [
        (&["-o", &out][..], "no input"),
        (&["-", "-o", &out], "pipe"),
        (&[&tile, "-o", &folder.path("out.spm"), "--format", "las"], "--format"),
        (&[&tile, &tile, "-o", &out], "--out-dir"),
        (&[&tile, "-o", &out, "--cell", "0"], "--cell"),
        (&[&tile, "-o", &out, "--cell", "nan"], "--cell"),
        (&[&tile, "-o", &out, "--window", "-3"], "--window"),
        (&[&tile, "-o", &out, "--window", "300"], "256 cells"),
        (&[&tile, "-o", &out, "--slope", "inf"], "--slope"),
        (&[&tile, "-o", &out, "--cell", "1e300"], "--cell"),
        (&[&tile, "-o", &out, "--noise-gap", "-1"], "--noise-gap"),
        (&[&tile, "-o", &out, "--rise", "nan"], "--rise"),
        (&[&tile, "-o", &folder.path("out.tif")], "out.tif"),
        (&["/dev/zero", "-o", &out], "pipe"),
        (&[&tile, "-o", &out, "--summary", &folder.path("summary.tsv")], "go with --out-dir"),
        (&[&tile, "-o", &out, "--resume"], "go with --out-dir"),
        (&[&tile, "-o", &folder.path("out.spm"), "--keep-going"], "go with --out-dir"),
    ] {
        let (code, message) = outcome(&run("spground", arguments, &[]));
        assert!(code == Some(2) && message.contains(word), "{arguments:?}: {message}");
    }
    let heights = ["--ground", "none.spm", &tile, "-o", &out, "--resume"];
    let (code, message) = outcome(&run("spheight", &heights, &[]));
    assert!(code == Some(2) && message.contains("go with --out-dir"), "{message}");
    let (code, message) = outcome(&run("spground", &[&tile, "-o", &out, "--memory", "20M"], &[]));
    assert!(code == Some(5) && message.contains("--memory"), "{message}");
    assert!(folder.names("").is_empty());
}

/// Hours of work are not lost for a folder that is not there.
#[test]
fn outputs_are_checked_before_the_work() {
    let folder = Folder::new();
    let tile = sample("autzen.laz");
    let missing = folder.path("missing/out.laz");
    let (code, message) = outcome(&run("spground", &[&tile, "-o", &missing], &[]));
    assert!(code == Some(1) && message.contains("missing"), "{message}");
    let out = folder.path("out.laz");
    let (code, message) =
        outcome(&run("spground", &[&tile, "-o", &out, "--temp-dir", &folder.path("none")], &[]));
    assert!(code == Some(1) && message.contains("none"), "{message}");
    assert!(folder.names("").is_empty());
}

/// Presets fit the memory that is given by default.
#[test]
fn presets_have_memory() {
    let folder = Folder::new();
    for preset in ["flat", "urban", "forest", "mountain"] {
        let out = folder.path("out.laz");
        let done = run("spground", &[&sample("lareunion.laz"), "-o", &out, "--preset", preset], &[]);
        assert!(done.status.success(), "{preset}: {:?}", outcome(&done));
    }
}

#[test]
fn a_bad_file_leaves_no_outputs() {
    let folder = Folder::new();
    let bytes = std::fs::read(sample("lareunion.laz")).unwrap();
    let bad = folder.write("bad.laz", &bytes[..bytes.len() / 2]);
    let out = folder.path("out");
    let (code, message) = outcome(&run("spground", &[&sample("autzen.laz"), &bad, "--out-dir", &out], &[]));
    assert!(code == Some(3) && message.contains("bad.laz"), "{message}");
    assert!(folder.names("out").is_empty());
}

#[test]
fn inputs_are_not_replaced() {
    let folder = Folder::new();
    let bytes = std::fs::read(sample("autzen.laz")).unwrap();
    let input = folder.write("in.laz", &bytes);
    for arguments in [&[&input, "-o", &input][..], &[&input, "--out-dir", &folder.path("")]] {
        let (code, message) = outcome(&run("spground", arguments, &[]));
        assert_eq!(code, Some(2), "{message}");
        assert!(std::fs::read(&input).unwrap() == bytes);
    }
    let report = run("spground", &[&input, "-o", &folder.path("out.laz"), "--report", &input], &[]);
    assert_eq!(outcome(&report).0, Some(2));
    assert!(std::fs::read(&input).unwrap() == bytes);
}
