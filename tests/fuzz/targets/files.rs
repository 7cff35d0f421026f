//! Files of other programs.

use std::cell::OnceCell;
use std::io::{Cursor, Read};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use spmesh_formats::detect::SPHEIGHT;
use spmesh_formats::drivers::Format;
use spmesh_formats::las::{Changes, LasCopy};
use spmesh_formats::molecules::{Radii, read_structure_from};
use spmesh_formats::source::{
    AttributeChoice, Column, EventSource, Input, Interval, Plain, PointFile, RawType, Separator,
    SourceOptions, TextOptions, open_obj, open_ply, open_sma, open_smb, read_ply_surface, read_polylines,
    read_values,
};
use spmesh_formats::volumes::{
    Condition, From4, RawLayout, Request, Selection, Spacing, parse_sizes, read_points4,
};
use spmesh_molecules::tess3::Radius;
use spmesh_pipeline::finalize::Thin;
use spmesh_spacetime::dd4::{Quantum, TimeScale};
use spmesh_splines::splinefit::Smoothing;
use spmesh_stream::model::bounds::Bounds;
use tempfile::TempDir;

use crate::samples::INDEXED_LAS;

/// Most points of a pass over damaged input; then the pass ends.
const POINTS_MAX: usize = 1 << 20;

/// Points of any format, in the plane and in space.
pub fn points(bytes: &[u8]) {
    let path = file(bytes);
    for dims in [2, 3] {
        let attributes = if dims == 2 { AttributeChoice::All } else { AttributeChoice::default() };
        let (skip_invalid, salvage) = (dims == 3, dims == 3);
        pass(&path, SourceOptions { dims, skip_invalid, salvage, attributes, ..Default::default() });
    }
}

/// Points in a part of the plane, which an index of LAS, LAZ and COPC finds.
pub fn window(bytes: &[u8]) {
    let path = file_named("tile.las", bytes);
    drop(std::fs::remove_file(path.with_extension("lax")));
    pass_window(&path);
}

/// The index that LAStools write beside a file.
pub fn lax(bytes: &[u8]) {
    let path = file_named("tile.las", &std::fs::read(INDEXED_LAS).expect("a sample"));
    drop(file_named("tile.lax", bytes));
    pass_window(&path);
}

fn pass_window(path: &Path) {
    let Ok(input) = Input::open(&[path.to_path_buf()], &SourceOptions { dims: 2, ..Default::default() })
    else {
        return;
    };
    let Some(bounds) = input.description().stated_bounds else { return };
    let coordinates = input.description().coordinates;
    let [min, max] = [bounds.min, bounds.max].map(|corner| coordinates.to_world(corner));
    // The quarter at the lower left.
    let bounds = Bounds { min, max: [0.5 * (min[0] + max[0]), 0.5 * (min[1] + max[1]), max[2]] };
    pass(path, SourceOptions { dims: 2, bounds: Some(bounds), reach: Some(bounds), ..Default::default() });
}

/// One pass over the points of a file.
fn pass(path: &Path, options: SourceOptions) {
    let options = SourceOptions { threads: Some(NonZeroUsize::MIN), ..options };
    let Ok(input) = Input::open(&[path.to_path_buf()], &options) else { return };
    let Ok(mut reader) = input.read() else { return };
    let (mut batch, mut count) = (Vec::new(), 0);
    while count < POINTS_MAX && reader.next_batch(&mut batch).is_ok() && !batch.is_empty() {
        count += batch.len();
        let coordinates = input.description().coordinates;
        assert!(batch.iter().flatten().all(|&c| coordinates.can_store(c)), "{batch:?}");
    }
}

/// LAS and LAZ as they are, written again: the records are the same.
pub fn copy(bytes: &[u8]) {
    let open = |name: &str, bytes: &[u8]| {
        PointFile::open(&file_named(name, bytes), &SPHEIGHT, None, &TextOptions::default())
    };
    let Ok(PointFile::Las(source)) = open("tile.las", bytes) else { return };
    let changes = Changes { field: None, has_new_z: true, is_compressed: bytes.len().is_multiple_of(2) };
    let Ok(mut copy) = LasCopy::start(&source, Cursor::new(Vec::new()), &changes, 1, 1 << 20) else { return };
    let Ok(mut records) = source.records(1) else { return };
    let (mut batch, mut all) = (Vec::new(), Vec::new());
    while all.len() < POINTS_MAX && records.next(&mut batch).is_ok() && !batch.is_empty() {
        all.extend_from_slice(&batch);
        if copy.record_len() != source.record_len() || copy.write(&batch).is_err() {
            return;
        }
    }
    let Ok(written) = copy.finish() else { return };
    let Ok(PointFile::Las(written)) = open("copy.las", written.get_ref()) else { panic!("a sound file") };
    let mut records = written.records(1).expect("a sound file");
    let mut found = Vec::new();
    while records.next(&mut batch).map(|()| !batch.is_empty()).expect("a sound file") {
        found.extend_from_slice(&batch);
    }
    assert!(found == all, "{} bytes of records are not the {} that were read", found.len(), all.len());
}

