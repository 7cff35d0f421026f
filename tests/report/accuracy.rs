//! Differences at check points.

use serde_json::Value;

use super::{assert_near, mesh, number, report};
use crate::programs::{Folder, outcome, run};
use crate::sources::las_file::{LasFile, Record, geo_keys};

/// A plane that rises by a tenth to the east, and one as steep as 25 degrees to the south of it.
const MESH: &str = "0 0 10\n100 0 20\n0 100 10\n100 100 20\n0 -100 -36.6307658\n100 -100 -26.6307658\n";

/// Check points with words: those on the first plane, on the second, and outside.
const POINTS: [([f64; 3], &str); 7] = [
    ([10.0, 10.0, 10.9], "grass"),
    ([20.0, 50.0, 12.2], "grass"),
    ([90.0, 90.0, 19.0], "VVA"),
    ([50.0, 50.0, 14.7], "VVA"),
    ([30.0, 30.0, 13.0], "bare"),
    ([50.0, -50.0, -8.3153829], "bare"),
    ([500.0, 50.0, 1.0], "bare"),
];

fn table() -> String {
    let lines = POINTS.map(|([x, y, z], word)| format!("{word};{x};{y};{z}\n"));
    format!("cover;x;y;z\n{}", lines.concat())
}

fn group<'r>(report: &'r Value, list: &str, name: &str) -> &'r Value {
    let groups = report["check_points"][list].as_array().expect("a list");
    groups.iter().find(|group| group["name"] == name).unwrap_or_else(|| panic!("no {name} in {groups:?}"))
}

#[test]
fn figures_are_those_of_mesh_minus_check_point() {
    let folder = Folder::new();
    let (mesh, check) = (mesh(&folder, MESH), folder.write("check.csv", table()));
    let flags =
        ["-", "--mesh", &mesh, "--check", &check, "--class-field", "Cover", "--check-accuracy", "0.3"];
    let found = report(&flags, MESH.as_bytes());
    assert_eq!((number(&found, "check_points.count"), number(&found, "check_points.outside")), (7.0, 1.0));
    let mut differences = [0.1, -0.2, 0.0, 0.3, 0.0, 0.0];
    let mean = differences.iter().sum::<f64>() / 6.0;
    let rmse = (differences.iter().map(|d| d * d).sum::<f64>() / 6.0).sqrt();
    assert_near(number(&found, "check_points.all.mean"), mean);
    assert_near(number(&found, "check_points.all.rmse_v1"), rmse);
    assert_near(number(&found, "check_points.all.rmse_v"), rmse.hypot(0.3));
    assert_near(number(&found, "check_points.all.std"), ((rmse * rmse - mean * mean) * 6.0 / 5.0).sqrt());
    differences.sort_by(f64::total_cmp);
    assert_near(number(&found, "check_points.all.median"), 0.0);
    assert_near(number(&found, "check_points.all.nmad"), 1.4826 * 0.05);
    assert_near(number(&found, "check_points.all.p95"), 0.2 + 0.75 * 0.1);
    assert_near(number(&found, "check_points.all.min"), -0.2);
    assert_eq!(found["check_points"]["all"]["is_enough"], false);
    assert_near(number(&found, "check_points.vva.rmse_v1"), (0.09f64 / 2.0).sqrt());
    assert_eq!(number(&found, "check_points.nva.count"), 4.0);
    assert_near(group(&found, "classes", "grass")["mean"].as_f64().unwrap(), -0.05);
    assert_eq!(group(&found, "slopes", "5° to 10°")["count"], 5);
    assert_eq!(group(&found, "slopes", "20° to 30°")["count"], 1);
    // Other words may stand for vegetation.
    let found = report(&[&flags[..], &["--vegetated", "GRASS,reed"]].concat(), MESH.as_bytes());
    assert_eq!(number(&found, "check_points.vva.count"), 4.0);
}

