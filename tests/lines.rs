//! Lines of files as a network, and as points of `spfinalize`.

use std::path::PathBuf;

use spmesh_base::error::{ErrorKind, Result};
use spmesh_delaunay::network::Network;
use spmesh_pipeline::lines::{ChangeKind, Changes, Lines, Options, Sources, Target};
use spmesh_stream::{Coordinates, Crs};

use crate::programs::{Folder, assert_outcome, outcome, run};

const FORMATS: [&str; 4] = ["lines.txt", "lines.geojson", "lines.shp", "lines.gpkg"];

fn sample(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

fn grid(scale: f64) -> Target {
    let coordinates = Coordinates::I32 { scale: [scale; 3], offset: [0.0; 3] };
    Target { coordinates, crs: Crs::Unknown, has_elevation: true }
}

fn read(lines: &[PathBuf], target: &Target, options: &Options) -> Result<(Network, Changes)> {
    let sources = Sources { lines, ..Sources::default() };
    let Lines { network, changes, .. } = spmesh_pipeline::lines::read(&sources, target, options)?;
    Ok((network, changes))
}

fn network(name: &str, target: &Target) -> (Network, Changes) {
    let options = Options { lists_changes: true, ..Options::default() };
    read(&[sample(name)], target, &options).expect("lines")
}

#[test]
fn all_formats_give_one_network() {
    for target in [grid(0.001), grid(0.1), Target { coordinates: Coordinates::F64, ..grid(1.0) }] {
        let (expected, changes) = network(FORMATS[0], &target);
        assert_eq!(changes.count(ChangeKind::Spike), 1);
        assert_eq!(changes.count(ChangeKind::RepeatedVertex), 1);
        assert!(changes.count(ChangeKind::Crossing) > 2);
        for format in &FORMATS[1..] {
            let (found, again) = network(format, &target);
            assert_eq!(found, expected, "{format}");
            assert_eq!(again.list(), changes.list(), "{format}");
        }
    }
}

#[test]
fn all_files_are_one_set_of_lines() {
    let twice = [sample("lines.geojson"), sample("lines.shp")];
    let (both, changes) = read(&twice, &grid(0.001), &Options::default()).expect("lines");
    assert_eq!(both, network("lines.txt", &grid(0.001)).0);
    assert_eq!(changes.count(ChangeKind::Overlap), both.segments.len() as u64);
}

#[test]
fn other_systems_are_refused() {
    let system = |name: &str| spmesh_formats::crs::requested(name).expect("a system");
    let target = |name: &str| Target { crs: system(name), ..grid(0.001) };
    for format in &FORMATS[1..] {
        let read = |name: &str| read(&[sample(format)], &target(name), &Options::default());
        let (_, changes) = read("EPSG:25832").expect("lines");
        let about_layers = |notice: &String| notice.starts_with("the layers of");
        assert!(changes.notices.iter().all(about_layers), "{format}: {:?}", changes.notices);
        assert_eq!(changes.notices.len(), usize::from(*format == "lines.gpkg"), "{format}");
        let error = read("EPSG:25833").unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Usage);
        assert!(error.to_string().contains("the points in EPSG:25833"), "{error}");
        let (_, changes) = network(format, &grid(0.001));
        assert!(changes.notices[0].contains("the points state no coordinate"), "{:?}", changes.notices);
    }
}

#[test]
fn damaged_files_are_errors() {
    let folder = Folder::new();
    for name in &FORMATS[1..] {
        let bytes = std::fs::read(sample(name)).expect("a sample");
        let step = bytes.len() / 90 + 1;
        for at in (0..bytes.len()).step_by(step) {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0xff;
            let file = folder.write(name, &damaged);
            let _ = read(&[PathBuf::from(&file)], &grid(0.001), &Options::default());
            let cut = folder.write(name, &bytes[..at]);
            let found = read(&[PathBuf::from(&cut)], &grid(0.001), &Options::default());
            assert!(found.is_err(), "{name} up to {at}");
        }
    }
}

/// A stream of a grid of points, with the lines of a file.
fn finalized(folder: &Folder, arguments: &[&str]) -> (Vec<u8>, String) {
    let mut points = String::new();
    for number in 0..400 {
        points += &format!("{} {} {}\n", number % 20, number / 20, number % 7);
    }
    let points = folder.write("points.txt", points);
    let lines = sample("lines.gpkg");
    let lines = lines.to_str().expect("text");
    let output = run("spfinalize", &[&["--lines", lines, &points], arguments].concat(), b"");
    let (code, message) = outcome(&output);
    assert_eq!(code, Some(0), "{arguments:?}: {message}");
    (output.stdout, message)
}

