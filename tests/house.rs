//! Rules of the project: which crate may use which crates and packages, and how large files and documents may
//! become.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Crates of the workspace that each crate of `src` may use.
const ARROWS: [(&str, &[&str]); 15] = [
    // What other Rust programs depend on.
    ("delaunay", &[]),
    ("base", &[]),
    ("stream", &["base"]),
    // The audit would not be independent if it shared code with the kernels that it checks.
    ("audit", &["stream", "base"]),
    ("formats", &["stream", "base"]),
    ("configurations", &["delaunay", "stream", "base"]),
    ("shell", &["formats", "stream", "base"]),
    ("pipeline", &["audit", "delaunay", "formats", "shell", "stream", "base"]),
    ("terrain", &["pipeline", "delaunay", "formats", "shell", "stream", "base"]),
    ("molecules", &["delaunay", "formats", "shell", "stream", "base"]),
    ("spacetime", &["delaunay", "formats", "shell", "stream", "base"]),
    ("splines", &["configurations", "view", "delaunay", "formats", "shell", "stream", "base"]),
    ("view", &["configurations", "delaunay", "formats", "shell", "stream", "base"]),
    ("convert", &["formats", "shell", "stream", "base"]),
    ("python", &["delaunay", "stream"]),
];

/// Packages that only the shell and command lines may use, which are behind the feature `flags`.
const OF_COMMAND_LINES: [&str; 2] = ["clap", "anyhow"];

/// Packages that only one crate may use, so that a library user does not pay for them.
const PACKAGES: [(&str, &str); 6] = [
    ("epsg-utils", "formats"),
    ("faer", "splines"),
    ("laz", "formats"),
    ("proj4rs", "terrain"),
    ("tiny-skia", "view"),
    ("zstd", "stream"),
];

/// Most lines of a source file.
const LINES_MAX: usize = 450;
/// Extensions of source files.
const SOURCES: [&str; 4] = ["rs", "js", "css", "html"];

/// Documents of limited length. Units: bytes.
const DOCUMENTS: [(&str, u64); 2] = [("README.md", 10_000), ("ARCHITECTURE.md", 12_000)];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The files below a folder, as paths from the root of the tree.
fn files(folder: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                found.push(path.strip_prefix(root()).unwrap().to_path_buf());
            }
        }
    }
    found.sort_unstable();
    found
}

/// The manifests of the crates of `src` by name, without the prefix `spmesh-`.
fn manifests() -> BTreeMap<String, String> {
    let manifests = files("src").into_iter().filter(|path| path.ends_with("Cargo.toml"));
    manifests
        .map(|path| {
            let text = fs::read_to_string(root().join(&path)).unwrap();
            let name = text.lines().find_map(|line| line.strip_prefix("name = \"spmesh-")).unwrap();
            (name.trim_end_matches('"').to_string(), text)
        })
        .collect()
}

/// The names of dependencies in a manifest, those of tests left out.
fn dependencies(manifest: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut is_inside = false;
    for line in manifest.lines().map(str::trim) {
        if let Some(table) = line.strip_prefix('[') {
            let table = table.trim_end_matches(']');
            // A separate table for one dependency: `[dependencies.name]`.
            found.extend(table.strip_prefix("dependencies.").map(str::to_string));
            is_inside = table == "dependencies" || table.ends_with(".dependencies");
        } else if is_inside && !line.is_empty() && !line.starts_with('#') {
            found.push(line.split(['.', '=', ' ']).next().unwrap().to_string());
        }
    }
    found
}

#[test]
fn crates_use_only_the_crates_below_them() {
    let manifests = manifests();
    let arrows = BTreeMap::from(ARROWS);
    assert!(manifests.keys().eq(arrows.keys().copied()), "a crate is not in the table, or does not exist");
    let mut wrong = Vec::new();
    for (name, manifest) in &manifests {
        let used = dependencies(manifest);
        let used = used.iter().filter_map(|package| package.strip_prefix("spmesh-"));
        let used = used.filter(|used| !arrows[name.as_str()].contains(used));
        wrong.extend(used.map(|used| format!("{name} -> {used}")));
    }
    assert!(wrong.is_empty(), "arrows that lead up or across: {wrong:?}");
}

#[test]
fn heavy_packages_stay_in_one_crate() {
    for (name, manifest) in manifests() {
        for (package, owner) in PACKAGES {
            let uses = dependencies(&manifest).iter().any(|used| used == package);
            assert!(name == owner || !uses, "{name} uses {package}, which only {owner} may");
        }
    }
}

/// So `scripts/test` checks one program without GeoPackages, not all.
#[test]
fn only_formats_know_of_geopackages() {
    for path in files("src").into_iter().filter(|path| path.extension().is_some_and(|ending| ending == "rs"))
    {
        let knows = fs::read_to_string(root().join(&path)).unwrap().contains("\"geopackage\"");
        assert!(!knows || path.starts_with("src/formats"), "{} knows of GeoPackages", path.display());
    }
}

/// A Rust program uses the engine of a product without its command line.
#[test]
fn command_lines_can_be_left_out() {
    for (name, manifest) in manifests().iter().filter(|(name, _)| *name != "shell") {
        for package in OF_COMMAND_LINES.iter().chain(&["spmesh-shell"]) {
            let can_be_left_out = !dependencies(manifest).iter().any(|used| used == package)
                || manifest.contains(&format!("\n{package} = {{ workspace = true, optional = true }}\n"));
            assert!(can_be_left_out, "{name} always uses {package}");
        }
    }
}

#[test]
fn source_files_hold_one_idea() {
    let mut wrong = Vec::new();
    for path in files("src") {
        let is_source = path.extension().is_some_and(|extension| SOURCES.iter().any(|end| extension == *end));
        if !is_source {
            continue;
        }
        let lines = fs::read_to_string(root().join(&path)).unwrap().lines().count();
        if lines > LINES_MAX {
            wrong.push(format!("{}: {lines} lines", path.display()));
        }
    }
    assert!(wrong.is_empty(), "files above {LINES_MAX} lines: {wrong:?}");
}

#[test]
fn documents_at_the_root_are_short() {
    for (name, bytes_max) in DOCUMENTS {
        let bytes = fs::metadata(root().join(name)).unwrap().len();
        assert!(bytes <= bytes_max, "{name} has {bytes} bytes, at most {bytes_max} are allowed");
    }
}

#[test]
fn dependencies_are_read_from_manifests() {
    let manifest = "[package]\nname = \"x\"\n[dependencies]\na.workspace = true\n# no\nb = { version = \"1\" }\n\
                    [dev-dependencies]\nc = \"1\"\n[dependencies.d]\nversion = \"1\"\n";
    assert_eq!(dependencies(manifest), ["a", "b", "d"]);
}
