//! `dd4`: points in, streams of cells out.

mod failures;
mod interrupts;
mod memory;
mod oblique;
mod products;
mod routes;
mod time_scale;

use std::fs;

use serde_json::Value;

use crate::programs::{outcome, run, sample};
use spmesh_reference::sets::Random;

/// The output of `dd4`, which must succeed.
fn diagram(arguments: &[&str], input: &[u8]) -> Vec<u8> {
    let output = run("dd4", arguments, input);
    assert!(output.status.success(), "{arguments:?}: {:?}", outcome(&output));
    output.stdout
}

/// The proof that `spinfo` prints for a stream, which must pass.
fn proof(stream: &[u8]) -> Value {
    let output = run("spinfo", &["--audit", "--json", "-"], stream);
    assert!(output.status.success(), "{:?}", outcome(&output));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["audit"]["ok"], true);
    report["audit"]["proof"].clone()
}

fn as_text(stream: &[u8]) -> Vec<u8> {
    let output = run("spconvert", &["--to", "text"], stream);
    assert!(output.status.success(), "{:?}", outcome(&output));
    output.stdout
}

#[test]
fn the_grid_of_the_thesis_is_cubes() {
    let proof = proof(&diagram(&["--grid", "16x16x16x16"], &[]));
    let found = ["vertices", "cells", "simplices", "cell_vertices_max", "hull_facets"].map(|key| &proof[key]);
    assert_eq!(found, [65_536, 50_625, 0, 16, 8 * 15 * 15 * 15]);
}

#[test]
fn sampled_grids_pass_the_audit() {
    for (share, seed) in [("0.1", "1"), ("0.4", "2"), ("0.8", "3")] {
        let stream = diagram(&["--grid", "8x8x8x8", "--sample", share, "--seed", seed], &[]);
        let share: f64 = share.parse().unwrap();
        assert_eq!(proof(&stream)["vertices"], (4096.0 * share).round() as u64);
    }
}

#[test]
fn volumes_become_cells_with_values() {
    let stream = diagram(&[&sample("functional.nii"), "--count", "300"], &[]);
    assert_eq!(proof(&stream)["vertices"], 300);
    let report = run("spinfo", &["--json", "-"], &stream).stdout;
    let report: Value = serde_json::from_slice(&report).unwrap();
    assert_eq!(report["four_dimensions"]["values_known"], 300);
    assert_eq!(report["counts"]["points"], 300);
}

#[test]
fn the_order_of_the_points_changes_no_byte() {
    let mut random = Random::new(20_260_406);
    for side in [2, 3, 1000] {
        let mut lines: Vec<String> = (0..16)
            .map(|_| [(); 4].map(|()| random.integer(0, side).to_string()).join(" "))
            .chain((0..5).map(|i| format!("{} {} {} {}", i % 2, i / 2 % 2, i / 3, i * i)))
            .collect();
        let expected = diagram(&["-"], lines.join("\n").as_bytes());
        proof(&expected);
        for _ in 0..50 {
            random.shuffle(&mut lines);
            assert!(diagram(&["-"], lines.join("\n").as_bytes()) == expected, "{lines:?}");
        }
    }
}

#[test]
fn points_that_coincide_are_one_vertex() {
    let lines =
        "x y z t value\n0 0 0 0 1\n1 0 0 0 2\n0 1 0 0 3\n0 0 1 0 4\n0 0 0 1 nan\n0 0 0 0 9\n-0 0 0 0 8\n";
    let output = run("dd4", &["--keep-nan", "-"], lines.as_bytes());
    let (code, message) = outcome(&output);
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("2 of 7 points coincide with an earlier one"), "{message}");
    let text = String::from_utf8(as_text(&output.stdout)).unwrap();
    for line in ["v4 0 0 0 0 1", "v4 0 0 0 1 nan", "c4 1 2 3 4 5"] {
        assert!(text.lines().any(|found| found == line), "{line} in {text}");
    }
    let quiet = run("dd4", &["--keep-nan", "-q", "-"], lines.as_bytes());
    assert_eq!(outcome(&quiet), (Some(0), String::new()));
}

