//! Promises of the manifests.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::programs::skip;
use crate::weight::foreign;

/// Packages of this machine's dependency tree, and of the workspace, as `cargo metadata` lists them. Without
/// cargo, prints a note and returns none.
fn packages() -> Vec<Value> {
    // That of the build, with the compiler beside it: PATH may have neither.
    let cargo = Path::new(env!("CARGO"));
    let Ok(version) = Command::new(cargo).arg("-vV").output() else {
        skip("cargo cannot be run, so its metadata was not checked");
        return Vec::new();
    };
    let version = String::from_utf8(version.stdout).expect("text");
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).expect("a host");
    // `--filter-platform`: building the tests has downloaded only the packages of this platform, and nothing
    // is downloaded here but those of the Python package.
    let flags = ["--locked", "--all-features", "--format-version=1", "--filter-platform", host];
    let mut metadata = Command::new(cargo);
    let compiler = cargo.with_file_name("rustc");
    if compiler.exists() {
        metadata.env("RUSTC", compiler);
    }
    let metadata = metadata
        .arg("metadata")
        .args(flags)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs");
    assert!(metadata.status.success(), "{}", String::from_utf8_lossy(&metadata.stderr));
    let metadata: Value = serde_json::from_slice(&metadata.stdout).expect("JSON");
    metadata["packages"].as_array().expect("packages").clone()
}

/// The first two numbers of a version.
fn minor(version: &str) -> (u32, u32) {
    let mut numbers = version.split('.').map(|number| number.parse().expect("a number"));
    (numbers.next().expect("a major version"), numbers.next().unwrap_or(0))
}

#[test]
fn no_dependency_needs_a_newer_compiler() {
    let promised = minor(env!("CARGO_PKG_RUST_VERSION"));
    for package in packages() {
        let Some(needed) = package["rust_version"].as_str() else { continue };
        assert!(minor(needed) <= promised, "{} needs Rust {needed}", package["id"]);
    }
}

/// Otherwise a build of further programs, as in `scripts/quickstart`, compiles the dependencies of the first
/// ones again, and all that uses them.
#[test]
fn further_programs_take_the_same_features_of_dependencies() {
    let of = |features| foreign(&["--no-default-features", "--features", features]);
    let (Some(first), Some(more)) = (of("pipeline"), of("pipeline,terrain,view")) else { return };
    let differing: Vec<&String> = first.difference(&more).collect();
    assert!(
        !first.is_empty() && differing.is_empty(),
        "{differing:?}: see crc32fast in src/formats/Cargo.toml"
    );
}

/// Otherwise tests use other code than the programs, and what tests have compiled is of no use for the
/// builds, checks and planted faults after them.
#[test]
fn tests_take_the_same_features_of_dependencies_as_programs() {
    let of_tests = foreign(&["--workspace", "--exclude", "spmesh-python", "--edges", "dev"]);
    let (Some(programs), Some(tests)) = (foreign(&[]), of_tests) else { return };
    let differing: Vec<&String> = programs.difference(&tests).collect();
    assert!(!programs.is_empty() && differing.is_empty(), "{differing:?}");
    assert!(tests.len() > programs.len(), "the dependencies of tests were left out");
}

#[test]
fn no_example_in_documentation_goes_untested() {
    for package in packages().iter().filter(|package| package["source"].is_null()) {
        for target in package["targets"].as_array().expect("targets") {
            if target["doctest"] == true || target["kind"][0] != "lib" {
                continue;
            }
            let root = Path::new(target["src_path"].as_str().expect("a path"));
            let mut files = Vec::new();
            collect(root.parent().expect("a folder"), &mut files);
            for file in files {
                let text = fs::read_to_string(&file).expect("a source file");
                assert!(
                    !has_example(&text),
                    "{}: remove `doctest = false` from the manifest",
                    file.display()
                );
            }
        }
    }
}

/// Adds the Rust files below a folder, except the files of nested packages.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            if !path.join("Cargo.toml").exists() {
                collect(&path, files);
            }
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}

/// Whether a doc comment has a code block that is not plain text.
fn has_example(text: &str) -> bool {
    let doc = |line: &'_ str| -> Option<String> {
        let line = line.trim_start();
        let rest = line.strip_prefix("///").or_else(|| line.strip_prefix("//!"))?;
        rest.trim_start().strip_prefix("```").map(str::to_string)
    };
    // Every second fence ends a block.
    text.lines().filter_map(doc).step_by(2).any(|language| language.trim() != "text")
}

#[test]
fn examples_are_told_from_text() {
    assert!(has_example("/// A\n/// ```\n/// let a = 1;\n/// ```\nfn a() {}\n"));
    assert!(has_example("    //! ```text\n    //! ```\n    //! ``` rust\n"));
    assert!(!has_example("//! ```text\n//! a b\n//! ```\n// ```\n"));
}
