//! Lines, polygons and coordinate reference systems of other programs.

use std::fs;

use spmesh_formats::crs::{System, differences, geotiff_keys, name};
use spmesh_formats::source::{read_breaklines, read_mask, read_polygons};
use spmesh_stream::Crs;

use crate::files::{file, file_named};
use crate::samples::{LINES_GPKG, blobs};

/// Lines and polygons of any format.
pub fn lines(bytes: &[u8]) {
    let path = file(bytes);
    for read in [read_breaklines, read_polygons] {
        if let Ok(found) = read(&path) {
            let places = found.lines.iter().flat_map(|line| line.vertices.as_flattened());
            assert!(places.into_iter().all(|c| c.is_finite()));
        }
    }
    drop(read_mask(bytes));
}

/// A Shapefile and its table: two bytes state the length of the table, which comes first.
pub fn shapefile(bytes: &[u8]) {
    let Some((&len, rest)) = bytes.split_first_chunk() else { return };
    let (table, shapes) = rest.split_at(usize::from(u16::from_le_bytes(len)).min(rest.len()));
    drop(file_named("shapes.dbf", table));
    let path = file_named("shapes.shp", shapes);
    drop(read_breaklines(&path));
    drop(read_polygons(&path));
}

/// A whole database.
pub fn geopackage(bytes: &[u8]) {
    let path = file_named("lines.gpkg", bytes);
    drop(read_breaklines(&path));
    drop(read_polygons(&path));
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
