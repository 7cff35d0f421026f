//! Chooses names of outputs: short and distinct.

use std::collections::{HashMap, HashSet};
use std::ffi::{OsStr, OsString};
use std::path::{Component, Path, PathBuf};

/// Extensions of inputs that denote a format only.
const FORMATS: [&str; 12] =
    ["pdb", "ent", "cif", "mmcif", "xyz", "txt", "csv", "dat", "asc", "spm", "ply", "obj"];

/// The name of the output of each input, without its extension: relative to the folder of outputs, and none
/// of `taken`.
///
/// The name is the base name without the extension of its format. If several inputs would get the same name,
/// it keeps the extension; if that does not suffice, it gets as many parent folders as needed. Names that
/// differ in case only count as equal, because some file systems ignore case.
pub(super) fn stems(inputs: &[&Path], taken: &HashSet<PathBuf>) -> Vec<PathBuf> {
    let taken: HashSet<OsString> = taken.iter().map(|path| folded(path)).collect();
    let levels_max: Vec<usize> = inputs.iter().map(|input| parts(input).len()).collect();
    let mut levels = vec![0; inputs.len()];
    loop {
        let stems: Vec<PathBuf> =
            inputs.iter().zip(&levels).map(|(input, &level)| stem(input, level)).collect();
        let mut uses: HashMap<OsString, usize> = HashMap::new();
        stems.iter().for_each(|stem| *uses.entry(folded(stem)).or_default() += 1);
        let mut changed = false;
        for (i, stem) in stems.iter().enumerate() {
            let name = folded(stem);
            if (uses[&name] > 1 || taken.contains(&name)) && levels[i] < levels_max[i] {
                levels[i] += 1;
                changed = true;
            }
        }
        if !changed {
            return numbered(stems, taken);
        }
    }
}

/// Numbers names that are still equal.
fn numbered(mut stems: Vec<PathBuf>, mut taken: HashSet<OsString>) -> Vec<PathBuf> {
    for stem in &mut stems {
        let plain = stem.clone().into_os_string();
        let mut number = 1;
        while !taken.insert(folded(stem)) {
            number += 1;
            let mut name = plain.clone();
            name.push(format!("-{number}"));
            *stem = name.into();
        }
    }
    stems
}

/// The name at a level: without extension, with extension, then with one more folder per level.
fn stem(input: &Path, level: usize) -> PathBuf {
    let parts = parts(input);
    match (level, parts.split_last()) {
        (_, None) => PathBuf::from("input"),
        (0, Some((base, _))) => without_extension(base).into(),
        (level, Some(_)) => parts[parts.len() - level.min(parts.len())..].iter().collect(),
    }
}

/// The folders of an input and its base name.
fn parts(input: &Path) -> Vec<OsString> {
    if input == Path::new("-") {
        return vec!["stdin".into()];
    }
    let path = std::path::absolute(input).unwrap_or_else(|_| input.to_path_buf());
    let normal = path.components().filter_map(|part| match part {
        Component::Normal(name) => Some(name.to_os_string()),
        _ => None,
    });
    normal.collect()
}

fn without_extension(base: &OsStr) -> OsString {
    let is = |name: &Path, extensions: &[&str]| {
        let extension = name.extension().and_then(OsStr::to_str).unwrap_or_default().to_ascii_lowercase();
        extensions.contains(&&extension[..])
    };
    let mut name = Path::new(base).to_path_buf();
    for extensions in [&["gz"][..], &FORMATS] {
        if is(&name, extensions) {
            name.set_extension("");
        }
    }
    name.into_os_string()
}

fn folded(path: &Path) -> OsString {
    path.as_os_str().to_ascii_lowercase()
}
