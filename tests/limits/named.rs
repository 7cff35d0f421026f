//! Each limit is tested.

use std::fs;
use std::path::{Path, PathBuf};

/// The sources below a folder, and what of each is tests: all of it, or what follows the mark of unit tests.
fn tests_below(folder: &Path, is_test: bool, texts: &mut Vec<String>) {
    let mut paths: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    for path in paths {
        if path.is_dir() {
            tests_below(&path, is_test, texts);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            let text = fs::read_to_string(&path).unwrap();
            let tests =
                if is_test { Some(&text[..]) } else { text.split_once("#[cfg(test)]").map(|it| it.1) };
            texts.extend(tests.map(str::to_string));
        }
    }
}

/// Whether a text has a name as a word.
fn has_word(text: &str, name: &str) -> bool {
    let is_part = |byte: Option<&u8>| byte.is_some_and(|byte| byte.is_ascii_alphanumeric() || *byte == b'_');
    text.match_indices(name).any(|(start, _)| {
        let (before, after) = (&text.as_bytes()[..start], &text.as_bytes()[start + name.len()..]);
        !is_part(before.last()) && !is_part(after.first())
    })
}

#[test]
fn each_limit_is_named_in_a_test() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let limits = fs::read_to_string(root.join("src/base/limits.rs")).unwrap();
    let names: Vec<&str> = limits
        .lines()
        .filter_map(|line| line.strip_prefix("pub const "))
        .filter(|rest| !rest.starts_with("fn "))
        .map(|rest| rest.split(':').next().unwrap())
        .collect();
    assert!(names.len() > 50, "{names:?}");
    let mut texts = Vec::new();
    tests_below(&root.join("tests"), true, &mut texts);
    tests_below(&root.join("src"), false, &mut texts);
    let untested: Vec<&str> =
        names.into_iter().filter(|name| !texts.iter().any(|text| has_word(text, name))).collect();
    assert!(untested.is_empty(), "no test names these limits: {untested:?}");
}

#[test]
fn words_are_whole() {
    assert!(has_word("[A_MAX, 1]", "A_MAX") && has_word("A_MAX", "A_MAX"));
    assert!(!has_word("AA_MAX A_MAXIMUM", "A_MAX"));
}