/// Gzip, and what it holds.
pub fn gzip(bytes: &[u8]) {
    let plain = Plain::new(bytes).expect("memory can be read");
    let mut start = Vec::new();
    if plain.take(1 << 22).read_to_end(&mut start).is_ok() {
        points(bytes);
    }
}

/// Points and meshes of Isenburg's binary formats, which convert in whole.
pub fn binary(bytes: &[u8]) {
    points(bytes);
    if let Ok(mut events) = open_smb(Box::new(Cursor::new(bytes.to_vec())), "fuzz") {
        drain(&mut *events);
    }
}

/// Numbers without a header.
pub fn raw(bytes: &[u8]) {
    let path = file(bytes);
    for kind in ["f32le", "f64le", "f64be"] {
        let raw = Some(kind.parse::<RawType>().expect("a type"));
        pass(&path, SourceOptions { dims: 3, raw, salvage: true, skip_invalid: true, ..Default::default() });
    }
    let layout = "2x2x2x2:u8".parse().expect("a layout");
    let from = From4::Raw(path, layout);
    drop(read_points4(&Request {
        from,
        spacing: Spacing::Index,
        selection: Selection::default(),
        temp_dir: None,
        in_memory: true,
    }));
}

/// Tables of radii.
pub fn radii(bytes: &[u8]) {
    drop(Radii::read_from(bytes, "fuzz"));
}

/// Values of flags that have a grammar.
pub fn flags(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    drop(text.parse::<Column>());
    drop(text.parse::<Separator>());
    drop(text.parse::<Interval>());
    drop(text.parse::<RawType>());
    drop(text.parse::<RawLayout>());
    drop(text.parse::<Thin>());
    drop(text.parse::<Radius>());
    drop(text.parse::<Quantum>());
    drop(text.parse::<TimeScale>());
    drop(text.parse::<Smoothing>());
    drop(parse_sizes(&text));
}

/// PLY as a mesh and as points.
pub fn ply(bytes: &[u8]) {
    for dims in [2, 3] {
        if let Ok(mut events) = open_ply(Box::new(Cursor::new(bytes.to_vec())), "fuzz", dims) {
            drain(&mut *events);
        }
    }
    drop(read_ply_surface(bytes, "fuzz"));
    points(bytes);
}

/// OBJ as a mesh and as points.
pub fn obj(bytes: &[u8]) {
    drain(&mut *open_obj(Box::new(Cursor::new(bytes.to_vec())), "fuzz"));
    points(bytes);
}

/// Streaming meshes by Isenburg, as text and as bytes.
pub fn sma(bytes: &[u8]) {
    if let Ok(mut events) = open_sma(Box::new(Cursor::new(bytes.to_vec())), "fuzz") {
        drain(&mut *events);
    }
    if let Ok(mut events) = open_smb(Box::new(Cursor::new(bytes.to_vec())), "fuzz") {
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

/// XYZ, PQR, OFF, and formats that are detected by content.
pub fn molecule(bytes: &[u8]) {
    structure(bytes, Some(Format::Pqr));
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
        let request = Request { from: from.clone(), spacing, selection, temp_dir: None, in_memory: true };
        if let Ok(points) = read_points4(&request) {
            assert!(points.points.as_flattened().iter().all(|c| c.is_finite()));
            assert!(points.values.is_none_or(|values| values.len() == points.points.len()));
        }
    }
}

/// Polylines as text or GeoJSON, and values beside points.
pub fn polylines(bytes: &[u8]) {
    if let Ok((polylines, ..)) = read_polylines(&file(bytes)) {
        assert!(polylines.iter().flat_map(|line| line.vertices.as_flattened()).all(|c| c.is_finite()));
    }
    drop(read_values(bytes));
}

/// Conditions on points.
pub fn condition(bytes: &[u8]) {
    drop(String::from_utf8_lossy(bytes).parse::<Condition>());
}

/// A file with the bytes; the next call of this thread replaces it.
pub fn file(bytes: &[u8]) -> PathBuf {
    file_named("input", bytes)
}

/// A file with a name and the bytes; the next call of this thread with the name replaces it.
pub fn file_named(name: &str, bytes: &[u8]) -> PathBuf {
    thread_local! {
        static FOLDER: OnceCell<TempDir> = const { OnceCell::new() };
    }
    let path = FOLDER.with(|folder| {
        folder.get_or_init(|| tempfile::tempdir().expect("a temporary folder")).path().join(name)
    });
    std::fs::write(&path, bytes).expect("a temporary file");
    path
}
