//! Values of flags that are chosen by name. The engines' types stay free of the names that users type.

use std::path::Path;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// Names, each with its value. What `--help` says about a value follows its name after a colon.
pub type Names<T> = &'static [(&'static str, T)];

/// Parses the name of a value.
pub fn named<T: Clone + Send + Sync + 'static>(names: Names<T>) -> impl TypedValueParser<Value = T> {
    let possible = names.iter().map(|(entry, _)| match entry.split_once(": ") {
        Some((name, help)) => PossibleValue::new(name).help(help),
        None => PossibleValue::new(*entry),
    });
    PossibleValuesParser::new(possible).map(|name: String| {
        let entry = names.iter().find(|(entry, _)| bare(entry) == name);
        entry.expect("only names in the table are possible").1.clone()
    })
}

/// The name of a value; empty if it has none.
pub fn value_name<T: PartialEq>(names: Names<T>, value: &T) -> &'static str {
    names.iter().find(|(_, named)| named == value).map_or("", |(entry, _)| bare(entry))
}

/// The value that the ending of a path names, in whatever case.
pub fn of_ending<T: Copy>(endings: Names<T>, path: &Path) -> Option<T> {
    let ending = path.extension()?.to_str()?.to_ascii_lowercase();
    endings.iter().find(|(name, _)| *name == ending).map(|(_, value)| *value)
}

fn bare(entry: &str) -> &str {
    entry.split_once(": ").map_or(entry, |(name, _)| name)
}
