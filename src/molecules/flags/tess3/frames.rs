//! Flags of frames: which ones, and what names their atoms.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;

use spmesh_base::error::{Error, Result};
use spmesh_formats::ledger::SharedInput;
use spmesh_formats::molecules::{FrameRange, Structure, read_structure};

/// Which frames of a file are taken.
#[derive(Debug, Clone, Args)]
pub(super) struct FrameFlags {
    /// The structure that names the atoms of trajectories: XTC, TRR, DCD, or frames of GRO, PDB and XYZ. They
    /// are taken frame by frame; all must have as many atoms as its first model
    #[arg(long, value_name = "FILE", conflicts_with_all = ["model", "assembly"])]
    top: Option<PathBuf>,

    /// Frames of a trajectory, or of a file of several structures, one by one: from A on, before B, each
    /// S-th, as Python counts them from 0; or the one of this number [default with --top: all]
    #[arg(long, value_name = "A:B:S", conflicts_with_all = ["model", "assembly"])]
    frames: Option<FrameRange>,
}

impl FrameFlags {
    /// The frames; `None` if models are taken.
    pub(super) fn range(&self) -> Option<FrameRange> {
        self.frames.or_else(|| self.top.as_ref().map(|_| FrameRange::default()))
    }

    /// What names the atoms, if the frames do not. `notice` hears of its oddities.
    pub(super) fn topology(&self, notice: impl Fn(&str)) -> Result<Option<Arc<Structure>>> {
        let Some(path) = &self.top else { return Ok(None) };
        let mut structure = read_structure(path, None)?;
        structure.models.truncate(1);
        if structure.models[0].atoms.is_empty() {
            let message = "has points without names: give a structure, such as PDB, mmCIF or GRO";
            return Err(Error::usage(message).of_input(structure.name));
        }
        structure.warnings.drain(..).for_each(|text| notice(&format!("{}: {text}", path.display())));
        Ok(Some(Arc::new(structure)))
    }

    /// The file of the topology, as an input of all files of a sweep.
    pub(super) fn shared(&self) -> Option<SharedInput> {
        self.top.clone().map(|path| SharedInput { path, prefix: "topology" })
    }

    /// Refuses stdin for both.
    pub(super) fn check(&self, inputs: &[PathBuf]) -> Result<()> {
        let is_stdin = |path: &PathBuf| path == Path::new("-");
        if self.top.as_ref().is_some_and(is_stdin) && inputs.iter().any(is_stdin) {
            return Err(Error::usage("--top and the trajectory cannot both be stdin: give one as a file"));
        }
        Ok(())
    }
}

/// The flags as a user would type them.
impl fmt::Display for FrameFlags {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.range().map_or(Ok(()), |range| write!(f, " --frames {range}"))
    }
}