#[test]
fn text_twins_are_the_same_stream() {
    let stream = diagram(&["--grid", "4x3x5x2", "--sample", "0.7"], &[]);
    let text = as_text(&stream);
    assert!(run("spconvert", &["--to", "spm"], &text).stdout == stream);
    for input in [&stream, &text] {
        assert!(diagram(&["-"], input) == stream, "the points of a diagram have another diagram");
    }
    let header = "#spmesh version 2\n#spmesh kind points in 4 dimensions\n#spmesh coordinates f64\n#spmesh dims 4\n\
                  #spmesh elevation no\n#spmesh chunked no\n#spmesh producer \"test\"\n";
    let text = String::from_utf8(text).unwrap();
    let points: Vec<&str> = text.lines().filter(|line| line.starts_with("v4")).collect();
    assert_eq!(points.len(), 84);
    let cut = format!("{header}{}\n", points.join("\n"));
    let twin = cut.clone() + "# end points 84 cells 0 vertices 0 simplices 0 merged 0 residual 0 walls 0\n";
    let binary = run("spconvert", &["--to", "spm"], twin.as_bytes());
    assert!(binary.status.success(), "{:?}", outcome(&binary));
    for input in [twin.as_bytes(), &binary.stdout] {
        assert!(diagram(&["-"], input) == stream, "points in a stream have another diagram");
    }
    let (code, message) = outcome(&run("dd4", &["-"], cut.as_bytes()));
    assert_eq!(code, Some(3), "{message}");
    assert!(message.contains("truncated"), "{message}");
}

#[test]
fn multiples_become_whole_numbers() {
    let tenths: String = (0..81)
        .map(|i| [i % 3, i / 3 % 3, i / 9 % 3, i / 27].map(|x| format!("0.{x}")).join(" ") + "\n")
        .collect();
    let whole = diagram(&["--quantum", "0.1", "-"], tenths.as_bytes());
    assert!(whole == diagram(&["--grid", "3x3x3x3"], &[]));
    assert_eq!(proof(&diagram(&["--quantum=0.05", "-"], tenths.as_bytes()))["cells"], 16);
    let (code, message) = outcome(&run("dd4", &["--quantum", "0.2", "-"], tenths.as_bytes()));
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("x = 0.1 is no multiple of 0.2"), "{message}");
}

#[test]
fn statistics_are_text_or_json() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("grid.spm").to_str().unwrap().to_string();
    let (code, message) = outcome(&run("dd4", &["--grid", "5x4x3x3", "--stats", "json", "-o", &file], &[]));
    assert_eq!(code, Some(0), "{message}");
    let stats: Value = serde_json::from_str(&message).unwrap();
    // The statistics also count facets between infinite cells, one for each ridge of the hull.
    let proof = proof(&fs::read(&file).unwrap());
    let [facets, hull] = ["facets", "hull_facets"].map(|key| proof[key].as_u64().unwrap());
    assert_eq!(stats["facets"].as_u64().unwrap(), facets + 6 * hull / 2);
    assert_eq!((&stats["cells"], &stats["infinite_cells"]), (&proof["cells"], &proof["hull_facets"]));
    assert_eq!(stats["vertex_references"], 16 * 48 + 8 * hull);
    assert_eq!(stats["output_bytes"], fs::metadata(&file).unwrap().len());
    assert_eq!(stats["share_not_simplices"], 1.0);
    assert!(stats["simplices_created"].as_u64() > stats["simplices"].as_u64());
    let (_, message) = outcome(&run("dd4", &["--grid", "2x2x2x2", "--stats", "-o", &file], &[]));
    assert!(message.contains("vertex references"), "{message}");
    assert!(message.lines().all(|line| line.len() <= 60), "{message}");
}

#[test]
fn the_audit_names_what_is_wrong() {
    let text = String::from_utf8(as_text(&diagram(&["--grid", "3x2x2x2"], &[]))).unwrap();
    let moved = text.replacen("v4 0 0 0 0\n", "v4 -1 0 0 0\n", 1);
    let damaged = run("spconvert", &["--to", "spm"], moved.as_bytes()).stdout;
    let output = run("spinfo", &["--audit", "--json", "-"], &damaged);
    let (code, message) = outcome(&output);
    assert_eq!(code, Some(4), "{message}");
    assert!(message.contains("stdin: spheres check failed"), "{message}");
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["audit"]["ok"], false);
    assert_eq!(report["audit"]["violation"]["check"], "spheres");
    let text = String::from_utf8(run("spinfo", &["--audit", "-"], &damaged).stdout).unwrap();
    assert!(text.contains("audit FAILED\n  spheres      FAILED"), "{text}");
}