#[test]
fn vertices_with_elevations_become_points() {
    let folder = Folder::new();
    let scale = ["--scale", "0.001,0.001,0.001"];
    let (stream, message) = finalized(&folder, &[&scale[..], &["--stats=json"]].concat());
    let (network, _) = network("lines.txt", &grid(0.001));
    let at_points = network
        .vertices
        .iter()
        .filter(|vertex| vertex.place.iter().all(|value| value % 1000.0 == 0.0))
        .count();
    let stats = message.lines().find(|line| line.starts_with('{')).expect("JSON");
    let stats: serde_json::Value = serde_json::from_str(stats).expect("JSON");
    assert_eq!(stats["lines"]["points"], network.vertices.len());
    assert_eq!(stats["lines"]["replaced"], at_points);
    assert_eq!(stats["points"], 400 + network.vertices.len() - at_points);
    // Threads, passes and spools change nothing.
    for arguments in [["--threads", "1"], ["--threads", "3"], ["--spool", "always"], ["--memory", "64M"]] {
        assert!(finalized(&folder, &[&scale[..], &arguments].concat()).0 == stream, "{arguments:?}");
    }
    // Filters are for points: of these none is left.
    let (_, message) = finalized(&folder, &[&scale[..], &["--keep-z", "100,200", "--stats=json"]].concat());
    assert!(message.contains(&format!("\"points\":{},", network.vertices.len())), "{message}");
}

#[test]
fn thinning_and_preserved_order_keep_all_vertices() {
    let folder = Folder::new();
    for arguments in [&["--thin", "50:first"][..], &["--preserve"], &["--compress"], &["--densify", "0.5"]] {
        let (stream, _) = finalized(&folder, arguments);
        let mesh = run("spdelaunay2d", &[], &stream);
        assert_eq!(outcome(&mesh).0, Some(0), "{arguments:?}");
        let (code, message) = outcome(&run("spinfo", &["--audit", "-"], &mesh.stdout));
        assert_eq!(code, Some(0), "{arguments:?}: {message}");
    }
}

#[test]
fn reports_list_all_changes() {
    let folder = Folder::new();
    let report = folder.path("report.tsv");
    let (_, message) = finalized(&folder, &["--report", &report, "--densify", "1"]);
    let text = std::fs::read_to_string(&report).expect("a report");
    let mut rows = text.lines();
    assert_eq!(rows.next(), Some("kind\tline\tx\ty"));
    assert!(text.contains("\nspike\t2\t4\t3\n"), "{text}");
    let densified = rows.filter(|row| row.starts_with("densified\t")).count();
    assert!(densified > 10 && message.contains(&format!("densified {densified}")), "{message}");
}

#[test]
fn requests_that_make_no_sense_are_refused() {
    let folder = Folder::new();
    let points = folder.write("points.txt", "0 0 0\n1 0 0\n0 1 0\n");
    let lines = folder.write("lines.txt", "line 0 0 1 1 1 2\n");
    let bad = folder.write("bad.txt", "line 0 0 1 1 1\n");
    let far = folder.write("far.txt", "soft 0 0 5e9 1\n");
    let binary = folder.write("image.tif", b"II*\0aaaa");
    assert_outcome("spfinalize", &["--lines", &lines, "--octree", &points], b"", 2, "leave out --octree");
    assert_outcome("spfinalize", &["--densify", "1", &points], b"", 2, "--lines");
    assert_outcome("spfinalize", &["--lines", &lines, "--densify", "0", &points], b"", 2, "positive number");
    assert_outcome("spfinalize", &["--lines", "-", "-"], b"", 2, "only one of");
    assert_outcome("spfinalize", &["--lines", &bad, &points], b"", 3, "bad.txt: line 1: found 5 numbers");
    assert_outcome(
        "spfinalize",
        &["--lines", &binary, &points],
        b"",
        3,
        "found a TIFF image, expected lines",
    );
    assert_outcome("spfinalize", &["--lines", "none.gpkg", &points], b"", 1, "none.gpkg");
    let scale = ["--scale", "0.01,0.01,0.01"];
    let arguments = [&scale[..], &["--lines", &far, &points]].concat();
    assert_outcome("spfinalize", &arguments, b"", 2, "far.txt: line 1: a vertex of a line has x 5000000000");
    let endless = folder.write("endless.txt", "soft 0 0 1 1e300\n");
    let arguments = [&scale[..], &["--lines", &endless, &points]].concat();
    assert_outcome(
        "spfinalize",
        &arguments,
        b"",
        2,
        "endless.txt: line 1: a vertex of a line has y 1e300, but",
    );
    assert_outcome("spfinalize", &["--lines", &lines, "--report", &lines, &points], b"", 2, "--report");
}

