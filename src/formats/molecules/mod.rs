//! Molecular structures and files of points in space: PDB, PQR, mmCIF, BinaryCIF, GRO, XYZ, text of points,
//! streams of this project and their text twins, PLY, OBJ, OFF and VTK, each plain or compressed with gzip.
//! The content tells the format.
//!
//! The readers are this project's own. The crate `pdbtbx` panics on some files of the test data, rejects
//! others whose atoms are all intact, and takes longer than the triangulation.

pub(crate) mod assemblies;
pub(crate) mod assembly;
pub(crate) mod atoms;
pub(crate) mod binary_cif;
pub(crate) mod binary_columns;
pub(crate) mod builder;
pub(crate) mod cif;
pub(crate) mod classes;
pub(crate) mod conformers;
pub(crate) mod decimal;
pub(crate) mod elements;
pub(crate) mod frames;
pub(crate) mod gro;
pub(crate) mod guess;
pub(crate) mod identity;
pub(crate) mod joined;
pub(crate) mod locations;
pub(crate) mod mmcif;
pub(crate) mod mmcif_tables;
pub(crate) mod model;
pub(crate) mod motion;
pub(crate) mod msgpack;
pub(crate) mod names;
pub(crate) mod off;
pub(crate) mod operators;
pub(crate) mod pdb;
pub(crate) mod pdb_assemblies;
pub(crate) mod pdb_header;
pub(crate) mod periodic_box;
pub(crate) mod points;
pub(crate) mod pqr;
pub(crate) mod radii;
pub(crate) mod residue_list;
pub(crate) mod residue_names;
pub(crate) mod selection;
pub(crate) mod serial;
pub(crate) mod write;
pub(crate) mod xyz;

use std::io::{Cursor, Read};
use std::path::Path;

pub use assemblies::Assemblies;
pub use classes::Class;
pub use frames::{Content, Frame, FrameRange, FrameReader};
pub use model::{Atom, AtomView, Model, Residue, Structure};
pub use names::{Name, Names};
pub use periodic_box::{PeriodicBox, StatedBox};
pub use radii::{LoadedRadii, Radii, RadiusCounts, RadiusFinder, RadiusOrigin};
pub use residue_list::ResidueList;
pub use selection::{Altlocs, Atoms, Models, Selected, Selection};
pub use write::{WrittenAtom, write_mmcif, write_pdb, written_atoms};

use self::builder::StructureBuilder;
use crate::source::gzip::Plain;
use crate::source::origin::open_stdin;
use crate::text::lines::Lines;

use crate::detect::{self, HEAD_LEN, TESS3, read_head};
use crate::drivers::{AnyInput, Format};
use crate::obj::read::open_obj;
use crate::ply::read::open_ply;
use spmesh_base::error::{Error, Result};
use spmesh_base::inputs;
use spmesh_base::limits::STRUCTURE_LINE_MAX;
use spmesh_stream::Coordinates;

/// Reads the structure or the points in the file `path`; "-" is standard input. Without `format`, the content
/// tells the format; with [`Format::Text`], it tells which format of points without names it is.
///
/// Cost: one pass. Memory: 56 bytes per atom, and 24 per point without names. Points of such a
/// format in an input that is not a regular file, and compressed LAS and VTK files, are copied to an unlinked
/// temporary file first.
///
/// # Errors
/// If the file cannot be read; [`spmesh_base::error::ErrorKind::Malformed`], with file and line (or byte), if
/// it is damaged, has no atom, or is of no known format.
pub fn read_structure(path: &Path, format: Option<Format>) -> Result<Structure> {
    let (input, name) = opened(path)?;
    let is_file = path.as_os_str() != "-" && path.is_file();
    read(input, &name, format, is_file.then_some(path))
}

/// The input `path`, or stdin, and its name.
fn opened(path: &Path) -> Result<(AnyInput, String)> {
    if path.as_os_str() == "-" {
        return Ok((Box::new(open_stdin()?), "stdin".to_string()));
    }
    let name = path.display().to_string();
    let file = inputs::open(path).map_err(|e| e.of_input(&name))?;
    Ok((Box::new(file), name))
}

/// As [`read_structure`], from any reader. Messages call the input `name`.
///
/// # Errors
/// As [`read_structure`].
pub fn read_structure_from(
    input: impl Read + Send + 'static,
    name: &str,
    format: Option<Format>,
) -> Result<Structure> {
    read(input, name, format, None)
}

/// Reads `input`. `path` is a regular file with the same content, if there is one.
fn read(
    input: impl Read + Send + 'static,
    name: &str,
    format: Option<Format>,
    path: Option<&Path>,
) -> Result<Structure> {
    let (head, input) = plain_with_head(input, name)?;
    let format = format.map_or_else(|| recognized(&head), |format| check(format, &head));
    let format = format.map_err(|e| e.of_input(name))?;
    if format.row().atoms.is_some() {
        return finished(format, input, name);
    }
    let lines = |input| Lines::with_longest(input, name, STRUCTURE_LINE_MAX);
    match format {
        Format::Ply => points::read_events(open_ply(input, name, 3)?, name),
        Format::Obj | Format::Sma | Format::VertexLines => points::read_events(open_obj(input, name), name),
        Format::Off => points::structure(off::read(&mut lines(input))?, Coordinates::F64, name, Vec::new()),
        _ => match (points::mesh(&head), path) {
            (Some(open), _) => points::read_events(open(input, name, 3)?, name),
            (None, Some(path)) => points::read_file(path),
            (None, None) => points::read_copy(input, name),
        },
    }
}

/// The first bytes of the decompressed input, and all of them.
fn plain_with_head(input: impl Read + Send + 'static, name: &str) -> Result<(Vec<u8>, AnyInput)> {
    let reading = |e| Error::io("reading", e).of_input(name);
    let mut input = Plain::held(input).map_err(reading)?;
    let head = read_head(&mut input).map_err(reading)?;
    Ok((head.clone(), Box::new(Cursor::new(head).chain(input))))
}

/// The structure of an input of a format of structures.
fn finished(format: Format, input: AnyInput, name: &str) -> Result<Structure> {
    let read = format.row().atoms.expect("a format of structures");
    let mut builder = StructureBuilder::default();
    let lines = Lines::with_longest(input, name, STRUCTURE_LINE_MAX);
    read(lines, &mut builder).map_err(|e| e.of_input(name))?;
    builder.finish(name)
}

/// The format that the caller names, unless it is PDB and an input that may be endless starts without a
/// record of it: lines that are no records would be skipped to the end.
fn check(format: Format, head: &[u8]) -> Result<Format> {
    let is_seen = head.len() as u64 == HEAD_LEN;
    if format == Format::Pdb && is_seen && !matches!(detect::detect(head), Ok(Format::Pdb)) {
        return Err(Error::malformed(format!("no record of PDB in the first {HEAD_LEN} bytes")));
    }
    Ok(format)
}

/// The format of an input that starts with `head`.
fn recognized(head: &[u8]) -> Result<Format> {
    if head.trim_ascii().is_empty() {
        return Err(Error::malformed("empty: found no atom and no point"));
    }
    TESS3.detect(head)
}
