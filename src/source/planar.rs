//! Points in the plane, or a triangle mesh over them: whichever an input is.

use std::io::BufReader;
use std::path::{Path, PathBuf};

use super::detect::{self, detect};
use super::events::EventSource;
use super::origin::{Origin, name_of};
use super::twin::TwinSource;
use super::{Input, SourceOptions};
use crate::error::Result;
use crate::stream::{Kind, StreamReader};

/// What an input is.
pub enum Planar {
    /// Points of any source.
    Points(Box<Input>),
    /// A triangle mesh stream, or the text twin of one.
    Mesh(Box<dyn EventSource>),
}

/// Opens `paths` ("-" is standard input) as points in the plane, or one path as a triangle mesh if it is one.
///
/// Cost: the headers; what cannot be read twice is copied to an unlinked temporary file.
///
/// # Errors
/// As [`Input::open`].
pub fn open_planar(paths: &[PathBuf], options: &SourceOptions) -> Result<Planar> {
    match paths {
        [path] => open_one(path, options),
        _ => Ok(Planar::Points(Box::new(Input::open(paths, options)?))),
    }
}

fn open_one(path: &Path, options: &SourceOptions) -> Result<Planar> {
    let temp_dir = options.temp_dir.clone().unwrap_or_else(std::env::temp_dir);
    // That a pipe is copied tells nobody anything: all of it is held in memory later.
    let origin = Origin::new(path, &temp_dir, &mut Vec::new())?;
    let name = name_of(path);
    if let Some(mesh) = open_mesh(&origin, &name).map_err(|e| e.of_input(&name))? {
        return Ok(Planar::Mesh(mesh));
    }
    Ok(Planar::Points(Box::new(Input::of_origin(origin, name, options)?)))
}

/// `None` if it is no triangle mesh.
fn open_mesh(origin: &Origin, name: &str) -> Result<Option<Box<dyn EventSource>>> {
    let view = origin.view()?;
    let source: Box<dyn EventSource> = match detect(&view)? {
        detect::Format::Stream => Box::new(StreamReader::new(BufReader::with_capacity(1 << 18, view), name)?),
        detect::Format::Twin => Box::new(TwinSource::new(view, name)?),
        _ => return Ok(None),
    };
    Ok((source.header().kind == Kind::TriangleMesh).then_some(source))
}