#[test]
fn a_far_vertex_does_not_take_the_shape_of_other_lines() {
    let folder = Folder::new();
    // Without a scale, coordinates are f64, and the grid of lines follows from the greatest one.
    let points = folder.write("points.txt", "0 0.5 0\n100 0 0\n0 100 0\n100 100 0\n");
    let far = folder.write("far.txt", "soft 10 10 20 20\nsoft 30 30 1e308 40\n");
    let message =
        "far.txt: line 1: the line would become one place: a coordinate of lines is as great as 1e308";
    assert_outcome("spfinalize", &["--lines", &far, &points], b"", 2, message);
    let farther = folder.write("farther.txt", "line 10 10 1 20 20 2\nline 30 30 1 1e10 40 2\n");
    let run = run("spfinalize", &["--lines", &farther, &points], b"");
    let (code, message) = outcome(&run);
    assert_eq!(code, Some(0));
    assert!(message.contains("as great as 10000000000.0: lines are rounded to steps of 0.01"), "{message}");
    let good = folder.write("good.txt", "line 10 10 1 10.0000001 10 2\nline 30 30 1 4000000 40 2\n");
    assert!(
        !outcome(&crate::programs::run("spfinalize", &["--lines", &good, &points], b"")).1.contains("great")
    );
}

#[test]
fn changes_beside_a_geopackage_are_refused() {
    let folder = Folder::new();
    let points = folder.write("points.txt", "0 0 0\n9 0 0\n0 9 0\n");
    let file = folder.write("lines.gpkg", std::fs::read(sample("lines.gpkg")).expect("a sample"));
    let link = folder.path("link.gpkg");
    std::os::unix::fs::symlink(&file, &link).expect("a link");
    let log = [&[0x37, 0x7f, 6, 0x82][..], &[1; 29]].concat();
    // A log without frames, an empty journal, and one that SQLite has finished.
    for (ending, content) in [("-wal", &log[..32]), ("-journal", &[]), ("-journal", &[0; 512])] {
        folder.write(&format!("lines.gpkg{ending}"), content);
        assert_outcome("spfinalize", &["--lines", &file, &points], b"", 0, "the layers of");
    }
    for (ending, content) in [("-wal", &log[..]), ("-journal", b"\xd9\xd5\x05\xf9")] {
        folder.write(&format!("lines.gpkg{ending}"), content);
        let part = format!("lines.gpkg{ending}: close the program that writes it");
        for file in [&file, &link] {
            assert_outcome("spfinalize", &["--lines", file, &points], b"", 2, &part);
        }
        assert_outcome("spfinalize", &["--clip", &format!("{file}:ponds"), &points], b"", 2, &part);
        std::fs::remove_file(folder.path(&format!("lines.gpkg{ending}"))).expect("a file");
    }
    assert!(folder.names("").len() == 3, "{:?}", folder.names(""));
}

