//! Wrong usage, streams that are not meshes in the plane, damaged input, and outputs that cannot be written.

use spmesh_formats::raster::{Grid, RasterFormat};
use spmesh_stream::Coordinates;
use spmesh_terrain::dem::Quantity;

use super::{Mesh, file, options};
use crate::programs::{
    Folder, assert_damage_leaves_no_file, assert_outcome, assert_silent_without_reader, cloud, mesh_of_cloud,
    run, skip,
};

/// A mesh of scattered points.
fn mesh() -> Vec<u8> {
    mesh_of_cloud(3_000)
}

fn check(cases: &[(&[&str], &[u8], i32, &str)]) {
    cases
        .iter()
        .for_each(|(arguments, input, code, part)| assert_outcome("spdem", arguments, input, *code, part));
}

#[test]
fn each_failure_has_its_exit_code() {
    let mesh = mesh();
    let null = ["-o", "/dev/null"];
    let with = |arguments: &[&'static str]| -> Vec<&'static str> { [arguments, &null].concat() };
    check(&[
        (&["no/such/file"], b"", 1, "no/such/file"),
        (&null, b"", 3, "stdin: header at byte 0: the input is empty"),
        (&null, b"1 2 3\n4 5 6\n", 3, "not those of a spmesh stream"),
        (&with(&["--fill", "0"]), &mesh, 2, "0 is not in 1..=256"),
        (&with(&["--fill", "257"]), &mesh, 2, "257 is not in 1..=256"),
        (&with(&["--no-data", "inf"]), &mesh, 2, "a finite number of 32 bits, or nan"),
        (&with(&["--no-data", "none"]), &mesh, 2, "invalid float literal"),
        (&with(&["--cog", "--format", "asc"]), &mesh, 2, "--cog is for GeoTIFF"),
        (&with(&["--align", "0,0"]), &mesh, 2, "--step <S>"),
        (&with(&["--align", "0,inf", "--step", "1"]), &mesh, 2, "inf: both must be finite"),
        (&with(&["--align", "1e20,0", "--step", "1"]), &mesh, 2, "too far away"),
        (&with(&["--like", "no/such/file"]), &mesh, 1, "no/such/file"),
        (&with(&["--like", "Cargo.toml"]), &mesh, 3, "cannot be read as TIFF"),
        (&with(&["--like", "x.tif", "--step", "1"]), &mesh, 2, "cannot be used with"),
        (&with(&["--step", "0"]), &mesh, 2, "must be finite and above zero"),
        (&with(&["--step", "-3"]), &mesh, 2, "must be finite and above zero"),
        (&with(&["--step", "nan"]), &mesh, 2, "must be finite and above zero"),
        (&with(&["--step", "inf"]), &mesh, 2, "must be finite and above zero"),
        (&with(&["--step", "1e-9"]), &mesh, 2, "take larger cells"),
        (&with(&["--step", "0.01"]), &mesh, 2, "tiles, at most"),
        (&with(&["--step", "1", "--columns", "5"]), b"", 2, "cannot be used with"),
        (&with(&["--bounds", "3,0,1,1"]), &mesh, 2, "bounds 3,0,1,1 are empty"),
        (&with(&["--kill", "0"]), &mesh, 2, "a length above zero"),
        (&with(&["--kill", "nan"]), &mesh, 2, "a length above zero"),
        (&with(&["--light", "0,90"]), &mesh, 2, "--kind hillshade"),
        (&with(&["--kind", "hillshade", "--light", "0,inf"]), &mesh, 2, "two angles"),
        (&with(&["--multidirectional"]), &mesh, 2, "--kind hillshade"),
        (&with(&["--range", "0,1"]), &mesh, 2, "--kind shaded-relief"),
        (&with(&["--kind", "shaded-relief", "--range", "1,1"]), &mesh, 2, "--range"),
        (&with(&["--kind", "shaded-relief", "--method", "triangle"]), &mesh, 2, "leave out"),
        (&with(&["--kind", "shaded-relief", "--format", "asc"]), &mesh, 2, "write .tif"),
        (&with(&["--kind", "hillshade", "--no-data", "7"]), &mesh, 2, "leave out --no-data"),
        (&with(&["--method", "horn"]), &mesh, 2, "add --kind"),
        (&with(&["--memory", "none"]), &mesh, 2, "none"),
        (&["-o", "/no/such/folder/x.tif"], &mesh, 1, "/no/such/folder"),
    ]);
}

#[test]
fn other_streams_are_refused() {
    let run_of = |name: &str, arguments: &[&str], input: &[u8]| run(name, arguments, input).stdout;
    let points = run_of("spfinalize", &["-"], cloud(500).as_bytes());
    let part = run_of("spdelaunay2d", &["--partial", "--region", "0,0,50000,50000"], &points);
    let flat = run_of("spfinalize", &["-"], b"0 0\n5 0\n0 5\n");
    let flat = run_of("spdelaunay2d", &[], &flat);
    let space = run_of("spfinalize", &["--octree", "-"], cloud(100).as_bytes());
    let tetrahedra = run_of("spdelaunay3d", &[], &space);
    let line = run_of("spfinalize", &["-"], b"0 0 1\n1 1 1\n");
    let line = run_of("spdelaunay2d", &[], &line);
    let ply = run_of("spconvert", &["--to", "ply"], &mesh());
    let unbounded = run_of("spconvert", &["--to", "spm"], &ply);
    let step: &[&str] = &["--step", "100", "-o", "/dev/null"];
    check(&[
        (step, &points, 2, "triangulate them with spdelaunay2d"),
        (step, &part, 2, "spdelaunay2d --merge"),
        (step, &flat, 2, "no elevation"),
        (step, &tetrahedra, 2, "tetrahedral mesh, expected a triangle mesh"),
        (step, &unbounded, 2, "does not say where the mesh is: give --bounds"),
        (&["--step", "1", "--bounds", "0,0,9,9", "--format", "asc"], &line, 0, "none of which has data"),
        (
            &["--step", "1", "--bounds", "-9,-9,-1,-1", "--format", "asc"],
            &unbounded,
            0,
            "none of which has data",
        ),
    ]);
}

#[test]
fn what_is_no_mesh_in_the_plane_is_malformed() {
    let grid = Grid { left: 0.0, top: 10.0, step: 1.0, columns: 10, rows: 10 };
    let points = vec![[0.0, 0.0, 1.0], [10.0, 0.0, 2.0], [0.0, 10.0, 3.0], [10.0, 10.0, 4.0]];
    let of = |triangles: &[[u32; 3]]| {
        let stream = Mesh { points: points.clone(), triangles: triangles.to_vec() }.stream(Coordinates::F64);
        [RasterFormat::Ascii, RasterFormat::GeoTiff].map(|format| {
            let outcome = file(&stream, format, &grid, &options(Quantity::Elevation));
            outcome.map_or_else(|error| (error.exit_code(), error.to_string()), |_| (0, String::new()))
        })
    };
    let is = |found: [(u8, String); 2], part: &str| {
        found.iter().for_each(|(code, text)| assert!(*code == 3 && text.contains(part), "{code}: {text}"));
    };
    assert_eq!(of(&[[0, 1, 3], [0, 3, 2]]).map(|(code, _)| code), [0, 0]);
    is(of(&[[0, 3, 1], [0, 3, 2]]), "is clockwise");
    is(of(&[[0, 1, 3], [0, 1, 2], [0, 3, 2]]), "triangles overlap");
    // Here the tile is complete before the overlapping triangle arrives.
    is(of(&[[0, 1, 3], [0, 3, 2], [0, 1, 2]]), "triangles overlap");
}

#[test]
fn numbers_that_cells_cannot_hold_are_refused() {
    let grid = Grid { left: 0.0, top: 1.0, step: 1.0, columns: 1, rows: 1 };
    let message = |points: [[f64; 3]; 3], quantity: Quantity| {
        let stream = Mesh { points: points.to_vec(), triangles: vec![[0, 1, 2]] }.stream(Coordinates::F64);
        file(&stream, RasterFormat::Ascii, &grid, &options(quantity)).unwrap_err().to_string()
    };
    let high = [[0.0, 0.0, 1e39], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
    assert!(message(high, Quantity::Elevation).contains("1e39 is too great for a raster"));
    let wide = [[-1e300, -1e300, 0.0], [1e300, -1e300, 1.0], [0.0, 1e300, 2.0]];
    for quantity in [Quantity::Elevation, Quantity::Slope] {
        let found = message(wide, quantity.clone());
        assert!(found.contains("too great or too small to interpolate between"), "{quantity:?}: {found}");
    }
}

#[test]
fn damaged_streams_leave_no_file() {
    assert_damage_leaves_no_file("spdem", &["--step", "1000"], ["old.tif", "new.asc"], &mesh());
}

#[test]
fn closed_pipes_are_silent_and_full_disks_are_not() {
    let (folder, mesh) = (Folder::new(), mesh());
    let name = folder.write("mesh.spm", &mesh);
    assert_silent_without_reader("spdem", &["-q", "--step", "100", "--format", "asc", &name]);
    if !std::path::Path::new("/dev/full").exists() {
        skip("there is no /dev/full");
        return;
    }
    let step: &[&str] = &["--step", "100", "-o", "/dev/full"];
    check(&[
        (&[step, &["--format", "asc"]].concat(), &mesh, 1, "No space left on device"),
        (&[step, &["--format", "tif"]].concat(), &mesh, 1, "No space left on device"),
        (
            &["--step", "100", "--memory", "1K", "--temp-dir", "/no/such/folder", "-o", "/dev/null"],
            &mesh,
            1,
            "temporary file in /no/such/folder",
        ),
    ]);
}
