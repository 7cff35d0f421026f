//! Wrong flags and inputs.

use super::mesh;
use crate::programs::{Folder, outcome, run};

const MESH: &str = "0 0 1\n9 0 2\n0 9 3\n9 9 4\n";

#[test]
fn wrong_check_points_are_named_with_their_place() {
    let folder = Folder::new();
    let mesh = mesh(&folder, MESH);
    let point = |coordinates: &str, properties: &str| {
        format!(
            r#"{{"type":"Feature","properties":{properties},"geometry":{{"type":"Point","coordinates":{coordinates}}}}}"#
        )
    };
    let collection = |features: &[String]| {
        format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, features.join(","))
    };
    let (good, flat) = (point("[1,1,2]", "{}"), point("[1,1]", "{}"));
    let line = good.replace("Point", "LineString").replace("[1,1,2]", "[[1,1,2],[2,2,3]]");
    let numbered: String = (0..1001).map(|number| format!("1 2 3 {number}\n")).collect();
    for (text, flags, code, parts) in [
        ("1 2 3\n4 x 6\n".to_string(), &[][..], 3, ["line 2", "expected a number"]),
        ("x,y,z\n1,2,3\n4,5\n".to_string(), &[], 3, ["line 3", "column"]),
        ("1 2 3\n4 5 nan\n".to_string(), &[], 3, ["line 2", "leave the point out"]),
        ("1 2\n3 4\n".to_string(), &[], 2, ["no elevation", "--columns"]),
        ("x,y,z,a\n1,2,3,b\n".to_string(), &["--class-field", "c"], 2, ["no column \"c\"", "there is a"]),
        ("1 2 3\n".to_string(), &["--class-field", "4"], 2, ["no column 4", "none"]),
        ("a,b,c\n1,2,3\n".to_string(), &["--columns", "a,b,d"], 2, ["no column \"d\"", "a, b, c"]),
        (numbered, &["--class-field", "4"], 2, ["line 1001", "no classes"]),
        (String::new(), &[], 3, ["empty", "check"]),
        (collection(&[good.clone(), flat]), &[], 3, ["feature 1", "elevation"]),
        (collection(&[good.clone(), line]), &[], 3, ["feature 1", "expected points"]),
        (collection(&[good]), &["--class-field", "cover"], 2, ["no feature", "--class-field"]),
    ] {
        let check = folder.write("check", &text);
        let out = folder.path("out.html");
        let arguments = [&["-", "--mesh", &mesh, "--check", &check, "-o", &out], flags].concat();
        let (found, message) = outcome(&run("spreport", &arguments, MESH.as_bytes()));
        assert_eq!(found, Some(code), "{text:?}: {message}");
        assert!(parts.iter().all(|part| message.contains(part)), "{text:?}: {message}");
        assert!(!message.contains("panicked") && message.contains("check"), "{message}");
        assert_eq!(folder.names(""), ["check", "mesh.spm"]);
    }
}

#[test]
fn wrong_requests_are_refused_with_a_remedy() {
    let folder = Folder::new();
    let (mesh, points) = (mesh(&folder, MESH), folder.write("points.txt", MESH));
    let (out, json) = (folder.path("out.html"), folder.path("out.json"));
    for (arguments, code, part) in [
        (vec!["-o", &out[..]], 2, "no input"),
        (vec![&points, "-o", "-", "--json", "-"], 2, "stdout"),
        (vec![&points, "-o", &folder.path("out.png")], 2, "this program writes .html"),
        (vec![&points, "--json", &folder.path("out.csv")], 2, "this program writes .json"),
        (vec![&points, "-o", &points], 2, "would replace the input"),
        (vec![&points, "--json", &points], 2, "would replace the input"),
        (vec![&points, "-o", &out, "--mesh", &mesh], 2, "--check"),
        (vec![&points, "-o", &out, "--check", &points], 2, "--mesh"),
        (vec!["-", "-o", &out, "--mesh", "-", "--check", &points], 2, "stdin can be one input only"),
        (vec![&points, "-o", &out, "--mesh", &mesh, "--check", "-"], 2, "check points come from a file"),
        (vec![&points, "-o", &out, "--mesh", &points, "--check", &points], 3, "points.txt"),
        (vec![&points, "-o", &out, "--cell", "0"], 2, "above 0"),
        (vec![&points, "-o", &out, "--spacing", "nan"], 2, "no length"),
        (vec![&points, "-o", &out, "--memory", "1M", "--mesh", &mesh, "--check", &points], 0, ""),
        (vec!["none.laz", "--json", &json], 1, "none.laz"),
    ] {
        let (found, message) = outcome(&run("spreport", &arguments, &[]));
        assert_eq!(found, Some(code), "{arguments:?}: {message}");
        assert!(message.contains(part) && !message.contains("panicked"), "{arguments:?}: {message}");
    }
    assert_eq!(folder.names(""), ["mesh.spm", "out.html", "points.txt"]);
    assert_eq!(std::fs::read_to_string(points).unwrap(), MESH);
}

#[test]
fn degrees_are_refused() {
    let folder = Folder::new();
    folder.write("a.geojson", "x");
    let sample = crate::programs::sample("autzen.laz");
    let (code, message) = outcome(&run("spreport", &[&sample, "--json", "-"], &[]));
    assert_eq!(code, Some(0), "{message}");
    let points = crate::sources::las_file::LasFile {
        projection: vec![crate::sources::las_file::geo_keys(4326)],
        ..crate::sources::las_file::LasFile::of(&[[1, 2, 3]])
    };
    let path = folder.write("degrees.las", points.bytes());
    let (code, message) = outcome(&run("spreport", &[&path, "--json", "-"], &[]));
    assert!(code == Some(2) && message.contains("project the points first"), "{code:?} {message}");
}