#[test]
fn layers_are_chosen_by_name() {
    let folder = Folder::new();
    let points = folder.write("points.txt", "0 0 0\n20 0 0\n0 20 0\n20 20 0\n");
    let file = folder.write("map.gpkg", std::fs::read(sample("lines.gpkg")).expect("a sample"));
    let count = |name: &str| network(name, &grid(0.001)).0.segments.len();
    let of = |layer: &str| {
        read(&[PathBuf::from(format!("{file}:{layer}"))], &grid(0.001), &Options::default()).expect("lines")
    };
    let ((paths, about), (ponds, _)) = (of("paths"), of("PONDS"));
    assert!(about.notices.iter().all(|notice| notice.contains("state no coordinate")), "{:?}", about.notices);
    assert!(ponds.segments.len() < paths.segments.len() && paths.segments.len() < count("lines.gpkg"));
    let [ponds, paths, other] = ["ponds", "paths", "roads"].map(|layer| format!("{file}:{layer}"));
    let listed = r#"are "paths", "ponds""#;
    assert_outcome("spfinalize", &["--clip", &ponds, &points], b"", 0, "the filters keep none");
    for flag in ["--lines", "--clip", "--drop-inside", "--flatten"] {
        let part = format!(r#"map.gpkg:roads: has no layer "roads": its layers {listed}"#);
        assert_outcome("spfinalize", &[flag, &other, &points], b"", 2, &part);
    }
    for flag in ["--clip", "--flatten"] {
        assert_outcome("spfinalize", &[flag, &paths, &points], b"", 3, "expected polygons");
        // Whoever gives the whole file reads what to choose from.
        assert_outcome("spfinalize", &[flag, &file, &points], b"", 3, &format!("map.gpkg {listed}"));
    }
    assert_outcome("spfinalize", &["--lines", &paths, "--report", &file, &points], b"", 2, "would replace");
    let json = folder.write("map.geojson", std::fs::read(sample("lines.geojson")).expect("a sample"));
    let arguments = ["--lines", &format!("{json}:paths"), &points];
    assert_outcome("spfinalize", &arguments, b"", 2, "only GeoPackages have layers");
    // A file may have such a name itself.
    let json = folder.write("map.gpkg:paths", std::fs::read(sample("lines.geojson")).expect("a sample"));
    assert_eq!(
        read(&[json.into()], &grid(0.001), &Options::default()).expect("lines").0.segments.len(),
        count("lines.geojson")
    );
}

/// Vertices of the mesh of these lines alone, in hundredths.
fn alone(files: &[&str], more: &[&str]) -> std::collections::BTreeSet<[i64; 3]> {
    let lines = files.iter().flat_map(|file| ["--lines", file]);
    let arguments: Vec<&str> =
        ["--no-points", "--scale", "0.01,0.01,0.01"].into_iter().chain(lines).collect();
    let points = run("spfinalize", &[&arguments, more].concat(), b"");
    assert_eq!(outcome(&points).0, Some(0), "{}", outcome(&points).1);
    crate::water::vertices(&run("spdelaunay2d", &[], &points.stdout).stdout).into_iter().collect()
}

#[test]
fn properties_state_elevations_and_points_are_vertices() {
    let folder = Folder::new();
    let text = r#"{"type":"FeatureCollection","features":[
        {"type":"Feature","properties":{"Elev":12.5},"geometry":{"type":"LineString","coordinates":[[0,0],[10,0,99],[10,10]]}},
        {"type":"Feature","properties":{"ELEV":null},"geometry":{"type":"LineString","coordinates":[[0,5,3],[3,9,4]]}},
        {"type":"Feature","geometry":{"type":"MultiPoint","coordinates":[[5,6,21],[5,7,22],[5,6,20],[10,0,1],[6,6]]}}]}"#;
    let file = folder.write("map.geojson", text);
    let expected = [[0, 0, 1250], [1000, 0, 1250], [1000, 1000, 1250], [0, 500, 300], [300, 900, 400]];
    let points = [[500, 600, 2000], [500, 700, 2200]];
    assert_eq!(alone(&[&file], &["--z-field", "elev"]), expected.into_iter().chain(points).collect());
    // Points of a layer do not count where points of the input would not.
    let pond = r#"{"type":"Polygon","coordinates":[[[4,4,8],[6,4,8],[6,6.5,8],[4,6.5,8],[4,4,8]]]}"#;
    let pond = folder.write("pond.geojson", pond);
    let ground = folder.write("ground.txt", "0 0 1\n20 0 2\n0 20 3\n20 20 4\n");
    let flags =
        ["--scale", "0.01,0.01,0.01", "--lines", &file, "--flatten", &pond, "--z-field", "ELEV", &ground];
    let found = run("spfinalize", &flags, b"");
    let found = crate::water::vertices(&run("spdelaunay2d", &[], &found.stdout).stdout);
    assert!(found.contains(&points[1]) && !found.iter().any(|vertex| vertex[..2] == points[0][..2]));
    // Tables of other formats state the same.
    let water = |name: &str| sample(name).display().to_string();
    let shapes = alone(&[&water("water.shp"), &water("water_lines.shp")], &["--z-field", "id"]);
    let elevations: std::collections::BTreeSet<i64> = shapes.iter().map(|vertex| vertex[2]).collect();
    assert!(elevations.len() > 1 && elevations.iter().all(|z| z % 100 == 0), "{elevations:?}");
    let flags = ["--no-points", "--lines", &file, "--z-field"];
    assert_outcome(
        "spfinalize",
        &[&flags[..], &["elv"]].concat(),
        b"",
        2,
        "no line has the property \"elv\"",
    );
    let name = folder.write("name.geojson", text.replace("12.5", "\"high\""));
    let flags = ["--no-points", "--lines", &name, "--z-field", "elev"];
    assert_outcome(
        "spfinalize",
        &flags,
        b"",
        3,
        "feature 0: the property elev is \"high\", expected a number",
    );
    assert_outcome("spfinalize", &["--z-field", "elev"], b"", 2, "give --lines, too");
    let flat = folder.write("flat.geojson", r#"{"type":"LineString","coordinates":[[0,0],[9,0],[9,9]]}"#);
    let message = "no vertex of --lines has an elevation";
    assert_outcome("spfinalize", &["--no-points", "--lines", &flat], b"", 2, message);
    assert_outcome("spfinalize", &["--no-points", "--lines", "-"], text.as_bytes(), 2, "and not stdin");
}
