//! Names of the outputs of programs that write files of points again.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use clap::ValueEnum;

use spmesh_base::error::{Error, Result};
use spmesh_formats::ledger::check_distinct;
use spmesh_formats::source::PointFile;
use spmesh_shell::{Names, endings, of_ending};

/// The values of `--format`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum FormatFlag {
    Las,
    Laz,
}

/// The formats that endings of names stand for.
pub(super) const ENDINGS: Names<FormatFlag> = &[("las", FormatFlag::Las), ("laz", FormatFlag::Laz)];

/// Endings of points: LAS files, streams, and text.
const OF_POINTS: &[&str] = &["las", "laz", "spm", "xyz", "csv", "tsv", "txt", "asc", "dat"];

/// Where outputs go.
#[derive(Debug, Clone, Copy)]
pub(super) struct OutputNames<'f> {
    /// The file of a single output.
    pub(super) output: Option<&'f Path>,
    /// The folder of many.
    pub(super) folder: Option<&'f Path>,
    pub(super) format: Option<FormatFlag>,
}

impl OutputNames<'_> {
    /// The output of each input.
    ///
    /// # Errors
    /// Usage, if an output has the name of another format, or two files would have one output.
    pub(super) fn of(&self, inputs: &[PathBuf]) -> Result<Vec<PathBuf>> {
        if let Some(output) = self.output {
            let name = output.display().to_string();
            if stem(&name, ".copc.laz").is_some() {
                let what = "COPC files are not written: give a name that ends in .laz alone";
                return Err(Error::usage(what).of_input(name));
            }
            if self.format.is_none() {
                endings::check(output, &[OF_POINTS])?;
            }
            return Ok(vec![output.to_path_buf()]);
        }
        let folder = self.folder.unwrap_or(Path::new("."));
        let output = |input: &PathBuf| -> Result<PathBuf> {
            let name = input.file_name().filter(|name| *name != "-").and_then(|name| name.to_str());
            let name = name.ok_or_else(|| {
                Error::usage("has no name for its output: give --output FILE")
                    .of_input(input.display().to_string())
            })?;
            Ok(folder.join(self.output_name(name)))
        };
        let outputs = inputs.iter().map(output).collect::<Result<Vec<PathBuf>>>()?;
        check_distinct(inputs)?;
        check_apart(inputs, &outputs)?;
        Ok(outputs)
    }

    /// Checks that the name of an output goes with the format of the file, which stays.
    ///
    /// # Errors
    /// Usage, if it does not.
    pub(super) fn check(&self, file: &PointFile, output: &Path) -> Result<()> {
        let is_las = of_ending(ENDINGS, output).is_some();
        let is_stream = output.extension().is_some_and(|end| end.eq_ignore_ascii_case("spm"));
        let what = match file {
            PointFile::Las(_) if self.output.is_some() && self.format.is_none() && !is_las => {
                "points are written to NAME.las or NAME.laz, or choose with --format"
            }
            PointFile::Text(_) if self.format.is_some() => "--format is for LAS files: text stays text",
            PointFile::Stream(_) if self.format.is_some() => {
                "--format is for LAS files: streams stay streams"
            }
            PointFile::Stream(_) if self.output.is_some() && !is_stream => {
                "streams stay streams: give a name that ends in .spm, or --out-dir"
            }
            PointFile::Text(_) if self.output.is_some() && (is_las || is_stream) => {
                "text stays text: give a name such as points.csv"
            }
            _ => return Ok(()),
        };
        Err(Error::usage(what).of_input(output.display().to_string()))
    }

    /// Whether the points of an output are compressed; as in the input if `None`.
    pub(super) fn is_compressed(&self, output: &Path) -> Option<bool> {
        let is_named = self.output.is_some().then(|| of_ending(ENDINGS, output)).flatten();
        self.format.or(is_named).map(|format| format == FormatFlag::Laz)
    }

    /// The name of the output of the file `name`.
    fn output_name(&self, name: &str) -> String {
        let name = stem(name, ".gz").unwrap_or_else(|| name.to_string());
        let name = stem(&name, ".copc.laz").map_or(name, |stem| format!("{stem}.laz"));
        let end = match self.format {
            None => return name,
            Some(FormatFlag::Las) => ".las",
            Some(FormatFlag::Laz) => ".laz",
        };
        let bare = stem(&name, ".las").or_else(|| stem(&name, ".laz")).unwrap_or(name);
        format!("{bare}{end}")
    }
}

/// Refuses files that would have one output.
fn check_apart(inputs: &[PathBuf], outputs: &[PathBuf]) -> Result<()> {
    let mut inputs_of: HashMap<&Path, &Path> = HashMap::new();
    for (input, output) in inputs.iter().zip(outputs) {
        if let Some(other) = inputs_of.insert(output, input) {
            let [other, output] = [other, output].map(Path::display);
            let message = format!(
                "would have the same output as {other}, {output}: outputs keep the names of their files, so give \
                 files of one name in runs with an --out-dir each"
            );
            return Err(Error::usage(message).of_input(input.display().to_string()));
        }
    }
    Ok(())
}

/// A name without an ending, in whatever case; `None` if it has another one.
fn stem(name: &str, end: &str) -> Option<String> {
    let at = name.len().checked_sub(end.len())?;
    name.is_char_boundary(at).then_some(()).filter(|()| name[at..].eq_ignore_ascii_case(end))?;
    Some(name[..at].to_string())
}
