//! Inputs, and meshes of which a program may need a window alone: of a mesh in parts, only the parts there
//! are opened.

use std::io::{self, Read};
use std::path::Path;

use super::refuse_terminal;
use spmesh_base::error::{Error, Result};
use spmesh_base::inputs;
use spmesh_formats::source::{MeshInParts, Plain, is_manifest, name_of, open_stdin};
use spmesh_stream::model::bounds::Bounds;
use spmesh_stream::{Header, StreamReader, Totals, check_part};

/// The bytes of an input.
type Bytes = Box<dyn Read + Send>;

/// An input that was opened.
pub(super) enum Source {
    /// Its bytes.
    Bytes(Bytes),
    /// The manifest of a mesh in parts.
    Parts(Box<MeshInParts>),
}

impl Source {
    /// Opens an input, `-` for stdin, and decompresses it by `plain`; with the name that messages use.
    pub(super) fn open(
        path: &Path,
        plain: impl Fn(Bytes) -> io::Result<Plain<Bytes>>,
    ) -> Result<(Source, String)> {
        let name = name_of(path);
        let file: Bytes = if path.as_os_str() == "-" {
            refuse_terminal()?;
            Box::new(open_stdin()?)
        } else {
            let file = inputs::open(path).map_err(|e| e.of_input(&name))?;
            if is_manifest(&file) {
                return Ok((Source::Parts(Box::new(MeshInParts::open(path)?)), name));
            }
            Box::new(file)
        };
        let input = plain(file).map_err(|e| Error::io("reading", e).of_input(&name))?;
        Ok((Source::Bytes(Box::new(input)), name))
    }

    /// All of its bytes; those of the mesh, if it is one in parts.
    pub(super) fn read(self) -> Result<Bytes> {
        match self {
            Source::Bytes(input) => Ok(input),
            Source::Parts(mesh) => Ok(Box::new(mesh.join(None)?)),
        }
    }
}

/// What a program needs of a mesh.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Needs {
    /// The closed box of the world in which it needs all triangles; everywhere if `None`.
    pub window: Option<Bounds>,
    /// What needs the triangles around a triangle, so that a part of a mesh is refused: see [`check_part`].
    pub beyond: Option<&'static str>,
}

/// A mesh of which the header was read.
pub struct Mesh {
    input: MeshInput,
    name: String,
}

enum MeshInput {
    Stream(Box<StreamReader<Bytes>>),
    Parts(Box<MeshInParts>),
}

/// A mesh that is read.
pub struct MeshReader {
    /// Its stream.
    pub reader: StreamReader<Bytes>,
    /// The window, if parts of the mesh outside of it are left out.
    pub window: Option<Bounds>,
}

impl Mesh {
    /// Opens a mesh, `-` for stdin: a stream, or a manifest.
    ///
    /// # Errors
    /// As [`super::open_stream`].
    pub fn open(path: &Path) -> Result<Mesh> {
        let (source, name) = Source::open(path, Plain::new)?;
        let input = match source {
            Source::Bytes(input) => MeshInput::Stream(Box::new(StreamReader::new(input, name.clone())?)),
            Source::Parts(mesh) => MeshInput::Parts(mesh),
        };
        Ok(Mesh { input, name })
    }

    /// Its header.
    pub fn header(&self) -> &Header {
        match &self.input {
            MeshInput::Stream(reader) => reader.header(),
            MeshInput::Parts(mesh) => mesh.header(),
        }
    }

    /// Its name in messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Starts to read what a program needs of it.
    ///
    /// # Errors
    /// Usage, if it is a part of a mesh, and more is needed; malformed, if the manifest is.
    pub fn read(self, needs: &Needs) -> Result<MeshReader> {
        check_part(self.header(), needs.beyond).map_err(|e| e.of_input(&self.name))?;
        match self.input {
            MeshInput::Stream(reader) => Ok(MeshReader { reader: *reader, window: None }),
            MeshInput::Parts(mesh) => {
                let joined = mesh.join(needs.window.as_ref())?;
                let window = needs.window.filter(|_| joined.whole().is_some());
                let bytes: Bytes = Box::new(joined);
                Ok(MeshReader { reader: StreamReader::new(bytes, self.name)?, window })
            }
        }
    }
}

/// As [`super::open_input`]; of a mesh in parts, only those in the window are opened which `window` finds for
/// its header. If parts are left out, returns the counts of the whole mesh, too.
///
/// # Errors
/// As [`super::open_input`].
pub fn open_within(
    path: &Path,
    window: impl FnOnce(&Header) -> Option<Bounds>,
) -> Result<(Box<dyn Read + Send>, String, Option<Totals>)> {
    match Source::open(path, Plain::new)? {
        (Source::Bytes(input), name) => Ok((input, name, None)),
        (Source::Parts(mesh), name) => {
            let window = window(mesh.header());
            let joined = mesh.join(window.as_ref())?;
            let whole = joined.whole();
            Ok((Box::new(joined), name, whole))
        }
    }
}
