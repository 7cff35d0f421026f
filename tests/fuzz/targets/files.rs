//! Files of other programs.

use std::cell::OnceCell;
use std::io::Cursor;
use std::num::NonZeroUsize;
use std::path::PathBuf;

use spmesh_io::source::points4::{Condition, From4, Request, Selection, Spacing, read_points4};
use spmesh_io::source::structure::{Format, read_structure_from};
use spmesh_io::source::{
    EventSource, Input, SourceOptions, open_obj, open_ply, open_sma, open_smb, read_polylines, read_values,
};
use tempfile::TempDir;

/// Most points of a pass over damaged input; then the pass ends.
const POINTS_MAX: usize = 1 << 20;

/// Points of any format, in the plane and in space.
pub fn points(bytes: &[u8]) {
    let path = file(bytes);
    for dims in [2, 3] {
        let threads = Some(NonZeroUsize::MIN);
        let options = SourceOptions { dims, skip_invalid: dims == 3, threads, ..Default::default() };
        let Ok(input) = Input::open(std::slice::from_ref(&path), &options) else { continue };
        let Ok(mut reader) = input.read() else { continue };
        let (mut batch, mut count) = (Vec::new(), 0);
        while count < POINTS_MAX && reader.next_batch(&mut batch).is_ok() && !batch.is_empty() {
            count += batch.len();
            let coordinates = input.description().coordinates;
            assert!(batch.iter().flatten().all(|&c| coordinates.can_store(c)), "{batch:?}");
        }
    }
}

/// PLY as a mesh and as points.
pub fn ply(bytes: &[u8]) {
    for dims in [2, 3] {
        if let Ok(mut events) = open_ply(Cursor::new(bytes.to_vec()), "fuzz", dims) {
            drain(&mut *events);
        }
    }
    points(bytes);
}

/// OBJ as a mesh and as points.
pub fn obj(bytes: &[u8]) {
    drain(&mut *open_obj(Cursor::new(bytes.to_vec()), "fuzz"));
    points(bytes);
}

/// Streaming meshes by Isenburg, as text and as bytes.
pub fn sma(bytes: &[u8]) {
    if let Ok(mut events) = open_sma(Cursor::new(bytes.to_vec()), "fuzz") {
        drain(&mut *events);
    }
    if let Ok(mut events) = open_smb(Cursor::new(bytes.to_vec()), "fuzz") {
        drain(&mut *events);
    }
}

fn drain(events: &mut dyn EventSource) {
    while let Ok(Some(_)) = events.next_event() {}
}

/// PDB.
pub fn pdb(bytes: &[u8]) {
    structure(bytes, Some(Format::Pdb));
}

/// mmCIF.
pub fn mmcif(bytes: &[u8]) {
    structure(bytes, Some(Format::Mmcif));
}

/// XYZ, OFF, and formats that are detected by content.
pub fn molecule(bytes: &[u8]) {
    structure(bytes, Some(Format::Xyz));
    structure(bytes, Some(Format::Off));
    structure(bytes, None);
}

fn structure(bytes: &[u8], format: Option<Format>) {
    let read = || read_structure_from(Cursor::new(bytes.to_vec()), "fuzz", format);
    let Ok(structure) = read() else { return };
    let assembly = structure.assemblies.names().first().map(|name| (*name).to_string());
    if let Some(assembly) = assembly {
        drop(structure.assembled(&assembly));
    }
}

/// Volumes that change over time: NRRD, NIfTI, text.
pub fn volume(bytes: &[u8]) {
    let from = From4::File(file(bytes));
    for spacing in [Spacing::Index, Spacing::World] {
        let selection = Selection::default();
        let request = Request { from: from.clone(), spacing, selection, temp_dir: None };
        if let Ok(points) = read_points4(&request) {
            assert!(points.points.as_flattened().iter().all(|c| c.is_finite()));
            assert!(points.values.is_none_or(|values| values.len() == points.points.len()));
        }
    }
}

/// Polylines as text or GeoJSON, and values beside points.
pub fn polylines(bytes: &[u8]) {
    if let Ok(polylines) = read_polylines(bytes) {
        assert!(polylines.iter().flat_map(|line| line.vertices.as_flattened()).all(|c| c.is_finite()));
    }
    drop(read_values(bytes));
}

/// Conditions on points.
pub fn condition(bytes: &[u8]) {
    drop(String::from_utf8_lossy(bytes).parse::<Condition>());
}

/// A file with the bytes; the next call of this thread replaces it.
fn file(bytes: &[u8]) -> PathBuf {
    thread_local! {
        static FOLDER: OnceCell<TempDir> = const { OnceCell::new() };
    }
    let path = FOLDER.with(|folder| {
        folder.get_or_init(|| tempfile::tempdir().expect("a temporary folder")).path().join("input")
    });
    std::fs::write(&path, bytes).expect("a temporary file");
    path
}
