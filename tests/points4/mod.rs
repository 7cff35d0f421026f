//! Points of four dimensions: every selected point of the input, or an error that says what is wrong and
//! where.

mod grids;
mod nifti;
mod nrrd;
mod nrrd_damage;
mod raw;
mod selections;
mod text;

use std::io::Write;
use std::path::Path;

use spmesh_base::error::{ErrorKind, Result};
use spmesh_formats::volumes::{From4, Request, Selected4, Selection, Spacing, read_points4};
use spmesh_stream::model::cells4::Point4;

use crate::programs::Folder;

/// A request for all points.
fn all(from: From4) -> Request {
    Request {
        from,
        spacing: Spacing::Index,
        selection: Selection::default(),
        temp_dir: None,
        in_memory: true,
    }
}

/// A request for the points that fulfil a condition.
fn with_condition(from: From4, condition: &str) -> Request {
    let condition = Some(condition.parse().expect("a condition"));
    Request { selection: Selection { condition, ..Selection::default() }, ..all(from) }
}

/// All points of a file of the tests.
fn sample(name: &str) -> From4 {
    From4::File(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name))
}

/// All points of a file with this content.
fn read(content: impl AsRef<[u8]>) -> Result<Selected4> {
    let folder = Folder::new();
    read_points4(&all(From4::File(folder.file("input", content))))
}

fn gzip(content: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(content).expect("memory takes all");
    encoder.finish().expect("memory takes all")
}

/// The value at a point.
fn value_at(points: &Selected4, place: Point4) -> f64 {
    let at = points.points.iter().position(|point| *point == place).expect("the point is there");
    points.values.as_ref().expect("there are values")[at]
}

/// Asserts that reading fails with `kind` and a message with all of `parts`.
fn assert_fails(result: Result<Selected4>, kind: ErrorKind, parts: &[&str]) {
    let error = result.expect_err("reading should fail");
    let message = error.to_string();
    assert_eq!(error.kind(), kind, "{message}");
    for part in parts {
        assert!(message.contains(part), "{part:?} is not in {message:?}");
    }
}
