//! Refuses names of outputs whose ending stands for a format that a program does not write.
//!
//! An ending that stands for nothing here is as good as none: the output then has the format that flags
//! choose, or the usual one.

use std::path::Path;

use spmesh_base::error::{Error, Result};
use spmesh_base::places::is_device;

/// Streams of spmesh.
pub const STREAM: &[&str] = &["spm"];
/// Plans, and manifests of meshes in parts.
pub const JSON: &[&str] = &["json"];
/// Rasters.
pub const RASTER: &[&str] = &["tif", "tiff", "asc"];
/// Lines.
pub const LINES: &[&str] = &["geojson", "json", "geojsonl", "ndjson"];
/// Pictures.
pub const PICTURE: &[&str] = &["svg", "png", "html", "htm"];
/// Tables of text.
pub const TABLE: &[&str] = &["tsv", "csv", "txt", "xyz", "json"];
/// Tables of numbers with blanks between them.
pub const NUMBERS: &[&str] = &["txt", "xyz", "dat"];
/// Arrays of numpy.
pub const ARRAY: &[&str] = &["npy"];
/// Sparse matrices.
pub const MATRIX: &[&str] = &["mtx", "npz"];
/// Meshes of other programs.
pub const MESH: &[&str] = &["vtu", "mesh", "ply", "obj"];

/// What endings stand for.
const MEANINGS: [(&str, &[&str]); 17] = [
    ("a stream of spmesh", STREAM),
    ("a raster", RASTER),
    (
        "a raster or a picture of another program",
        &["jpg", "jpeg", "gif", "bmp", "webp", "jp2", "vrt", "img", "bil", "flt", "hdr", "grd", "nc"],
    ),
    ("lines or polygons", LINES),
    ("vector data of another program", &["shp", "gpkg", "gml", "kml", "kmz", "dxf", "wkt", "fgb", "parquet"]),
    ("a picture", PICTURE),
    ("a document", &["pdf", "eps", "ps"]),
    ("a table", TABLE),
    ("a table of JSON Lines", &["jsonl"]),
    ("a table of another program", &["xls", "xlsx", "ods"]),
    ("an array of numpy", ARRAY),
    ("a sparse matrix or several arrays", MATRIX),
    ("arrays of another program", &["mat", "h5", "hdf5", "pkl", "pickle", "feather"]),
    ("points", &["las", "laz", "e57", "pcd", "pts", "ptx", "spa", "spb", "pdb", "cif"]),
    ("a mesh", MESH),
    ("a mesh of another program", &["sma", "smb", "off", "stl", "vtk", "vtp", "vts", "glb", "gltf", "msh"]),
    ("a compressed file", &["gz", "zip", "zst", "bz2", "xz", "7z", "tar", "lz4"]),
];

/// Checks that the ending of a name does not stand for a format other than `own`.
///
/// # Errors
/// Usage, if it does.
pub fn check(path: &Path, own: &[&[&str]]) -> Result<()> {
    let Some(ending) = path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase)
    else {
        return Ok(());
    };
    let stands_in = |endings: &[&str]| endings.contains(&&ending[..]);
    // A device such as /dev/fd/3.json has no format.
    if own.iter().any(|endings| stands_in(endings)) || is_device(path) {
        return Ok(());
    }
    let Some((meaning, _)) = MEANINGS.iter().find(|(_, endings)| stands_in(endings)) else { return Ok(()) };
    let known: Vec<String> =
        own.iter().flat_map(|endings| endings.iter()).map(|own| format!(".{own}")).collect();
    let what = format!("the name is that of {meaning}, this program writes {}", list(&known));
    Err(Error::usage(what).of_input(path.display().to_string()))
}

/// `a`, `a or b`, `a, b or c`.
fn list(names: &[String]) -> String {
    match names {
        [] => String::new(),
        [name] => name.clone(),
        [first @ .., last] => format!("{} or {last}", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endings_of_other_formats_are_refused() {
        for (name, own) in [
            ("a.spm", STREAM),
            ("a.TIF", RASTER),
            ("a", STREAM),
            ("a.b/c", STREAM),
            ("-", RASTER),
            ("a.out", RASTER),
            ("/dev/fd/3.png", STREAM),
        ] {
            check(Path::new(name), &[own]).unwrap();
        }
        for (name, part) in [
            ("a.jpg", ".tif, .tiff or .asc"),
            ("a.tif.gz", "compressed"),
            ("a.spm", "a stream"),
            ("/dev/shm/a.png", "a picture"),
        ] {
            let error = check(Path::new(name), &[RASTER]).unwrap_err();
            assert!(error.exit_code() == 2 && error.to_string().contains(part), "{error}");
        }
    }

    #[test]
    fn no_ending_stands_for_two_formats() {
        let mut all: Vec<&str> = MEANINGS.iter().flat_map(|(_, endings)| endings.iter().copied()).collect();
        // JSON is lines, or a table.
        all.sort_unstable();
        let before = all.len();
        all.dedup();
        assert_eq!(before - all.len(), 1);
    }
}
