//! Where the roots of files in plans are.

use std::path::PathBuf;

use clap::Args;

use crate::plan::Roots;
use spmesh_base::error::{Error, ErrorKind, Result};

/// The flag for roots.
#[derive(Debug, Clone, Default, Args)]
pub struct RootFlags {
    /// Name files in the folder PATH relative to it, as files of the root NAME: so a plan may move with its
    /// files. May be given several times
    #[arg(long = "root", value_name = "NAME=PATH", value_parser = parse_root)]
    roots: Vec<(String, PathBuf)>,
}

impl RootFlags {
    /// The folders by their names.
    ///
    /// # Errors
    /// Usage, if a name is given twice; I/O, if there is no such folder.
    pub fn roots(&self) -> Result<Roots> {
        let mut roots = Roots::new();
        for (name, path) in &self.roots {
            if !path.is_dir() {
                let message = format!("the root {name:?} is no folder");
                return Err(Error::new(ErrorKind::Io, message).of_input(path.display().to_string()));
            }
            if let Some(other) = roots.insert(name.clone(), path.clone()) {
                let message = format!("the root {name:?} is given twice, also as {}", other.display());
                return Err(Error::usage(message).of_input(path.display().to_string()));
            }
        }
        Ok(roots)
    }
}

fn parse_root(text: &str) -> std::result::Result<(String, PathBuf), String> {
    match text.split_once('=') {
        Some((name, path)) if !name.is_empty() && !path.is_empty() && !name.contains([':', '/']) => {
            Ok((name.to_string(), PathBuf::from(path)))
        }
        _ => Err("expected NAME=PATH, with a name without : and /".to_string()),
    }
}