#[test]
fn check_points_of_all_formats_are_the_same() {
    let folder = Folder::new();
    let mesh = mesh(&folder, MESH);
    let feature = |([x, y, z], word): ([f64; 3], &str)| {
        format!(
            r#"{{"type":"Feature","properties":{{"cover":"{word}"}},"geometry":{{"type":"Point","coordinates":[{x},{y},{z}]}}}}"#
        )
    };
    let features = POINTS.map(feature).join(",");
    folder.write("a.geojson", format!(r#"{{"type":"FeatureCollection","features":[{features}]}}"#));
    folder.write("a.csv", table());
    let of = |name: &str, flags: &[&str]| {
        let path = folder.path(name);
        let flags = [&["-", "--mesh", &mesh, "--check", &path], flags].concat();
        report(&flags, MESH.as_bytes())["check_points"].clone()
    };
    let (text, json) = (of("a.csv", &["--class-field", "1"]), of("a.geojson", &["--class-field", "cover"]));
    for key in ["count", "outside", "all", "nva", "vva", "classes", "slopes"] {
        assert_eq!(text[key], json[key], "{key}");
    }
    // Words that are not asked for do not count.
    assert!(of("a.geojson", &[])["nva"].is_null());
    let record = |([x, y, z], word): ([f64; 3], &str)| Record {
        position: [x, y, z].map(|at| (at * 100.0).round() as i32),
        class: if word == "VVA" { 5 } else { 2 },
        number: 1,
        of: 1,
        ..Record::default()
    };
    let file = LasFile { records: POINTS.map(record).to_vec(), ..LasFile::of(&[]) };
    folder.write("a.las", file.bytes());
    let las = of("a.las", &[]);
    assert_eq!((&las["nva"]["count"], &las["vva"]["count"]), (&text["nva"]["count"], &text["vva"]["count"]));
    assert_near(number(&las, "vva.rmse_v1"), number(&text, "vva.rmse_v1"));
    assert_eq!(las["classes"][1]["name"], "5 High vegetation");
}

/// GeoJSON without a system is in degrees.
#[test]
fn check_points_in_another_system_are_refused() {
    let folder = Folder::new();
    let file =
        LasFile { projection: vec![geo_keys(2154)], ..LasFile::of(&[[0, 0, 1], [900, 0, 2], [0, 900, 3]]) };
    let points = folder.write("points.las", file.bytes());
    let stream = run("spfinalize", &["-q", &points], &[]).stdout;
    let mesh = folder.write("mesh.spm", run("spdelaunay2d", &["-q"], &stream).stdout);
    let check = |crs: &str| {
        let text = format!(r#"{{"type":"MultiPoint",{crs}"coordinates":[[1,1,2],[2,2,3]]}}"#);
        let path = folder.write("check.geojson", text);
        outcome(&run("spreport", &["-q", &points, "--json", "-", "--mesh", &mesh, "--check", &path], &[]))
    };
    let (code, message) = check("");
    assert!(code == Some(2) && message.contains("coordinate reference system"), "{message}");
    assert_eq!(
        check(r#""crs":{"type":"name","properties":{"name":"EPSG:2154"}},"#),
        (Some(0), String::new())
    );
}

/// Vertices of the mesh are on it, those of its border, too.
#[test]
fn points_of_the_mesh_have_no_difference() {
    let folder = Folder::new();
    let positions: Vec<[i32; 3]> =
        (0..400).map(|at| [at * 7919 % 1009, at * 104_729 % 997, at % 50]).collect();
    let file = LasFile { offset: [412_345.67, 5_399_999.99, 0.1], ..LasFile::of(&positions) };
    let path = folder.write("points.las", file.bytes());
    let stream = run("spfinalize", &["-q", &path], &[]).stdout;
    let mesh = folder.write("mesh.spm", run("spdelaunay2d", &["-q"], &stream).stdout);
    let found = report(&[&path, "--mesh", &mesh, "--check", &path], &[]);
    assert_eq!((number(&found, "check_points.count"), number(&found, "check_points.outside")), (400.0, 0.0));
    assert!(number(&found, "check_points.all.max") < 1e-6 && number(&found, "check_points.all.min") > -1e-6);
}

#[test]
fn few_check_points_have_few_figures() {
    let folder = Folder::new();
    let mesh = mesh(&folder, MESH);
    for (text, count) in [("# none\n", 0), ("10 10 11.5\n", 1), ("900 10 11.5\n", 0)] {
        let check = folder.write("check.txt", text);
        let found = report(&["-", "--mesh", &mesh, "--check", &check], MESH.as_bytes());
        let all = &found["check_points"]["all"];
        assert_eq!(all["count"], count, "{text}");
        assert!(all["std"].is_null() && all["skewness"].is_null() && all["rmse_v"].is_null(), "{all}");
        let page =
            run("spreport", &["-q", "-", "-o", "-", "--mesh", &mesh, "--check", &check], MESH.as_bytes());
        assert!(page.status.success() && !String::from_utf8(page.stdout).unwrap().contains("NaN"), "{text}");
    }
}
