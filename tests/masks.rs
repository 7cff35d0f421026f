//! Masks: the formats and systems of `--mask`, in each program that has it.

use crate::programs::{Folder, assert_outcome, outcome, run, sample};
use crate::sources::las_file::LasFile;

/// The corners of the pond in `lines.gpkg`, which is in [`SYSTEM`].
const POND: [[f64; 2]; 5] = [[6.0, 5.0], [8.0, 5.0], [8.0, 7.0], [6.0, 7.0], [6.0, 5.0]];
const SYSTEM: &str = "EPSG:25832";

/// Corners of the ground, and a tree in the pond: steps of 0.01.
const GROUND: [[i32; 3]; 5] = [[0, 0, 0], [1200, 0, 0], [0, 1200, 900], [1200, 1200, 900], [640, 610, 700]];

/// A program that leaves out what is outside of a mask, with a mesh and points.
struct Program<'a> {
    name: &'a str,
    arguments: Vec<&'a str>,
}

/// The programs for a mesh in a file. Points state no system.
fn programs<'a>(mesh: &'a str, points: &'a str) -> Vec<Program<'a>> {
    let program = |name, arguments: &[&'a str]| Program { name, arguments: arguments.to_vec() };
    vec![
        program("spdem", &["--step", "0.5", "--format", "asc", mesh]),
        program("spdem", &["--contours", "0.5", mesh]),
        program("spview", &["--width", "320", mesh]),
        program("spcanopy", &["--step", "0.5", "--ground", mesh, points]),
    ]
}

fn mesh(folder: &Folder, system: &str) -> String {
    let points = run("spfinalize", &["-q", "--crs", system, "-"], &LasFile::of(&GROUND).bytes());
    let mesh = run("spdelaunay2d", &["-q"], &points.stdout);
    assert!(mesh.status.success(), "{:?}", outcome(&mesh));
    folder.write(&format!("{}.spm", system.replace(':', "")), mesh.stdout)
}

fn geojson(crs: &str) -> String {
    let ring: Vec<String> = POND.iter().map(|[x, y]| format!("[{x},{y},1]")).collect();
    format!(
        r#"{{"type":"FeatureCollection",{crs}"features":[{{"type":"Feature","properties":{{}},"geometry":
        {{"type":"Polygon","coordinates":[[{}]]}}}}]}}"#,
        ring.join(",")
    )
}

/// The member that states [`SYSTEM`].
const MEMBER: &str = r#""crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::25832"}},"#;

/// The main file of a Shapefile with the pond.
fn shapefile() -> Vec<u8> {
    let numbers = |values: &[f64]| values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>();
    let bounds = numbers(&[6.0, 5.0, 8.0, 7.0]);
    let integers = |values: &[i32]| values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>();
    let places = numbers(POND.as_flattened());
    let record = [&integers(&[5])[..], &bounds, &integers(&[1, 5, 0]), &places].concat();
    // Lengths are in words of two bytes.
    let [len, record_len] = [108 + record.len(), record.len()].map(|len| (len as i32 / 2).to_be_bytes());
    let head = [&[0, 0, 0x27, 0x0a][..], &[0; 20], &len, &integers(&[1000, 5]), &bounds, &[0; 32]].concat();
    [&head[..], &1i32.to_be_bytes(), &record_len, &record].concat()
}

/// A GeoPackage with the pond. Its lines are marked as empty.
fn geopackage() -> Vec<u8> {
    let mut bytes = std::fs::read(sample("lines.gpkg")).expect("a sample");
    for at in 0..bytes.len() - 13 {
        // The type is in the last four bytes: a line with z, little-endian.
        if bytes[at..].starts_with(b"GP\0\x01") && bytes[at + 9..at + 13] == 1002u32.to_le_bytes() {
            bytes[at + 3] |= 16;
        }
    }
    bytes
}

/// Files with the pond that state its system.
fn masks(folder: &Folder) -> [String; 3] {
    folder.file("pond.prj", std::fs::read(sample("lines.prj")).expect("a sample"));
    [
        folder.write("pond.geojson", geojson(MEMBER)),
        folder.write("pond.shp", shapefile()),
        folder.write("pond.gpkg", geopackage()),
    ]
}

