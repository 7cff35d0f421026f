//! Flags for lines that become edges of a mesh.

use std::path::{Path, PathBuf};

use clap::Args;

use super::endings;
use spmesh_core::error::Result;
use spmesh_core::output::Output;
use spmesh_lines::{Areas, ChangeKind, Changes, Options, Sources, Target};
use spmesh_model::network::Network;

/// Where lines are, and how they are prepared.
#[derive(Debug, Args)]
pub(super) struct LineFlags {
    /// Lines: GeoJSON, Shapefile, GeoPackage, or text with a word, line or soft, and coordinates: X Y Z of each
    /// vertex of a line, X Y of a soft one. Lines with elevations are hard; others are soft and take the elevation
    /// of the surface. Rings of polygons are lines. May be given several times
    #[arg(long, value_name = "FILE")]
    lines: Vec<PathBuf>,

    /// Divide parts of lines that are longer than this, in units of the coordinates
    #[arg(long, value_name = "LENGTH")]
    densify: Option<f64>,

    /// Write what was changed about the lines to this file: kind, line, x and y, separated by tabs
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
}

impl LineFlags {
    /// The files of lines.
    pub(super) fn paths(&self) -> impl Iterator<Item = &Path> {
        self.lines.iter().map(PathBuf::as_path)
    }

    /// The outputs, with their flags.
    pub(super) fn outputs(&self) -> impl Iterator<Item = (&'static str, &Path)> {
        self.report.iter().map(|report| ("--report", report.as_path()))
    }

    /// Creates the report, if it is asked for.
    ///
    /// # Errors
    /// If it cannot be created.
    pub(super) fn create_report(&self) -> Result<Option<Output>> {
        let Some(report) = &self.report else { return Ok(None) };
        endings::check(report, &[endings::TABLE])?;
        Output::create(report, false).map(Some)
    }

    /// Reads the lines for a stream, and polygons to cut the mesh with.
    ///
    /// # Errors
    /// As [`spmesh_lines::read_with_areas`].
    pub(super) fn read_with_areas(
        &self,
        hull: &[PathBuf],
        holes: &[PathBuf],
        target: &Target,
    ) -> Result<(Network, Areas, Changes)> {
        let options = Options { densify: self.densify, lists_changes: self.report.is_some() };
        spmesh_lines::read_with_areas(&Sources { lines: &self.lines, hull, holes }, target, &options)
    }

    /// Messages about changes that may surprise.
    pub(super) fn notices(&self, changes: &Changes) -> Vec<String> {
        let told = [
            (ChangeKind::Crossing, "crossings of lines became vertices"),
            (ChangeKind::Touch, "lines were bent to vertices that they touch"),
            (ChangeKind::Overlap, "parts of lines overlapped"),
            (
                ChangeKind::ConflictingElevation,
                "vertices have several elevations, of which the lowest counts",
            ),
        ];
        let counts: Vec<String> = told
            .iter()
            .map(|&(kind, text)| (changes.count(kind), text))
            .filter(|(count, _)| *count > 0)
            .map(|(count, text)| format!("{count} {text}"))
            .collect();
        let mut notices = changes.notices.clone();
        if !counts.is_empty() {
            let remedy = if self.report.is_some() { "" } else { " (--report FILE lists them)" };
            notices.push(format!("{}{remedy}", counts.join("; ")));
        }
        notices
    }
}
