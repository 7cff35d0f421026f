//! `spdiff`: its table, its report, and what it refuses. Volumes themselves: `tests/diff`.

use serde_json::Value;

use crate::programs::{Folder, assert_damage_leaves_no_file, assert_outcome, mesh_of_cloud, outcome, run};

/// A mesh of points in text, with a system.
fn mesh(text: &str, crs: &str) -> Vec<u8> {
    let mut arguments = vec!["-q", "-"];
    if !crs.is_empty() {
        arguments.extend(["--crs", crs]);
    }
    let points = run("spfinalize", &arguments, text.as_bytes());
    assert!(points.status.success(), "{:?}", outcome(&points));
    run("spdelaunay2d", &["-q"], &points.stdout).stdout
}

const LOW: &str = "0 0 10\n8 0 10\n8 8 10\n0 8 10\n";
const HIGH: &str = "0 0 13\n8 0 13\n8 8 13\n0 8 13\n4 4 13\n";

#[test]
fn the_table_has_what_the_report_has() {
    let folder = Folder::new();
    let low = folder.write("low.spm", mesh(LOW, "EPSG:25832"));
    folder.write("by.wkt", "POLYGON((0 0,2 0,2 8,0 8,0 0))\nPOLYGON((2 0,8 0,8 8,2 8,2 0))\n");
    let [table, report] = ["volumes.tsv", "volumes.json"].map(|name| folder.path(name));
    let high = mesh(HIGH, "");
    let both = ["--sd-a", "0.3", "--sd-b", "0.4", "-o", &table, "--report", &report];
    let by = folder.path("by.wkt");
    let output = run("spdiff", &[&[&low[..], "-", "--by", &by, "-q"], &both[..]].concat(), &high);
    assert_eq!(outcome(&output), (Some(0), String::new()));
    assert_eq!(
        std::fs::read_to_string(table).unwrap(),
        "polygon\tcut\tfill\tnet\tcut_area\tfill_area\tlevel_area\tsd\n\
         1\t0\t48\t48\t0\t16\t0\t8\n2\t0\t144\t144\t0\t48\t0\t24\n"
    );
    let found: Value = serde_json::from_slice(&std::fs::read(report).unwrap()).unwrap();
    assert_eq!(found["unit"], "m");
    let parts = found["volumes"].as_array().unwrap();
    let exact = |part: &Value| part["exact"]["net"].as_str().unwrap().parse::<f64>().unwrap();
    let unit = found["exact_units"]["volume"].as_f64().unwrap();
    let sum = parts.iter().map(|part| exact(part) * unit).sum::<f64>();
    assert!((sum - 192.0).abs() < 1e-12 && parts.len() == 2, "{found:#}");
}

#[test]
fn levels_have_rows_and_heights_their_unit() {
    // Heights in feet over metres.
    let low = mesh(LOW, "EPSG:25832+8228");
    let output = run("spdiff", &["-", "--levels", "9:10.5:0.5", "-q"], &low);
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|row| row.split('\t').map(|field| field.parse().unwrap()).collect())
        .collect();
    assert_eq!(rows.iter().map(|row| row[0]).collect::<Vec<_>>(), [9.0, 9.5, 10.0, 10.5]);
    let nets: Vec<f64> = rows.iter().map(|row| row[3] / 0.3048 / 32.0).collect();
    assert!(
        nets.iter().zip([-2.0, -1.0, 0.0, 1.0]).all(|(net, expected)| (net - expected).abs() < 1e-8),
        "{nets:?}"
    );
    assert_eq!(rows[2][6], 64.0);
}

#[test]
fn what_does_not_fit_is_refused() {
    let folder = Folder::new();
    let low = folder.write("low.spm", mesh(LOW, "EPSG:25832"));
    let other = mesh(HIGH, "EPSG:25833");
    assert_outcome("spdiff", &[&low, "-"], &other, 2, "coordinate reference system");
    assert_outcome("spdiff", &["-", "-"], &other, 2, "stdin");
    assert_outcome("spdiff", &[&low], &[], 2, "required");
    assert_outcome("spdiff", &[&low, "--levels", "3:1:1"], &[], 2, "increasing");
    assert_outcome("spdiff", &[&low, "--plane", "1,2"], &[], 2, "three numbers");
    assert_outcome("spdiff", &[&low, "--level", "nan"], &[], 2, "finite");
    assert_outcome("spdiff", &[&low, "--level", "1", "--memory", "1M"], &[], 5, "--memory");
    assert_outcome("spdiff", &["-", "--level", "1"], &mesh(HIGH, "EPSG:4326"), 2, "degrees");
    let stream = mesh_of_cloud(300);
    assert_damage_leaves_no_file("spdiff", &["-", "--level", "1"], ["old.tsv", "new.tsv"], &stream);
    // Some of the first mesh alone.
    let half = folder.write("half.spm", mesh("0 0 1\n4 0 1\n4 8 1\n0 8 1\n", "EPSG:25832"));
    let (code, message) = outcome(&run("spdiff", &[&low, &half], &[]));
    assert!(code == Some(0) && message.contains("50.000 %"), "{message}");
}
