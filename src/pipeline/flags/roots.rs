//! Where the roots of files in plans are.

use std::path::PathBuf;

use clap::Args;

use crate::plan::Roots;

/// The flag for roots.
#[derive(Debug, Clone, Default, Args)]
pub(super) struct RootFlags {
    /// Name files in the folder PATH relative to it, as files of the root NAME: so a plan may move with its
    /// files. May be given several times
    #[arg(long = "root", value_name = "NAME=PATH", value_parser = parse_root)]
    roots: Vec<(String, PathBuf)>,
}

impl RootFlags {
    /// The folders by their names.
    pub(super) fn roots(&self) -> Roots {
        self.roots.iter().cloned().collect()
    }
}

fn parse_root(text: &str) -> Result<(String, PathBuf), String> {
    match text.split_once('=') {
        Some((name, path)) if !name.is_empty() && !path.is_empty() && !name.contains([':', '/']) => {
            Ok((name.to_string(), PathBuf::from(path)))
        }
        _ => Err("expected NAME=PATH, with a name without : and /".to_string()),
    }
}
