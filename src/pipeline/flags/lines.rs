//! Flags for lines, and what is said about them.

use std::path::PathBuf;

use clap::Args;

use crate::lines::{ChangeKind, Changes, Options};
use spmesh_base::error::{Error, Result};
use spmesh_base::output::Output;
use spmesh_shell::parse_numbers;

/// Lines that are read along with points or a mesh.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Lines")]
pub struct LineFlags {
    /// Read lines from this file: GeoJSON, Shapefile, GeoPackage (FILE.gpkg:LAYER for one layer) or text; may
    /// be given several times. A line of text is the word line with X Y Z of each vertex, or soft with X Y
    #[arg(long = "lines", value_name = "FILE")]
    pub files: Vec<PathBuf>,

    /// Take the elevations of features of --lines from this property where they have it, and not from third
    /// coordinates
    #[arg(long, value_name = "NAME")]
    pub z_field: Option<String>,

    /// Divide parts of lines that are longer than this, in world units
    #[arg(long, value_name = "LENGTH", value_parser = parse_length)]
    pub densify: Option<f64>,

    /// Write a table of all that was changed about lines: kind, line (numbered from 0), x and y, separated by
    /// tabs. With --flatten, it has the levels of lakes and of stations of rivers, too
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
}

fn parse_length(text: &str) -> std::result::Result<f64, String> {
    let [length] = parse_numbers(text)?;
    if length > 0.0 { Ok(length) } else { Err(format!("{text} is no length: expected a positive number")) }
}

impl LineFlags {
    /// Checks that flags about lines come with lines.
    ///
    /// # Errors
    /// Usage, if they do not.
    pub fn check(&self, has_areas: bool) -> Result<()> {
        if self.z_field.is_some() && self.files.is_empty() {
            return Err(Error::usage("--z-field is about lines: give --lines, too"));
        }
        let flags = [("--densify", self.densify.is_some()), ("--report", self.report.is_some())];
        match flags.iter().find(|(_, is_given)| *is_given) {
            Some((flag, _)) if self.files.is_empty() && !has_areas => {
                Err(Error::usage(format!("{flag} is about lines: give --lines, too")))
            }
            _ => Ok(()),
        }
    }

    /// How the lines are read.
    pub fn options(&self) -> Options {
        Options {
            densify: self.densify,
            lists_changes: self.report.is_some(),
            elevation: self.z_field.as_deref().map(Into::into),
            ..Options::default()
        }
    }

    /// Creates the file for the report, if one is asked for.
    ///
    /// # Errors
    /// If that fails.
    pub fn create_report(&self) -> Result<Option<Output>> {
        self.report.as_ref().map(|path| Output::create(path, false)).transpose()
    }
}

/// What was changed about lines, in one line; `None` if nothing was.
pub fn summary(changes: &Changes) -> Option<String> {
    let counts = ChangeKind::ALL.iter().map(|&kind| (kind.name().replace('_', " "), changes.count(kind)));
    let counts: Vec<String> =
        counts.filter(|(_, count)| *count > 0).map(|(name, count)| format!("{name} {count}")).collect();
    (!counts.is_empty()).then(|| format!("changes to lines: {}", counts.join(", ")))
}
