//! Rules of the project: which crate may use which, and how large files may become.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Crates of the workspace that each crate of `src` may use. Tools and command lines are listed below.
const ARROWS: [(&str, &[&str]); 13] = [
    ("core", &[]),
    ("model", &["core"]),
    ("stream", &["model", "core"]),
    ("geometry", &["model", "core"]),
    ("geometry4", &["geometry", "model", "core"]),
    ("configurations", &["geometry", "model", "core"]),
    ("crs", &["stream", "core"]),
    ("io", &["crs", "stream", "model", "core"]),
    ("lines", &["io", "crs", "geometry", "stream", "model", "core"]),
    ("splines", &["configurations", "geometry", "model", "core"]),
    // The audit would not be independent if it shared code with the kernels that it checks.
    ("audit", &["stream", "model", "core"]),
    ("view", &["configurations", "io", "crs", "geometry", "stream", "model", "core"]),
    ("shell", &["io", "crs", "stream", "model", "core"]),
];

/// Crates of the workspace that any tool may use. No tool may use another.
const OF_TOOLS: &[&str] = &["io", "crs", "geometry", "stream", "model", "core"];
/// Additional crates, by tool.
const OF_TOOL: [(&str, &[&str]); 4] = [
    ("configgen", &["configurations"]),
    ("constrain", &["lines"]),
    ("dd4", &["geometry4"]),
    ("splinefit", &["configurations", "splines"]),
];

/// The command line that another one may use: terrain takes flags for lines from it.
const SHARED_COMMAND_LINE: (&str, &str) = ("cli-terrain", "cli-pipeline");

/// Packages that only command lines and the shell may use.
const OF_COMMAND_LINES: [&str; 2] = ["clap", "anyhow"];

/// Packages that only one crate may use, so that a library user does not pay for them.
const PACKAGES: [(&str, &str); 5] = [
    ("epsg-utils", "crs"),
    ("faer", "splines"),
    ("parquet", "io"),
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

/// A crate of the workspace: its folder, and its dependencies outside of tests.
struct Member {
    folder: PathBuf,
    dependencies: Vec<String>,
}

impl Member {
    fn is_tool(&self) -> bool {
        self.folder.starts_with("src/tools")
    }

    fn is_command_line(&self) -> bool {
        self.folder.starts_with("src/cli")
    }
}

/// The crates of `src` by name, without the prefix `spmesh-`.
fn members() -> BTreeMap<String, Member> {
    let manifests = files("src").into_iter().filter(|path| path.ends_with("Cargo.toml"));
    manifests
        .map(|path| {
            let text = fs::read_to_string(root().join(&path)).unwrap();
            let folder = path.parent().unwrap().to_path_buf();
            let name = text.lines().find_map(|line| line.strip_prefix("name = \"spmesh-")).unwrap();
            (name.trim_end_matches('"').to_string(), Member { folder, dependencies: dependencies(&text) })
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
    let members = members();
    let arrows = BTreeMap::from(ARROWS);
    let extra = BTreeMap::from(OF_TOOL);
    let mut wrong = Vec::new();
    for (name, member) in &members {
        let allowed = |used: &str| match arrows.get(name.as_str()) {
            Some(crates) => crates.contains(&used),
            // The manuals are those of all programs.
            None if member.is_command_line() => {
                let is_other = members[used].is_command_line() && name != "manuals";
                !is_other || (name.as_str(), used) == SHARED_COMMAND_LINE
            }
            None if member.is_tool() => {
                OF_TOOLS.contains(&used) || extra.get(name.as_str()).is_some_and(|more| more.contains(&used))
            }
            None => panic!("{name} is not in the table of crates"),
        };
        let used = member.dependencies.iter().filter_map(|package| package.strip_prefix("spmesh-"));
        wrong.extend(used.filter(|used| !allowed(used)).map(|used| format!("{name} -> {used}")));
    }
    assert!(wrong.is_empty(), "arrows that lead up or across: {wrong:?}");
    assert!(arrows.keys().all(|name| members.contains_key(*name)), "a crate of the table does not exist");
}

#[test]
fn heavy_packages_stay_in_one_crate() {
    for (name, member) in members() {
        let uses = |package: &str| member.dependencies.iter().any(|used| used == package);
        for (package, owner) in PACKAGES {
            assert!(name == owner || !uses(package), "{name} uses {package}, which only {owner} may");
        }
        let is_shell = name == "shell" || member.is_command_line();
        let used = OF_COMMAND_LINES.iter().find(|package| !is_shell && uses(package));
        assert_eq!(used, None, "{name} uses what only command lines may");
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
