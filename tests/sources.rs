//! Point files of other programs: every point exactly, or an error that says what is wrong and where.

mod columns;
mod damage;
mod filters;
mod grids;
mod index_copc;
mod index_lax;
mod las;
pub mod las_file;
mod lax_writer;
mod raw;
mod salvage;
mod sp;
mod structure;
mod structure_cif;
mod structure_damage;
mod structure_pdb;
mod structure_radii;
mod structure_selection;
mod survey;
mod text;
mod vtk_file;
mod vtk_legacy;
mod vtk_xml;

use std::path::{Path, PathBuf};

use spmesh_base::error::{ErrorKind, Result};
use spmesh_formats::source::{Input, SourceOptions};
use spmesh_stream::model::bounds::Point;

use crate::programs::Folder;

/// Default options for two dimensions.
fn flat() -> SourceOptions {
    SourceOptions { dims: 2, ..SourceOptions::default() }
}

/// A bundled sample.
fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

/// The points of one pass, the number of records that were decoded, and notices.
fn decoded(path: &Path, options: &SourceOptions) -> Result<(Vec<Point>, u64, Vec<String>)> {
    let input = Input::open(&[path.to_path_buf()], options)?;
    let mut reader = input.read()?;
    let (mut points, mut batch) = (Vec::new(), Vec::new());
    loop {
        reader.next_batch(&mut batch)?;
        if batch.is_empty() {
            return Ok((points, reader.records(), input.notices().to_vec()));
        }
        points.extend_from_slice(&batch);
    }
}

/// All points of one pass.
fn pass(input: &Input) -> Result<Vec<Point>> {
    let mut reader = input.read()?;
    let (mut points, mut batch) = (Vec::new(), Vec::new());
    loop {
        reader.next_batch(&mut batch)?;
        if batch.is_empty() {
            return Ok(points);
        }
        points.extend_from_slice(&batch);
    }
}

/// All points of `paths`, after checking that two passes give the same.
fn points(paths: &[PathBuf], options: &SourceOptions) -> Result<Vec<Point>> {
    let input = Input::open(paths, options)?;
    let first = pass(&input)?;
    assert_eq!(first, pass(&input)?, "two passes over {paths:?} differ");
    Ok(first)
}

/// Points of a file with this content.
fn points_of(content: impl AsRef<[u8]>) -> Result<Vec<Point>> {
    let folder = Folder::new();
    points(&[folder.file("points", content)], &flat())
}

/// The bits of all coordinates, which distinguish 0.0 from -0.0.
fn bits(points: &[Point]) -> Vec<u64> {
    points.as_flattened().iter().map(|x| x.to_bits()).collect()
}

/// Asserts that reading fails with `kind` and a message with all of `parts`.
fn assert_fails<T: std::fmt::Debug>(result: Result<T>, kind: ErrorKind, parts: &[&str]) {
    let error = result.expect_err("reading should fail");
    let message = error.to_string();
    assert_eq!(error.kind(), kind, "{message}");
    for part in parts {
        assert!(message.contains(part), "{part:?} is not in {message:?}");
    }
}
