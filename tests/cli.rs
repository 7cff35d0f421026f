//! Command lines: help, versions, exit codes, and the README's table of tools.

use std::fs;
use std::path::Path;

use crate::programs::{Folder, outcome, run, sample};

const TOOLS: [&str; 19] = [
    "spfinalize",
    "spdelaunay2d",
    "spdelaunay3d",
    "spdem",
    "spconstrain",
    "spground",
    "spheight",
    "spreport",
    "spdiff",
    "spsimplify",
    "spnode",
    "spcanopy",
    "spview",
    "tess3",
    "dd4",
    "configgen",
    "splinefit",
    "spinfo",
    "spconvert",
];

#[test]
fn every_tool_has_help_with_examples_and_a_version() {
    for name in TOOLS {
        let help = run(name, &["--help"], &[]);
        let text = String::from_utf8(help.stdout.clone()).unwrap();
        assert!(help.status.success() && text.contains("Examples:"), "{name}: {text}");
        let version = run(name, &["--version"], &[]);
        assert_eq!(
            String::from_utf8(version.stdout).unwrap(),
            format!("{name} {}\n", env!("CARGO_PKG_VERSION"))
        );
        assert_eq!(outcome(&run(name, &["--no-such-flag"], &[])).0, Some(2), "{name}");
    }
}

/// A heading holds for all flags after it, those of a flattened struct too.
#[test]
fn common_flags_stand_before_headings_of_others() {
    for name in TOOLS {
        let text = String::from_utf8(run(name, &["--help"], &[]).stdout).unwrap();
        let headings = text.lines().filter(|line| line.ends_with(':') && !line.starts_with(' '));
        let other = headings.skip_while(|line| *line != "Options:").nth(1).unwrap();
        let quiet = text.find("-q, --quiet");
        assert!(quiet.is_none_or(|at| at < text.find(&format!("\n{other}\n")).unwrap()), "{name}: {other}");
    }
}

#[test]
fn examples_are_indented_and_paragraphs_are_wrapped_once() {
    for name in TOOLS {
        let text = String::from_utf8(run(name, &["--help"], &[]).stdout).unwrap();
        let (_, end) = text.split_once("Examples:\n").unwrap();
        let (examples, notes) = end.split_once("\n\n").unwrap();
        assert!(examples.lines().all(|line| line.starts_with("  ")), "{name}: {examples}");
        // A line break inside a paragraph would become a short line when clap wraps the text.
        for paragraph in notes.trim().split("\n\n") {
            let lines: Vec<&str> = paragraph.lines().collect();
            let short = lines[..lines.len() - 1].iter().find(|line| line.len() < 60);
            assert_eq!(short, None, "{name}: {paragraph}");
        }
    }
}

#[test]
fn readme_manifest_and_bin_name_the_same_tools() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut programs: Vec<String> = fs::read_dir(root.join("bin"))
        .unwrap()
        .map(|entry| entry.unwrap().path().file_stem().unwrap().to_str().unwrap().to_string())
        .collect();
    programs.sort_unstable();
    let quoted = |line: &str| line.split('"').nth(1).unwrap_or_default().to_string();
    let manifest = fs::read_to_string(root.join("Cargo.toml")).unwrap();
    let mut in_manifest: Vec<String> = manifest
        .split("[[bin]]")
        .skip(1)
        .map(|table| quoted(table.lines().find(|line| line.starts_with("name")).unwrap()))
        .collect();
    in_manifest.sort_unstable();
    let readme = fs::read_to_string(root.join("README.md")).unwrap();
    let table = readme.split("## Tools").nth(1).unwrap().split("\n## ").next().unwrap();
    let rows = table.lines().filter_map(|line| line.strip_prefix("| `")?.split('`').next());
    let mut in_readme: Vec<String> = rows.map(str::to_string).collect();
    in_readme.sort_unstable();
    let mut here: Vec<String> = TOOLS.map(str::to_string).to_vec();
    here.sort_unstable();
    assert_eq!(programs, in_manifest);
    assert_eq!(programs, in_readme);
    assert_eq!(programs, here);
}

