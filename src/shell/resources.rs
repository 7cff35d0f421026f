//! Flags for what a run may take from its machine.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::TypedValueParser;

use spmesh_base::parallel::{THREADS_DEFAULT_MAX, available_threads};

/// The flag for the number of threads.
#[derive(Debug, Clone, Args)]
pub struct ThreadsFlag {
    /// Threads; results do not depend on them [default: one per core, at most 8]
    #[arg(long, value_name = "N", value_parser = parse_threads())]
    threads: Option<NonZeroUsize>,
}

impl ThreadsFlag {
    /// The requested number; by default one per core, at most [`THREADS_DEFAULT_MAX`].
    pub fn get(&self) -> NonZeroUsize {
        let most = NonZeroUsize::new(THREADS_DEFAULT_MAX).unwrap_or(NonZeroUsize::MIN);
        self.threads.unwrap_or_else(|| available_threads().min(most))
    }
}

/// Parses a number of threads.
pub fn parse_threads() -> impl TypedValueParser<Value = NonZeroUsize> {
    clap::value_parser!(u16)
        .range(1..=1024)
        .map(|count| NonZeroUsize::MIN.saturating_add(usize::from(count) - 1))
}

/// The flag for the folder of temporary files.
#[derive(Debug, Clone, Args)]
pub struct TempDirFlag {
    /// Folder for temporary files [default: TMPDIR, or /tmp]
    #[arg(long, value_name = "FOLDER")]
    temp_dir: Option<PathBuf>,
}

impl TempDirFlag {
    /// The folder, if it is not the system's.
    pub fn get(&self) -> Option<&Path> {
        self.temp_dir.as_deref()
    }

    /// As [`TempDirFlag::get`], for options that keep it.
    pub fn to_owned(&self) -> Option<PathBuf> {
        self.temp_dir.clone()
    }
}
