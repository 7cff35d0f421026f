//! Many files with a summary.

use std::path::{Path, PathBuf};

use super::{ENDINGS, Finished, Flags, OUTSIDE, Sums, TOOL};
use crate::flags::rewrite::{Rewriter, Rewriting, Stated, Written};
use crate::height::{Counts, Ground};
use spmesh_base::error::Result;
use spmesh_formats::detect::SPHEIGHT;
use spmesh_formats::ledger::{Columns, OUTPUT_TIME, SharedInput};
use spmesh_formats::sink::ColumnKind::{Integer, Number, Text};
use spmesh_formats::source::PointFile;
use spmesh_shell::{Common, value_name};

/// Writes the files that are not done yet to a folder.
///
/// # Errors
/// As [`Rewriting::run`].
pub(super) fn run(
    flags: &Flags,
    folder: &Path,
    files: Vec<PathBuf>,
    outputs: Vec<PathBuf>,
) -> Result<Finished> {
    let shared = Some(SharedInput { path: flags.ground.clone(), prefix: "ground" });
    let mut sums = Sums::default();
    let rewriting = Rewriting { flags: &flags.batch, folder, files, outputs, shared };
    let ended = rewriting.run(flags, |written| sums.add(written))?;
    let (triangles, ground_bytes) = ended.basis.map_or((0, 0), |(ground, bytes)| (ground.triangles(), bytes));
    Ok(Finished { sums, outcome: ended.outcome, triangles, ground_bytes, failure: ended.failure })
}

impl Rewriter for Flags {
    const TOOL: &'static str = TOOL;
    const WORK: &'static str = "finding heights";
    const COLUMNS: Columns = &[
        ("file", Text),
        ("output", Text),
        ("status", Text),
        ("exit_code", Integer),
        ("error", Text),
        ("warnings", Text),
        ("points", Integer),
        ("without_height", Integer),
        ("outside", Integer),
        ("below_ground", Integer),
        ("seconds", Number),
        ("output_bytes", Integer),
        (OUTPUT_TIME, Text),
        ("options", Text),
        ("version", Text),
        ("input_bytes", Integer),
        ("input_modified", Text),
        ("input_sha256", Text),
        ("ground_bytes", Integer),
        ("ground_modified", Text),
        ("ground_sha256", Text),
    ];
    type Basis = (Ground, u64);
    type Counts = Counts;

    fn common(&self) -> &Common {
        &self.common
    }

    fn options_text(&self) -> Result<String> {
        let place = if self.replace_z { "--replace-z".to_string() } else { format!("--name {}", self.name) };
        let mut text = format!("{place} --outside {}", value_name(OUTSIDE, &self.outside()));
        if let Some(format) = self.format {
            text += &format!(" --format {}", value_name(ENDINGS, &format));
        }
        let crs = self.crs.text().map_or(String::new(), |crs| format!(" --crs {crs}"));
        Ok(text + &crs + &self.text.to_string())
    }

    fn open(&self, input: &Path, output: &Path) -> Result<PointFile> {
        let file = PointFile::open(input, &SPHEIGHT, self.temp_dir.get(), &self.text.options())?;
        self.names().check(&file, output)?;
        Ok(file)
    }

    fn basis(&self, stated: &[Stated], _: &[&Path], outputs: &[PathBuf]) -> Result<(Ground, u64)> {
        self.ground(self.window(stated), outputs)
    }

    fn write(&self, (ground, _): &Self::Basis, file: &PointFile, output: &Path) -> Result<Written<Counts>> {
        self.rewrite(ground, file, output, |_| {})
    }

    fn fields(counts: &Counts) -> Vec<(&'static str, u64)> {
        vec![
            ("points", counts.points),
            ("without_height", counts.without),
            ("outside", counts.outside),
            ("below_ground", counts.below),
        ]
    }
}