#[test]
fn few_points_are_a_valid_mesh_with_a_warning() {
    let inputs = [
        "# a header, and no points\n",
        "1 2 3\n",
        "1 2 3\n4 5 6\n",
        "0 0 0\n1 1 0\n2 2 0\n3 3 9\n",
        "5 5 1\n5 5 2\n5 5 3\n",
    ];
    for input in inputs {
        let points = run("spfinalize", &["-"], input.as_bytes());
        assert!(points.status.success(), "{input:?}: {:?}", outcome(&points));
        let mesh = run("spdelaunay2d", &[], &points.stdout);
        let (code, message) = outcome(&mesh);
        assert_eq!(code, Some(0), "{input:?}: {message}");
        assert!(message.contains("no triangles"), "{input:?}: {message}");
        let audit = run("spinfo", &["--audit", "-"], &mesh.stdout);
        assert!(audit.status.success(), "{input:?}: {:?}", outcome(&audit));
    }
}

#[test]
fn each_failure_has_its_exit_code() {
    let tile = sample("lareunion.laz");
    type Case<'a> = (&'a str, &'a [&'a str], &'a [u8], i32, &'a str);
    let cases: [Case; 16] = [
        ("spfinalize", &["no/such/file.laz"], b"", 1, "no/such/file.laz"),
        ("spfinalize", &["-"], b"1 2 3\n4 x 6\n", 3, "2"),
        ("spfinalize", &["-"], b"1 2 3\nnan 5 6\n", 3, "2"),
        ("spfinalize", &["--level", "99", &tile], b"", 2, "level"),
        ("spfinalize", &["-o", "/no/such/folder/x.spm", &tile], b"", 1, "/no/such/folder"),
        ("spdelaunay2d", &[], b"not a stream at all", 3, "stdin"),
        ("spdelaunay2d", &[], b"", 3, "empty"),
        ("spdelaunay2d", &["--partial"], b"", 2, "--region"),
        ("spdelaunay2d", &["--partial", "--region", "0,0,1"], b"", 2, "four numbers"),
        ("spdelaunay3d", &["--partial"], b"", 2, "part of space"),
        ("spdelaunay3d", &["--partial", "--region", "0,0,1,1"], b"", 2, "six numbers"),
        ("spdelaunay3d", &["--partial", "--region", "0,0,3,1,1,3"], b"", 2, "the box is empty"),
        ("spdelaunay3d", &["--partial", "--cell", "1/0/0"], b"", 2, "LEVEL/COLUMN/ROW/LAYER"),
        ("spdelaunay3d", &["--region", "0,0,0,1,1,1"], b"", 2, "--partial or --merge"),
        ("spdelaunay3d", &["--merge", "--threads", "2"], b"", 2, "--threads"),
        ("spinfo", &["-"], b"\x89SPM\r\n\x1a\n", 3, "stdin"),
    ];
    for (name, arguments, input, code, word) in cases {
        let (found, message) = outcome(&run(name, arguments, input));
        assert_eq!(found, Some(code), "{name} {arguments:?}: {message}");
        assert!(message.contains(word), "{name} {arguments:?}: {message}");
        assert!(!message.contains("panicked"), "{name} {arguments:?}: {message}");
    }
}

/// Nothing is read, and no file is made.
#[test]
fn names_of_other_formats_are_refused() {
    let folder = Folder::new();
    let tools: [(&str, &[&str]); 19] = [
        ("spfinalize", &["-"]),
        ("spdelaunay2d", &[]),
        ("spdelaunay3d", &[]),
        ("spdem", &[]),
        ("spdem", &["--contours", "1"]),
        ("spconstrain", &["--kill", "1"]),
        ("spground", &["none.las"]),
        ("spheight", &["--ground", "none", "none.las"]),
        ("spreport", &["none.las"]),
        ("spdiff", &["none.spm", "--level", "1"]),
        ("spsimplify", &["--tolerance", "1"]),
        ("spnode", &["collect", "none.json", "-d", "."]),
        ("spcanopy", &["--ground", "none", "none.las"]),
        ("spview", &[]),
        ("tess3", &["none.pdb"]),
        ("dd4", &["none.nrrd"]),
        ("configgen", &["--degree", "1", "none.xyz"]),
        ("splinefit", &["fit", "none.xyz"]),
        ("splinefit", &["eval", "none.spm"]),
    ];
    for (tool, arguments) in tools {
        for ending in ["jpg", "vrt", "ZIP"] {
            let path = folder.path(&format!("out.{ending}"));
            let output = run(tool, &[arguments, &["-o", &path]].concat(), &[]);
            let (code, message) = outcome(&output);
            assert!(code == Some(2) && message.contains("out."), "{tool} {ending}: {message}");
        }
    }
    assert!(folder.names("").is_empty());
}
