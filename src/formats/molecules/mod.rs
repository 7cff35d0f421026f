//! Molecular structures and files of points in space: PDB, mmCIF, XYZ, text of points, streams of this
//! project and their text twins, PLY, OBJ, OFF and VTK, each plain or compressed with gzip. The content tells
//! the format.
//!
//! The readers are this project's own. The crate `pdbtbx` panics on some files of the test data, rejects
//! others whose atoms are all intact, and takes longer than the triangulation.

pub(crate) mod assemblies;
pub(crate) mod assembly;
pub(crate) mod atoms;
pub(crate) mod builder;
pub(crate) mod cif;
pub(crate) mod classes;
pub(crate) mod conformers;
pub(crate) mod decimal;
pub(crate) mod locations;
pub(crate) mod meshes;
pub(crate) mod mmcif;
pub(crate) mod mmcif_tables;
pub(crate) mod model;
pub(crate) mod motion;
pub(crate) mod names;
pub(crate) mod off;
pub(crate) mod operators;
pub(crate) mod pdb;
pub(crate) mod pdb_assemblies;
pub(crate) mod pdb_header;
pub(crate) mod points;
pub(crate) mod radii;
pub(crate) mod residue_names;
pub(crate) mod selection;
pub(crate) mod serial;
pub(crate) mod xyz;

use std::io::{Cursor, Read};
use std::path::Path;

pub use assemblies::Assemblies;
pub use classes::Class;
pub use model::{Atom, AtomView, Model, Residue, Structure};
pub use names::{Name, Names};
pub use radii::{LoadedRadii, Radii, RadiusFinder};
pub use selection::{Altlocs, Atoms, Models, Selected, Selection};

use self::builder::StructureBuilder;
use crate::source::gzip::Plain;
use crate::source::origin::{open_file, open_stdin};
use crate::text::lines::Lines;

use crate::detect::{self, HEAD_LEN, TESS3, read_head};
use crate::obj::read::open_obj;
use crate::ply::read::open_ply;
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::STRUCTURE_LINE_MAX;
use spmesh_stream::Coordinates;

/// Format of a structure or a file of points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// PDB: records of fixed columns.
    Pdb,
    /// PDBx/mmCIF: the `_atom_site` category of the first data block that has one.
    Mmcif,
    /// XYZ of chemistry: frames of a count, a comment, and lines `element x y z`.
    Xyz,
    /// Vertices of a PLY file.
    Ply,
    /// Vertices of an OBJ file.
    Obj,
    /// Vertices of an OFF file.
    Off,
    /// Points as `spfinalize` reads them: lines `x y z` and similar text, streams of this project, their text
    /// twins, LAS, VTK; and the vertices of tetrahedral meshes of this project.
    Points,
}

/// Reads the structure or the points in the file `path`; "-" is standard input. Without `format`, the content
/// tells the format.
///
/// Cost: one pass. Memory: 56 bytes per atom, and 24 per point without names. Input of [`Format::Points`]
/// that is not a regular file, and compressed LAS and VTK files, are copied to an unlinked temporary file
/// first.
///
/// # Errors
/// If the file cannot be read; [`spmesh_base::error::ErrorKind::Malformed`], with file and line (or byte), if
/// it is damaged, has no atom, or is of no known format.
pub fn read_structure(path: &Path, format: Option<Format>) -> Result<Structure> {
    if path.as_os_str() == "-" {
        return read_structure_from(open_stdin()?, "stdin", format);
    }
    let name = path.display().to_string();
    let (file, kind) = open_file(path).map_err(|e| e.of_input(&name))?;
    read(file, &name, format, kind.is_file().then_some(path))
}

/// As [`read_structure`], from any reader. Messages call the input `name`.
///
/// # Errors
/// As [`read_structure`].
pub fn read_structure_from(
    input: impl Read + 'static,
    name: &str,
    format: Option<Format>,
) -> Result<Structure> {
    read(input, name, format, None)
}

/// Reads `input`. `path` is a regular file with the same content, if there is one.
fn read(
    input: impl Read + 'static,
    name: &str,
    format: Option<Format>,
    path: Option<&Path>,
) -> Result<Structure> {
    let reading = |e| Error::io("reading", e).of_input(name);
    let mut input = Plain::held(input).map_err(reading)?;
    let head = read_head(&mut input).map_err(reading)?;
    let format = format.map_or_else(|| recognized(&head), |format| check(format, &head));
    let format = format.map_err(|e| e.of_input(name))?;
    let is_mesh = format == Format::Points && meshes::is_mesh(&head);
    let input = Cursor::new(head.clone()).chain(input);
    if is_mesh {
        return meshes::read(&head, input, name);
    }
    let mut builder = StructureBuilder::default();
    let lines = |input| Lines::with_longest(input, name, STRUCTURE_LINE_MAX);
    match format {
        Format::Pdb => pdb::read(&mut lines(input), &mut builder),
        Format::Mmcif => mmcif::read(lines(input), &mut builder),
        Format::Xyz => xyz::read(&mut lines(input), &mut builder),
        Format::Ply => return points::read_events(open_ply(input, name, 3)?, name),
        Format::Obj => return points::read_events(open_obj(input, name), name),
        Format::Off => {
            return points::structure(off::read(&mut lines(input))?, Coordinates::F64, name, Vec::new());
        }
        Format::Points => {
            return match path {
                Some(path) => points::read_file(path),
                None => points::read_copy(input, name),
            };
        }
    }
    .map_err(|e| e.of_input(name))?;
    builder.finish(name)
}

/// The format that the caller names, unless it is PDB and an input that may be endless starts without a record
/// of it: lines that are no records would be skipped to the end.
fn check(format: Format, head: &[u8]) -> Result<Format> {
    let is_seen = head.len() as u64 == HEAD_LEN;
    if format == Format::Pdb && is_seen && !matches!(detect::detect(head), Ok(detect::Format::Pdb)) {
        return Err(Error::malformed(format!("no record of PDB in the first {HEAD_LEN} bytes")));
    }
    Ok(format)
}

/// The format of an input that starts with `head`.
fn recognized(head: &[u8]) -> Result<Format> {
    if head.trim_ascii().is_empty() {
        return Err(Error::malformed("empty: found no atom and no point"));
    }
    Ok(match TESS3.detect(head)? {
        detect::Format::Pdb => Format::Pdb,
        detect::Format::Mmcif => Format::Mmcif,
        detect::Format::Xyz => Format::Xyz,
        detect::Format::Ply => Format::Ply,
        detect::Format::Obj | detect::Format::Sma | detect::Format::VertexLines => Format::Obj,
        detect::Format::Off => Format::Off,
        _ => Format::Points,
    })
}
