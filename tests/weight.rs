//! What the project weighs, beside `tests/weight.tsv`: foreign crates and lines.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::process::Command;

use crate::programs::skip;

/// A number is out of date where the project has become lighter than this part of it.
const SLACK: f64 = 0.95;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The rows of a kind: names, and the most of each.
fn limits(kind: &str) -> BTreeMap<String, usize> {
    let text = fs::read_to_string(root().join("tests/weight.tsv")).unwrap();
    let rows = text.lines().filter(|line| !line.starts_with('#')).map(|line| {
        let fields: Vec<&str> = line.split('\t').collect();
        assert_eq!(fields.len(), 3, "three fields between tabs: {line}");
        (fields[0].to_string(), fields[1].to_string(), fields[2].parse().unwrap())
    });
    let limits: BTreeMap<String, usize> =
        rows.filter(|(of, ..)| of == kind).map(|(_, name, most)| (name, most)).collect();
    assert!(!limits.is_empty(), "no row of {kind}");
    limits
}

/// What differs between the table and the project: what is heavier, much lighter, missing, or gone.
fn differences(limits: &BTreeMap<String, usize>, found: &BTreeMap<String, usize>) -> Vec<String> {
    let mut wrong = Vec::new();
    for name in limits.keys().chain(found.keys()).collect::<BTreeSet<_>>() {
        match (limits.get(name), found.get(name)) {
            (Some(&most), Some(&count)) if count > most => {
                wrong.push(format!("{name}: {count}, at most {most}"))
            }
            (Some(&most), Some(&count)) if (count as f64) < SLACK * most as f64 => {
                wrong.push(format!("{name}: {count}, but the table allows {most}: lower it"));
            }
            (Some(_), Some(_)) => {}
            (limit, count) => wrong.push(format!("{name}: {count:?}, in the table {limit:?}")),
        }
    }
    wrong
}

/// Packages with their features that a build of the root package takes from elsewhere, besides those of
/// tests. Each line is `NAME vVERSION|FEATURES`. Without cargo, prints a note and returns none.
pub fn foreign(flags: &[&str]) -> Option<BTreeSet<String>> {
    let shape =
        ["--offline", "--locked", "--edges", "normal,build", "--prefix", "none", "--format", "{p}|{f}"];
    let Ok(tree) =
        Command::new(env!("CARGO")).arg("tree").args(shape).args(flags).current_dir(root()).output()
    else {
        skip("cargo cannot be run, so dependencies were not counted");
        return None;
    };
    assert!(tree.status.success(), "{}", String::from_utf8_lossy(&tree.stderr));
    let text = String::from_utf8(tree.stdout).unwrap();
    // Packages of the workspace have their folders in parentheses; those seen before have a star.
    let lines = text.lines().map(|line| line.trim_end_matches(" (*)").to_string());
    Some(lines.filter(|line| !line.is_empty() && !line.contains(" (/")).collect())
}

fn names(packages: &BTreeSet<String>) -> BTreeSet<&str> {
    packages.iter().map(|package| package.split('|').next().unwrap()).collect()
}

/// Rust and the pages of `spview`, in each folder of `src`, and in the tests.
fn lines() -> BTreeMap<String, usize> {
    let mut found = BTreeMap::new();
    let mut add = |name: String, folder: &Path| {
        let count = count_lines(folder);
        if count > 0 {
            found.insert(name, count);
        }
    };
    for entry in fs::read_dir(root().join("src")).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            add(format!("src/{}", path.file_name().unwrap().display()), &path);
        }
    }
    add("tests".to_string(), &root().join("tests"));
    add("scripts/examples".to_string(), &root().join("scripts/examples"));
    found
}

fn count_lines(path: &Path) -> usize {
    if path.is_dir() {
        return fs::read_dir(path).unwrap().map(|entry| count_lines(&entry.unwrap().path())).sum();
    }
    let is_source = path
        .extension()
        .is_some_and(|ending| ["rs", "js", "css", "html"].map(AsRef::as_ref).contains(&ending));
    if is_source { fs::read_to_string(path).unwrap().lines().count() } else { 0 }
}

#[test]
fn foreign_crates_are_those_of_the_table() {
    let builds = [("all programs", &[][..]), ("library", &["--no-default-features"])];
    let mut found = BTreeMap::new();
    for (name, flags) in builds {
        let Some(packages) = foreign(flags) else { return };
        found.insert(name.to_string(), names(&packages).len());
    }
    let wrong = differences(&limits("crates"), &found);
    assert!(wrong.is_empty(), "foreign crates: {wrong:#?}");
}

#[test]
fn lines_are_those_of_the_table() {
    let wrong = differences(&limits("lines"), &lines());
    assert!(wrong.is_empty(), "lines: {wrong:#?}");
}

#[test]
fn what_is_heavier_lighter_missing_or_gone_is_told() {
    let table =
        |rows: &[(&str, usize)]| rows.iter().map(|&(name, count)| (name.to_string(), count)).collect();
    let limits = table(&[("a", 100), ("b", 100), ("c", 100), ("d", 100)]);
    assert!(differences(&limits, &limits).is_empty());
    let found = table(&[("a", 101), ("b", 94), ("c", 95), ("e", 1)]);
    let wrong = differences(&limits, &found);
    let starts = ["a: 101", "b: 94", "d: None", "e: Some(1)"];
    assert!(
        wrong.len() == 4 && wrong.iter().zip(starts).all(|(line, start)| line.starts_with(start)),
        "{wrong:?}"
    );
}
