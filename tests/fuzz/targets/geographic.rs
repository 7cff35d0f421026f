//! Lines, polygons and coordinate reference systems of other programs.

use std::fs;
use std::path::Path;

use spmesh_formats::crs::{System, differences, geotiff_keys, name};
use spmesh_formats::source::{Reading, read_breaklines, read_polygons};
use spmesh_stream::{Coordinates, Crs};

use crate::files::{file, file_named};
use crate::samples::{LINES_GPKG, blobs};

/// Lines and polygons of any format.
pub fn lines(bytes: &[u8]) {
    read_both(&file(bytes));
}

fn read_both(path: &Path) {
    if let Ok(found) =
        read_breaklines(path, &Reading { elevation: Some("elev".into()), ..Reading::default() })
    {
        assert!(found.lines.iter().all(|line| are_finite(&line.vertices)));
    }
    if let Ok((found, _)) = read_polygons(&[path.to_path_buf()], &Coordinates::F64, &Crs::Unknown, u64::MAX) {
        assert!(found.iter().flatten().all(|ring| are_finite(ring)));
    }
}

fn are_finite(vertices: &[[f64; 2]]) -> bool {
    vertices.as_flattened().iter().all(|c| c.is_finite())
}

/// A Shapefile and its table: two bytes state the length of the table, which comes first.
pub fn shapefile(bytes: &[u8]) {
    let Some((&len, rest)) = bytes.split_first_chunk() else { return };
    let (table, shapes) = rest.split_at(usize::from(u16::from_le_bytes(len)).min(rest.len()));
    drop(file_named("shapes.dbf", table));
    read_both(&file_named("shapes.shp", shapes));
}

/// A whole database.
pub fn geopackage(bytes: &[u8]) {
    read_both(&file_named("lines.gpkg", bytes));
}

/// A database whose geometries are those bytes, as far as they go.
pub fn wkb(bytes: &[u8]) {
    let mut database = fs::read(LINES_GPKG).expect("a sample");
    let mut rest = bytes;
    for blob in blobs(&database) {
        let (head, tail) = rest.split_at(blob.len().min(rest.len()));
        database[blob][..head.len()].copy_from_slice(head);
        rest = tail;
    }
    geopackage(&database);
}

/// Text, and the same bytes as the records of GeoTIFF: two bytes state the length of the directory, the next
/// two that of the doubles.
pub fn crs(bytes: &[u8]) {
    examine(&Crs::Wkt(String::from_utf8_lossy(bytes).into_owned()));
    let Some((&[d0, d1, n0, n1], rest)) = bytes.split_first_chunk() else { return };
    let [directory, doubles] = [[d0, d1], [n0, n1]].map(|len| usize::from(u16::from_le_bytes(len)));
    let (directory, rest) = rest.split_at(directory.min(rest.len()));
    let (doubles, ascii) = rest.split_at(doubles.min(rest.len()));
    examine(&Crs::GeoKeys {
        directory: directory.to_vec(),
        doubles: doubles.to_vec(),
        ascii: ascii.to_vec(),
    });
}

fn examine(crs: &Crs) {
    let system = System::of(crs);
    drop(name(crs));
    assert!(differences(&system, &system).is_empty(), "{system:?}");
    drop(geotiff_keys(&system, true));
}