#[test]
fn all_formats_are_one_mask_in_all_programs() {
    let folder = Folder::new();
    let points = folder.write("points.las", LasFile::of(&GROUND).bytes());
    let ground = mesh(&folder, SYSTEM);
    let corners: Vec<String> = POND.iter().map(|[x, y]| format!("{x} {y}")).collect();
    let text = folder.write("pond.wkt", format!("POLYGON(({}))", corners.join(",")));
    for Program { name, arguments } in programs(&ground, &points) {
        let masked = |mask: &str| {
            let output = run(name, &[&arguments[..], &["--mask", mask]].concat(), b"");
            assert!(output.status.success(), "{name} {mask}: {:?}", outcome(&output));
            let (_, message) = outcome(&output);
            (output.stdout, message.contains("the lines state no coordinate reference system: taking them"))
        };
        let (expected, is_assumed) = masked(&text);
        assert!(is_assumed, "{name}");
        assert!(run(name, &arguments, b"").stdout != expected, "{name}");
        for mask in &masks(&folder) {
            assert!(masked(mask) == (expected.clone(), false), "{name} {mask}");
        }
    }
}

#[test]
fn masks_in_other_systems_are_refused_in_all_programs() {
    let folder = Folder::new();
    let points = folder.write("points.las", LasFile::of(&GROUND).bytes());
    let ground = mesh(&folder, "EPSG:25833");
    let degrees = folder.write("degrees.geojson", geojson(""));
    let output = folder.path("out.file");
    let why = |of_mask: &str| format!("the lines are in {of_mask}, the points in EPSG:25833 (");
    for Program { name, arguments } in programs(&ground, &points) {
        let refused = |mask: &str, part: &str| {
            let arguments = [&arguments[..], &["--mask", mask, "-o", &output]].concat();
            assert_outcome(name, &arguments, b"", 2, part);
        };
        masks(&folder).iter().for_each(|mask| refused(mask, &why(SYSTEM)));
        refused(&degrees, &why("EPSG:4326 (GeoJSON without the member crs)"));
    }
    assert!(!folder.names("").contains(&"out.file".to_string()));
    // The system that a user states counts.
    let [mask, ..] = masks(&folder);
    let arguments = ["--step", "1", "--crs", SYSTEM, "--mask", &mask, &ground, "-o", "/dev/null"];
    assert_outcome("spdem", &arguments, b"", 0, "without data");
}

#[test]
fn masks_have_the_messages_of_other_polygons() {
    let folder = Folder::new();
    let ground = mesh(&folder, SYSTEM);
    let refused = |mask: &str, code: i32, part: &str| {
        let arguments = ["--step", "1", "--mask", mask, &ground, "-o", "/dev/null"];
        assert_outcome("spdem", &arguments, b"", code, part);
    };
    for (text, part) in [
        ("", "mask: empty: the input has no bytes"),
        ("{", "not JSON: the file is cut off"),
        (r#"{"type":"Point","coordinates":[1000,2]}"#, "feature 0: found a line, expected polygons"),
        (
            r#"{"type":"Polygon","coordinates":[[[0,0],[1000,0],[1,1],[5,6]]]}"#,
            "feature 0: a ring starts at 0, 0 and ends at 5, 6: repeat its first position",
        ),
        (r#"{"type":"Polygon","coordinates":[[[0,0],[1],[0,0]]]}"#, "two numbers"),
        (r#"{"type":"FeatureCollection","features":[]}"#, "found no lines"),
        ("POLYGON EMPTY", "found no lines"),
        ("POLYGON((0 0,1 0,1 1,0 0))\nPOINT(1 2)", "line 2: found \"POINT\", expected POLYGON"),
        ("POLYGON((0 0,1 0,1 1,0 2))", "line 1: ring 0: it starts at 0, 0 and ends at 0, 2"),
        ("0 0\n1 0\n", "line 1: found \"0\", expected line or soft"),
        ("soft 0 0 1 0\n", "line 1: found a line, expected polygons"),
    ] {
        refused(&folder.write("mask", text), 3, part);
    }
    refused(&folder.write("cut.shp", &shapefile()[..200]), 3, "record 1: the file is cut off");
    refused(&folder.path("no.shp"), 1, "no.shp");
}

#[test]
fn polygons_without_an_area_leave_nothing() {
    let folder = Folder::new();
    let ground = mesh(&folder, SYSTEM);
    for ring in ["[[6,5]]", "[[6,5],[6,5]]", "[[6.1,5.1],[8,7],[6.1,5.1]]"] {
        let text = format!(r#"{{"type":"Polygon",{MEMBER}"coordinates":[{ring}]}}"#);
        let mask = folder.write("line.geojson", text);
        for Program { name, arguments } in &programs(&ground, "")[..3] {
            let arguments = [&arguments[..], &["--mask", &mask]].concat();
            assert_outcome(name, &arguments, b"", 0, "");
        }
    }
}
